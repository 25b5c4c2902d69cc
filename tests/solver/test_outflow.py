"""What leaves the domain: the run ends, or what left is counted, booked and gone."""

import json
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from rsmpm_ti import simulate
from rsmpm_ti.errors import SceneError, UnstableRun
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import LinearSoftening
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.guard import guard
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.solver.survey import survey
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

DX, SPEED, UPPER = 1e-3, 100.0, 0.02
BEYOND = 2.0 * DX
"""How far a particle may fly beyond the domain."""

CRITERION = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6)


def flight(outside: str, grid: str = "dense", t_end: float = 6e-5) -> Scene:
    """Two blocks of 4 x 4 mm in free flight: one leaves the domain to the right, half of it in this time, one stays."""
    leaving = Body(region=Box(lower=(0.014, 0.008), upper=(0.018, 0.012)), velocity=(SPEED, 0.25 * SPEED))
    staying = Body(region=Box(lower=(0.004, 0.008), upper=(0.008, 0.012)), velocity=(0.1 * SPEED, 0.0))
    return Scene(
        title="flight",
        domain=Domain(lower=(0.0, 0.0), upper=(UPPER, UPPER), dx=DX, grid=grid, outside=outside),
        bodies=(leaving, staying),
        rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=CRITERION),
        loading=Loading(),
        schedule=Schedule(t_end=t_end),
    )


def started(scene: Scene) -> tuple[Drive, np.ndarray, np.ndarray]:
    """A drive, and places and velocities of its particles in the order of their ids."""
    drive = Drive(scene, scene.particles(), ti.f64)
    particles = drive.sim.particles
    order = np.argsort(particles.id.to_numpy())
    return drive, particles.reference.to_numpy()[order], particles.v.to_numpy()[order]


@pytest.mark.parametrize("threads", [1, pytest.param(2, marks=pytest.mark.validation)])
def test_what_flies_off_is_dropped_and_the_rest_flies_on(restart_taichi, threads):
    restart_taichi(ti.f64, threads)
    scene = flight("drop")
    drive, x, v = started(scene)
    start = drive.survey
    while not drive.clock.done:
        drive.advance(10)
        now = drive.survey
        # round-off of some hundred additions, of numbers of this size: here and below
        momentum, energy = now.momentum + drive.dropped.momentum, now.kinetic + now.elastic + now.dissipated
        assert np.abs(momentum - start.momentum).max() < 1e-11 * abs(start.momentum[0])
        assert energy == pytest.approx(start.kinetic, rel=1e-11)
    way = v * drive.clock.time
    left = (x + way)[:, 0] > UPPER + BEYOND
    assert 0 < left.sum() < 64  # between the columns of the block
    mass = 2600.0 * (0.5 * DX) ** 2
    assert drive.dropped.count == left.sum()
    assert drive.dropped.mass == pytest.approx(left.sum() * mass, rel=1e-12)
    np.testing.assert_allclose(drive.dropped.momentum, mass * v[left].sum(axis=0), rtol=1e-11)
    assert drive.dropped.energy == pytest.approx(0.5 * mass * (v[left] ** 2).sum(), rel=1e-10)
    # the others, in the order of their ids, on a straight line at constant velocity, stressed by round-off strain only
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    np.testing.assert_allclose(snapshot.x, (x + way)[~left], rtol=0.0, atol=1e-12 * UPPER)
    np.testing.assert_allclose(snapshot.velocity, v[~left], rtol=0.0, atol=1e-10 * SPEED)
    assert np.abs(snapshot.sigma).max() < 1e-9 * 17e9
    assert now.failed_tension == now.failed_shear == now.sick == now.outside == 0
    assert all(np.isfinite(column).all() for column in (snapshot.volume, snapshot.margin, snapshot.damage))
    assert (snapshot.failure_mode == 0).all() and np.isnan(snapshot.failure_time).all()
    if threads == 1:
        everything_may_leave_or_end_the_run(drive)


def everything_may_leave_or_end_the_run(drive: Drive) -> None:
    """The same particles thrown on until none is left; and failed ones say nothing of the waves in intact rock."""
    particles = drive.sim.particles
    particles.J.fill(1.01)
    drive.survey = survey(drive.sim)
    assert drive.survey.J_intact == pytest.approx(1.01)
    particles.mode.fill(1)
    assert survey(drive.sim).J_intact == 0.0
    particles.u.fill(UPPER)
    drive.clock = Clock(drive.sim)
    with pytest.raises(UnstableRun, match="every particle has left the domain; enlarge it"):
        drive.advance(1)


