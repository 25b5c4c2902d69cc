"""Local damping brings what swings to rest, and leaves alone what is strained steadily, flies or has failed."""

from dataclasses import replace

import numpy as np
import pytest
from small_scene import DX, SPEED, body, make, refusal

from rsmpm_ti import AtRest, Box, Lattice, simulate
from rsmpm_ti.analysis.load_curve import loading_curve
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.spec.scene import Body

WIDTH, HEIGHT = 10e-3, 20e-3
TRANSIT = HEIGHT / SPEED


def column(damping: float, transits: float = 12.0, **changes):
    """A column of 20 x 40 cells between smooth platens."""
    lower, upper = make().loading.boundaries
    return make(
        domain_dx=2 * DX, domain_lower=(-4 * DX, 0.0), domain_upper=(WIDTH + 4 * DX, HEIGHT),
        bodies=changes.pop("bodies", body(region=Box(lower=(0.0, 0.0), upper=(WIDTH, HEIGHT)))),
        loading_boundaries=(replace(lower, speed=0.1), replace(upper, position=HEIGHT, speed=-0.1)),
        loading_width=WIDTH, loading_local_damping=damping,
        schedule={"t_end": transits * TRANSIT, "rows": 200}, **changes,
    )  # fmt: skip


def ringing(history) -> float:
    """Largest distance of the load from E' times the strain in the last fifth of the rows, over the load at the end."""
    _, stress, strain = loading_curve(history)
    theory = 17e9 / (1.0 - 0.14**2) * strain
    return float(np.abs(stress - theory)[-len(history) // 5 :].max() / theory[-1])


def balance(history) -> float:
    """Energy from nowhere over the largest work."""
    energies = sum(history[f"energy_{name}_J"] for name in ("kinetic", "elastic", "dissipated"))
    return float(np.abs(energies - history["work_J"]).max() / history["work_J"].max())


@pytest.mark.thorough
def test_column_that_is_pressed_at_once_comes_to_the_load_of_statics():
    """Undamped, the wave of the platens goes to and fro for ever."""
    free = simulate(column(0.0, loading_start=AtRest()), threads=1).history
    damped = simulate(column(0.7, loading_start=AtRest()), threads=1).history
    assert ringing(free) > 0.01
    # a factor of (1 - a)/(1 + a) in every half period is the law's own, and there are 20
    assert ringing(damped) < 2e-3
    assert damped["energy_dissipated_J"][-1] > 0.0 and np.diff(damped["energy_dissipated_J"]).min() >= 0.0
    assert balance(damped) < 5e-3 and balance(free) < 5e-3


def test_steady_straining_is_not_damped():
    runs = [simulate(column(a, 4.0), threads=1) for a in (0.0, 0.7)]
    free, damped = (run.history for run in runs)
    # what is damped at first is what the motion of the start lacks to be exact beside the sides: waves that die out
    wanted, late = nominal_stress(free), slice(len(free) // 4, None)
    np.testing.assert_allclose(nominal_stress(damped)[late], wanted[late], rtol=0.0, atol=1e-3 * wanted[-1])
    assert runs[1].summary["local_damping_J"] < 3e-4 * damped["work_J"][-1]


@pytest.mark.thorough
def test_body_that_flies_is_left_alone():
    """Without a force there is nothing to take a fraction of, but for round-off."""
    flying = Body(region=Box(lower=(2e-3, 6e-3), upper=(6e-3, 10e-3)), seeding=Lattice(), velocity=(0.3, 0.2))
    free, damped = (simulate(column(a, 0.3, bodies=(flying,), loading_start=AtRest()), threads=1) for a in (0.0, 0.8))
    np.testing.assert_allclose(damped.snapshot.velocity, free.snapshot.velocity, rtol=1e-12)


@pytest.mark.filterwarnings("ignore::rsmpm_ti.RockWarning")
def test_rock_that_has_failed_is_left_alone():
    """All of it fails at the first wave, by a strength of nearly nothing: from then on no energy is taken."""
    weak = MohrCoulomb(cohesion=1e3, friction_angle=30.0, tensile_strength=1e2)
    scene = column(0.7, 1.0, loading_start=AtRest())
    scene = replace(scene, rock=replace(scene.rock, criterion=weak))
    whole, broken = (simulate(s, threads=1) for s in (scene.elastic(), scene))
    assert len(broken.events) > 0.9 * broken.summary["particles"]
    assert broken.summary["local_damping_J"] < 0.1 * whole.summary["local_damping_J"]


@pytest.mark.parametrize("value", [-0.1, 0.9, float("nan")])
def test_damping_is_a_fraction(value):
    assert "loading.local_damping" in refusal(lambda: column(value))


def test_damping_needs_platens_whose_motion_it_spares():
    still = {"boundaries": (), "local_damping": 0.5}
    assert "nothing faces" in refusal(lambda: make(loading=still, schedule={"t_end": 1e-5}))
