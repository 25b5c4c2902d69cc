"""One confined cell through the real passes: oedometer and open-then-close cycles of failed rock, by every law."""

import typing

import numpy as np
import pytest

from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.rock.after_failure import CompressionOnly
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

K = 17e9 / (3.0 * (1.0 - 2.0 * 0.14))

PRESSURES = {
    "CompressionOnly": lambda J: max(K * (1.0 - J), 0.0),
    "Void": lambda J: 0.0,
    "Clipped": lambda J: min(max(K * (1.0 - J), -2e6), 5e6),
}
"""p(J) of the paper, sec. 3.2, written again by hand."""

EXAMPLES = {"Clipped": {"tension_limit": 2e6, "compression_limit": 5e6}}


def after_failure_laws():
    """Every law that gives a pressure after failure; a new one must be given its p(J) here."""
    found = [c for c in typing.get_args(typing.get_type_hints(Rock)["after_failure"]) if hasattr(c, "pressure")]
    missing = {c.__name__ for c in found} - set(PRESSURES)
    assert not missing, f"add p(J) of {missing} to PRESSURES"
    return [c(**EXAMPLES.get(c.__name__, {})) for c in found]


def cell(law, shape) -> Scene:
    """One cell of 1 mm between walls and a platen that moves at 1 m/s (times the factor a test gives)."""
    criterion = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6)
    rock = Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=criterion, after_failure=law)
    walls = (
        Wall(axis=0, side="lower", position=0.0),
        Wall(axis=0, side="upper", position=1e-3),
        Wall(axis=1, side="lower", position=0.0),
        Platen(axis=1, side="upper", position=1e-3, speed=-1.0, pulls=True),
    )
    return Scene(
        title="cell",
        domain=Domain(lower=(0.0, 0.0), upper=(1e-3, 1e-3), dx=1e-3),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(1e-3, 1e-3))),),
        rock=rock,
        loading=Loading(boundaries=walls, start=AtRest()),
        schedule=Schedule(t_end=1e-6, cfl=0.1),
        shape=shape,
    )


# every law with one shape function and every shape function with one law: kernels compile anew for each pair
PAIRS = [(law, Linear()) for law in after_failure_laws()]
PAIRS += [(CompressionOnly(), shape) for shape in (Gimp(), QuadraticBSpline())]


@pytest.mark.parametrize(("law", "shape"), PAIRS, ids=lambda part: type(part).__name__)
@pytest.mark.thorough("CompressionOnly-Gimp")
def test_failed_cell_follows_its_pressure_law_closing_opening_and_closing_again(taichi_f64, law, shape):
    from rsmpm_ti.fields.cell_order import sort_particles
    from rsmpm_ti.fields.state import Simulation
    from rsmpm_ti.mpm.stepper import ORDERS

    scene = cell(law, shape)
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    sim.particles.mode.fill(laws_shear_mode())
    dt, expected, J, pressures = scene.dt, PRESSURES[type(law).__name__], 1.0, []
    path = [1.0] * 60 + [-1.0] * 120 + [1.0] * 60  # close, open beyond the start, close to the start again
    for k, factor in enumerate(path):
        ORDERS["musl"](sim, dt, k * dt, [factor])
        J -= factor * dt / 1e-3  # v is linear over the cell, whose grid goes with the platen: exactly its height
        sigma = sim.particles.sigma.to_numpy()
        pressures.append(-sigma[0, 1])
        # J is a product of 240 factors, each exact to round-off; pressure is K times its distance from 1
        assert sim.particles.J.to_numpy() == pytest.approx(J, rel=1e-13)
        assert np.abs(sigma[:, :3] + expected(J)).max() < K * 1e-12
        assert np.abs(sigma[:, 3]).max() == 0.0  # no deviator, ever
    opened = pressures[150:200]
    assert max(opened) <= 0.0  # while J > 1 nothing pushes: pressure comes from total J, not from a rate
    assert abs(J - 1.0) < 1e-4
    assert sim.events.count[None] == 0  # a failed particle does not fail again


def laws_shear_mode() -> int:
    from rsmpm_ti.records.snapshot import SHEAR

    return SHEAR