@pytest.mark.validation
def test_a_run_that_everything_leaves_has_booked_all_of_it(tmp_path):
    """Mass, momentum and energy of one block in free flight, every file, and no division by what is not there."""
    scene = replace(flight("drop", t_end=2.5e-4), bodies=flight("drop").bodies[:1])
    with pytest.raises(UnstableRun, match="every particle has left") as ended:
        simulate(scene, out=tmp_path, threads=1)
    summary = json.loads((tmp_path / "summary.json").read_text())
    mass = 2600.0 * (4e-3) ** 2
    assert summary["dropped"] == summary["particles"] == 64
    assert summary["dropped_mass_kg"] == pytest.approx(mass, rel=1e-12)
    assert summary["dropped_momentum_kg_m_s"] == pytest.approx([mass * SPEED, 0.25 * mass * SPEED], rel=1e-11)
    assert summary["dropped_energy_J"] == pytest.approx(0.5 * mass * SPEED**2 * (1.0 + 0.25**2), rel=1e-10)
    assert summary["fragments"] == 0 and summary["largest_fragment_share"] is None
    assert len(ended.value.result.snapshot.id) == 0 and (tmp_path / "summary.png").exists()


def test_without_drop_the_run_ends_and_says_so(restart_taichi):
    restart_taichi(ti.f64, 1)
    scene = flight("stop")
    drive = Drive(scene, scene.particles(), ti.f64)
    drive.sim.particles.u.fill(0.5 * UPPER)  # one block out of the domain, the other still in it
    with pytest.raises(UnstableRun, match="64 particles .* left the domain at step 0.*domain.outside = drop"):
        guard(drive.sim, drive.clock, survey(drive.sim))


def test_the_domain_grows_to_where_particles_fly(restart_taichi):
    """Four domain lengths on every side, on a sparse grid: a straight line, no stress; and beyond them the run ends."""
    restart_taichi(ti.f64, 1)
    scene = flight("grow", grid="sparse", t_end=3e-4)
    drive, x, v = started(scene)
    particles, start = drive.sim.particles, drive.survey
    while not drive.clock.done:
        drive.advance(500)
        guard(drive.sim, drive.clock, drive.survey)
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    assert snapshot.x.max() > 2.3 * UPPER, "more than a length beyond the domain"
    # round-off of some thousand additions, as above; a node that is dropped as too light while a particle reaches it
    # would show: those below 1e-12 of a cell made 80 Pa
    np.testing.assert_allclose(snapshot.x, x + v * drive.clock.time, rtol=0.0, atol=1e-12 * UPPER)
    np.testing.assert_allclose(snapshot.velocity, v, rtol=0.0, atol=1e-10 * SPEED)
    assert np.abs(snapshot.sigma).max() < 1e-13 * 17e9
    assert np.abs(drive.survey.momentum - start.momentum).max() < 1e-11 * abs(start.momentum[0])
    assert drive.dropped.count == drive.survey.failed_tension == 0
    particles.u.fill(5.1 * UPPER)
    with pytest.raises(UnstableRun, match="left the domain"):
        guard(drive.sim, drive.clock, survey(drive.sim))


def test_room_to_grow_is_what_32_bits_can_count():
    assert Domain(lower=(0.0, 0.0), upper=(0.02, 0.01), dx=DX, grid="auto", outside="grow").room == 80
    assert Domain(lower=(0.0, 0.0), upper=(0.02, 0.01), dx=DX).room == 0
    cube = Domain(lower=(0.0,) * 3, upper=(0.2,) * 3, dx=DX, grid="sparse", outside="grow")
    assert 200 <= cube.room < 800
    assert (200 + 2 * cube.room) ** 3 < 2**31


@pytest.mark.parametrize(
    "wrong, message",
    [
        ({"outside": "wrap"}, "domain.outside = 'wrap' is refused: it must be 'stop', 'drop' or 'grow'"),
        ({"outside": "grow"}, "domain.outside = 'grow' is refused: .* set domain.grid = 'sparse'"),
    ],
)
def test_what_cannot_be_is_refused(wrong, message):
    with pytest.raises(SceneError, match=message):
        replace(flight("stop").domain, **wrong)


def test_averages_and_a_domain_that_grows_are_refused():
    scene = flight("grow", grid="sparse")
    softening = LinearSoftening(G_f_I=5.0, G_f_II=50.0)
    rock = replace(scene.rock, after_failure=Directional(softening=softening), nonlocal_mean=Nonlocal(length=3e-3))
    with pytest.raises(SceneError, match="domain.outside = 'grow' is refused: .* with rock.nonlocal_mean"):
        replace(scene, rock=rock)
