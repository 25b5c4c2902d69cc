"""Confining pressure: equilibrium from the start, traction on free surfaces, dry cracks, and the energy it brings."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest
import taichi as ti
from exact import p_wave_speed

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.analysis.summary import summarise
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.errors import SceneError
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.output.pictures import load_limits
from rsmpm_ti.records.snapshot import SHEAR, Snapshot
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import read_events, take_snapshot
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine, AtRest, Ramp
from rsmpm_ti.spec.regions import Box, Difference, Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice

pytestmark = pytest.mark.usefixtures("taichi_f64")

E, NU, DENSITY, P = 17e9, 0.14, 2600.0, 5e6
BULK = E / (3.0 * (1.0 - 2.0 * NU))
C_P = p_wave_speed(E, NU, DENSITY)
DX = 1e-3
ROCK = Rock(
    density=DENSITY,
    elasticity=Hooke(E=E, nu=NU),
    criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
)


def scene(region, loading: Loading, *, rock: Rock = ROCK, velocity=None, **parts) -> Scene:
    """One body in a domain with three empty cells around it, unless `lower` and `upper` say otherwise."""
    low, high = region.bounds()
    lower, upper = parts.pop("lower", tuple(low - 3 * DX)), parts.pop("upper", tuple(high + 3 * DX))
    body = Body(region=region, seeding=parts.pop("seeding", Lattice()), velocity=velocity)
    parts = {"schedule": Schedule(t_end=1.0), "shape": Linear(), **parts}
    return Scene(
        title="x", domain=Domain(lower=lower, upper=upper, dx=DX), bodies=(body,), rock=rock, loading=loading, **parts
    )


def specimen(p: float, dim: int = 2, **parts) -> Scene:
    """A specimen, 4 x 8 mm with a hole or 3 x 3 x 6 mm without one, pressed without failure or viscosity."""
    size = (4 * DX, 8 * DX) if dim == 2 else (3 * DX, 3 * DX, 6 * DX)
    whole = Box(lower=(0.0,) * dim, upper=size)
    hole = Disc(centre=(2.2 * DX, 3.0 * DX), radius=1.1 * DX)
    region = Difference(whole=whole, removed=(hole,)) if dim == 2 else whole
    axis = dim - 1
    platens = (
        Platen(axis=axis, side="lower", position=0.0, speed=0.02),
        Platen(axis=axis, side="upper", position=size[axis], speed=-0.02),
    )
    width = size[0] if dim == 2 else size[0] ** 2
    loading = Loading(boundaries=platens, start=Affine(), width=width, confinement=p)
    rock = replace(ROCK, criterion=Unbreakable(), viscosity=NoViscosity())
    edge = (3 * DX,) * axis
    lower, upper = (*(-e for e in edge), 0.0), (*(a + b for a, b in zip(size[:axis], edge, strict=True)), size[axis])
    schedule = Schedule(strain_end=6e-4, rows=100)
    return scene(region, loading, rock=rock, lower=lower, upper=upper, schedule=schedule, **parts)


@dataclass(frozen=True)
class Pressed:
    """A pressed specimen: its last state, its history and its summary."""

    state: Snapshot
    rows: np.ndarray
    summary: dict


def press(its: Scene) -> Pressed:
    """Press to the end. Without confinement the pressure that kernels could read is no number."""
    drive = set_up(its)
    if its.loading.confinement == 0.0:
        drive.sim.confinement = math.nan
    history = History(drive.sim, drive.clock, drive.survey)
    while not drive.clock.done:
        drive.advance(max(1, drive.clock.total // 100))
        history.record(drive.survey)
    table = history.table()
    summary = summarise(its, table, read_events(drive.sim), history.energy_start)
    return Pressed(take_snapshot(drive.sim, drive.clock.time), table, summary)


@pytest.fixture(scope="module")
def free(taichi_f64) -> Pressed:
    return press(specimen(0.0))


@pytest.fixture(scope="module")
def held(taichi_f64) -> Pressed:
    return press(specimen(P))


@pytest.fixture(scope="module")
def held_3d(taichi_f64) -> Pressed:
    return press(specimen(P, 3))


def test_flying_disc_feels_no_force_under_pressure_intact_or_failed():
    """sigma + p 1 = 0 makes no force whatever cells its jittered particles cross; nor does failed rock: K (1 - J) = p.

    Mass is that of the seeded area, which momentum and kinetic energy tell.
    """
    velocity = (200.0, -100.0)
    v = np.array(velocity)
    disc = Disc(centre=(0.0, 0.0), radius=3.3 * DX)
    parts = {"shape": QuadraticBSpline(), "seeding": Jittered(amount=0.3), "velocity": velocity}
    flying = scene(disc, Loading(confinement=P), **parts)
    area = sum(seeds.volume.sum() for seeds in flying.particles())
    drive = set_up(flying)
    np.testing.assert_allclose(drive.survey.momentum, DENSITY * area * v, rtol=1e-12)
    assert drive.survey.kinetic == pytest.approx(0.5 * DENSITY * area * v.dot(v), rel=1e-12)
    for mode in (0, SHEAR):
        drive.sim.particles.mode.fill(mode)
        drive.advance(15)
        state = take_snapshot(drive.sim, drive.clock.time)
        # velocities of 200 m/s keep round-off, a strain of 1e-16 a step; and K (1 - J) is p to the round-off of K
        np.testing.assert_allclose(state.sigma, np.tile(-P * np.eye(3), (len(state.x), 1, 1)), rtol=0.0, atol=1e-9 * P)
        assert np.abs(state.velocity - v).max() < 1e-9 * P / (DENSITY * C_P)
        assert state.volume.sum() == pytest.approx(area, rel=1e-12)
    assert np.abs(state.displacement).max() > 0.9 * DX


def test_pressure_on_a_free_surface_sends_the_wave_of_that_traction():
    """A column made stress-free feels p at its free end all at once: sigma = -p, v = -p/(rho c_p) behind the front."""
    cells = 60
    walls = tuple(Wall(axis=0, side=side, position=x) for side, x in (("lower", 0.0), ("upper", 2 * DX)))
    floor = Wall(axis=1, side="lower", position=0.0)
    column = Box(lower=(0.0, 0.0), upper=(2 * DX, cells * DX))
    loading = Loading(boundaries=(*walls, floor), confinement=P)
    rock = replace(ROCK, criterion=Unbreakable())
    upper = (2 * DX, (cells + 3) * DX)
    drive = set_up(scene(column, loading, rock=rock, lower=(0.0, 0.0), upper=upper))
    drive.sim.particles.sigma.fill(0.0)
    drive.advance(round(50 * DX / C_P / drive.clock.dt))  # the front has come 50 cells down
    state = take_snapshot(drive.sim, drive.clock.time)
    behind = (state.x[:, 1] > 25 * DX) & (state.x[:, 1] < 55 * DX)
    ahead = state.x[:, 1] < 2 * DX
    # the mean behind a front is exact, its ringing is not (docs/references.md, section 2); cut off here: 1 % is margin
    assert state.sigma[behind, 1, 1].mean() == pytest.approx(-P, rel=0.01)
    assert state.velocity[behind, 1].mean() == pytest.approx(-P / (DENSITY * C_P), rel=0.01)
    assert np.abs(state.sigma[ahead, 1, 1]).max() < 0.01 * P


def test_elastic_specimen_under_pressure_bears_the_stress_without_it_and_the_pressure(free, held):
    """Linear elasticity: sigma + p 1, platen stress - p and modulus are those of the unconfined one, hole and all."""
    largest = np.abs(free.state.sigma).max()
    # the same numbers in another order of rounding, over some hundred steps of a system without growth
    np.testing.assert_allclose(held.state.sigma + P * np.eye(3), free.state.sigma, rtol=0.0, atol=1e-9 * largest)
    np.testing.assert_allclose(held.state.displacement, free.state.displacement, rtol=0.0, atol=1e-9 * 5e-6)
    for column in ("stress_top_Pa", "stress_bottom_Pa"):
        np.testing.assert_allclose(held.rows[column] - P, free.rows[column], rtol=0.0, atol=1e-9 * largest)
    for name in ("apparent_modulus_Pa", "platen_imbalance", "platen_imbalance_max"):
        assert held.summary[name] == pytest.approx(free.summary[name], rel=1e-6), name
    assert free.summary["platen_imbalance"] > 1e-4  # the hole sits low, so there is something to compare
    assert (free.summary["confinement_Pa"], held.summary["confinement_Pa"]) == (0.0, P)


def test_unconfined_kernels_never_read_the_pressure(free):
    """It was no number there, and would be in every stress: the branch is compiled away."""
    assert np.isfinite(free.state.sigma).all() and np.isfinite(free.rows["work_J"]).all()


def test_confinement_brings_no_field():
    sims = [Simulation(its, its.particles()) for its in (specimen(0.0), specimen(P))]
    for part in ("particles", "nodes", "ledger", "report", "events"):
        one, other = ({k for k, v in vars(getattr(s, part)).items() if isinstance(v, ti.Field)} for s in sims)
        assert one == other


@pytest.mark.parametrize("run", ["held", pytest.param("held_3d", marks=pytest.mark.validation)])
def test_energy_balances_with_the_work_of_the_pressure(run, request):
    pressed = request.getfixturevalue(run)
    assert pressed.summary["energy_balance_error"] < 0.01
    # what the platens add, by their stress and strain, is not nearly all: the balance needs the pressure's part
    rows, volume = pressed.rows, 32 * DX**2 if run == "held" else 54 * DX**3
    stress = 0.5 * (rows["stress_top_Pa"] + rows["stress_bottom_Pa"]) - P
    platens = volume * np.sum(stress * np.diff(rows["axial_strain"], prepend=0.0))
    assert rows["work_J"][-1] > 1.4 * platens


@pytest.mark.validation
def test_specimen_in_3d_follows_hooke_from_its_confined_state(held_3d):
    """Uniaxial: d_sigma = E d_eps along the axis, of logarithmic strain by Hooke's law in rates; none across it."""
    axial = E * math.log(1.0 - held_3d.rows["axial_strain"][-1])
    sigma = held_3d.state.sigma + P * np.eye(3)
    # what the affine start does not know is of second order in the strain of 6e-4: a few of it
    assert sigma[:, 2, 2].mean() == pytest.approx(axial, rel=2e-3)
    assert np.abs(sigma[:, (0, 1), (0, 1)]).max() < 2e-3 * abs(axial)


def test_open_crack_is_dry():
    """Two halves, failed rock between, pulled apart under p: platens and rock bear nothing, not the pressure."""
    size = (2 * DX, 7 * DX)
    walls = tuple(Wall(axis=0, side=side, position=x) for side, x in (("lower", 0.0), ("upper", size[0])))
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=-0.05, pulls=True),
        Platen(axis=1, side="upper", position=size[1], speed=0.05, pulls=True),
    )
    start = Ramp(time=20 * size[1] / C_P)
    loading = Loading(boundaries=(*platens, *walls), start=start, width=size[0], confinement=P)
    pulled = scene(
        Box(lower=(0.0, 0.0), upper=size), loading, lower=(0.0, 0.0), upper=size, schedule=Schedule(strain_end=-1e-3)
    )
    drive = set_up(pulled)
    y = drive.sim.particles.reference.to_numpy()[:, 1]
    drive.sim.particles.mode.from_numpy(np.where(np.abs(y - 3.5 * DX) < 0.5 * DX, SHEAR, 0).astype(np.int32))
    history = History(drive.sim, drive.clock, drive.survey)
    drive.advance(drive.clock.total // 100)
    history.record(drive.survey)
    drive.advance(drive.clock.total * 3 // 4)
    history.record(drive.survey)
    drive.advance(drive.clock.total)
    history.record(drive.survey)
    rows = history.table()
    assert rows["stress_top_Pa"][0] == pytest.approx(P, rel=0.01)  # pressed by the fluid alone: hardly begun
    # the crack is open; what is left are waves of the pull, a hundredth of p
    assert abs(rows["stress_top_Pa"][-1]) < 0.02 * P
    assert len(read_events(drive.sim)) == 0


def test_axes_of_the_load_curve_reach_the_confined_strength():
    """Mohr-Coulomb, compression positive: UCS + tan^2(45 + 20 degrees) p = 25.520 + 4.5989 p MPa.

    docs/references.md, section 1.
    """
    long = replace(specimen(P), rock=ROCK, schedule=Schedule(strain_end=1e-2))
    assert load_limits(long, 32 * DX**2)[1] == pytest.approx(1.05 * (25.520e6 + 4.5989 * P), rel=1e-4)
    short = replace(specimen(P), rock=ROCK, schedule=Schedule(strain_end=1e-4))
    assert load_limits(short, 32 * DX**2)[1] == pytest.approx(P + 1e-4 * E / (1.0 - NU**2), rel=1e-9)


@pytest.mark.parametrize("p", [-1.0, math.nan, math.inf])
def test_pressure_that_is_none_is_refused(p):
    with pytest.raises(
        SceneError, match=r"loading\.confinement = \S+ is refused: it must be a number in \[0, 1e\+18\] Pa"
    ):
        Loading(confinement=p)


def test_rock_that_cannot_be_confined_is_refused():
    plate = replace(ROCK, elasticity=Hooke(E=E, nu=NU, plane_stress=True))
    region = Disc(centre=(0.0, 0.0), radius=3.3 * DX)
    with pytest.raises(SceneError, match="must be 0 in plane stress.*use plane strain"):
        scene(region, Loading(confinement=P), rock=plate)
    assert scene(region, Loading(start=AtRest()), rock=plate).dim == 2
    with pytest.raises(SceneError, match=r"loading\.confinement = .* at most 0\.1 of the bulk modulus, 7\.87e\+08 Pa"):
        scene(region, Loading(confinement=0.101 * BULK))
    assert scene(region, Loading(confinement=0.099 * BULK)).loading.confinement > 0.0


@pytest.mark.validation
def test_confinement_delays_and_shortens_the_wings_of_a_flaw():
    """The flaw's edge must feel p more tension, so failure needs (sigma_t + p)/sigma_t = 2 times the added stress."""
    coarse = {"dx": 2e-3, "flaw_width": 6e-3, "time_scale": 16.0}
    free = simulate(load_scene("cube", **coarse, strain_end=1.3e-4), threads=1)
    settings = {"loading.confinement": "2e6"}
    held = simulate(load_scene("cube", **coarse, strain_end=4e-4, settings=settings), threads=1)
    added = held.summary["first_failure_stress_Pa"] - 2e6
    # 5 % each: waves of a run with mass scaling decide when a particle at the limit goes
    assert added == pytest.approx(2.0 * free.summary["first_failure_stress_Pa"], rel=0.1)
    assert held.summary["failed_tension"] > 10 and held.summary["failed_shear"] == 0
    assert np.abs(held.events.x[:, 1] - 50e-3).max() < 15e-3  # the flaw itself reaches 5.3 mm, without p 50 mm are lost
    assert held.summary["energy_balance_error"] < 0.01
