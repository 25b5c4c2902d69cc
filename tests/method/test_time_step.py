"""Steps that adapt: as short as waves and particles ask for, and on time."""

import math
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from exact import p_wave_speed

from rsmpm_ti import load_scene
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import initial_velocity
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.survey import survey
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

E, NU, RHO = 17e9, 0.14, 2600.0
C = p_wave_speed(E, NU, RHO)
DX, CFL, SPEED = 1e-3, 0.5, 0.1 * C
ROW = 5
"""Steps of the scene's dt between two looks: so few that nothing moves further than the drive allows."""


def impact() -> Scene:
    """A block of 10 x 10 mm, 2 mm from a wall, that flies against it at a tenth of the wave speed, and back."""
    return Scene(
        title="impact",
        domain=Domain(lower=(0.0, -0.01), upper=(0.03, 0.02), dx=DX),
        bodies=(Body(region=Box(lower=(0.002, 0.0), upper=(0.012, 0.01)), velocity=(-SPEED, 0.0)),),
        rock=Rock(
            density=RHO, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity()
        ),
        loading=Loading(boundaries=(Wall(axis=0, side="lower", position=0.0),)),
        schedule=Schedule(t_end=2.5e-5, cfl=CFL, adaptive=True),
    )  # fmt: skip


def begin_again(drive: Drive, scene: Scene) -> None:
    """The body as it was built, for a scene with another schedule."""
    particles = drive.sim.particles
    for field in (particles.u, particles.sigma):
        field.fill(0.0)
    particles.J.fill(1.0)
    particles.v.from_numpy(initial_velocity(scene, 0, particles.reference.to_numpy()))
    sort_particles(drive.sim)
    drive.sim.scene = scene
    drive.clock, drive.survey = Clock(drive.sim), survey(drive.sim)


def test_an_impact_takes_the_steps_of_the_closed_form_and_keeps_time_momentum_and_energy(restart_taichi):
    restart_taichi(ti.f64, 1)
    scene = impact()
    drive = Drive(scene, scene.particles(), ti.f64)
    particles, clock = drive.sim.particles, drive.clock
    start = drive.survey
    dts, largest, time = [], 1.0, 0.0
    row = ROW * CFL * DX / C
    while not clock.done:
        J = particles.J.to_numpy().max()
        v = np.linalg.norm(particles.v.to_numpy(), axis=1).max()
        most = min(CFL * DX / C, CFL * DX / (C * math.sqrt(J) + v))
        span, before = min(row, scene.t_end - clock.time), clock.step
        drive.advance(ROW)
        time += span
        # whole steps of one length to the end of the row, as few as the closed form allows
        assert clock.step - before == math.ceil(span / most - 1e-9)
        assert clock.dt == pytest.approx(span / (clock.step - before), rel=1e-12)
        assert clock.time == pytest.approx(time, rel=1e-14)
        dts.append(clock.dt)
        largest = max(largest, J)
    assert clock.time == pytest.approx(scene.t_end, rel=1e-14)
    # free flight: dx cfl/(c + v), in whole steps to a row: 6 in place of 5
    assert dts[0] == pytest.approx(row / math.ceil(ROW * 1.1), rel=1e-12)
    assert largest > 1.02 and min(dts) < dts[0]  # the rebound pulls the block apart, and steps shrink further
    # what the wall gave is what the block has gained: additions in another order
    gained = drive.survey.momentum - start.momentum
    assert np.abs(gained - drive.survey.impulse[0]).max() < 1e-12 * abs(start.momentum[0])
    assert drive.survey.momentum[0] > 0.5 * abs(start.momentum[0])  # it has bounced
    # a closed system, of which musl loses what is too short for the grid: the block's shock, with each step alike. So
    # steps that adapt, of which there are more, lose that much more, and nothing ever gains
    lost = 1.0 - (drive.survey.kinetic + drive.survey.elastic) / start.kinetic
    steps = clock.step
    begin_again(drive, replace(scene, schedule=replace(scene.schedule, adaptive=False)))
    drive.advance(drive.clock.total)
    fixed = 1.0 - (drive.survey.kinetic + drive.survey.elastic) / start.kinetic
    assert 0.0 < lost < 1.05 * fixed * steps / drive.clock.step
    assert drive.clock.time - scene.dt < scene.t_end <= drive.clock.time  # without, the end is that of a whole step


def rows_of(drive: Drive) -> np.ndarray:
    """The history of a run to its end, some 50 rows."""
    history = History(drive.sim, drive.clock, drive.survey)
    steps = drive.clock.total // 50
    while not drive.clock.done:
        drive.advance(steps)
        history.record(drive.survey)
    return history.table()


@pytest.mark.validation
def test_a_slow_test_gives_the_same_with_steps_that_adapt(restart_taichi):
    restart_taichi(ti.f64, 1)
    pulled = load_scene("intact", dx=5e-3, strain_end=-1.2e-4, time_scale=10.0).elastic()
    drive = Drive(pulled, pulled.particles(), ti.f64)
    fixed = rows_of(drive)
    begin_again(drive, replace(pulled, schedule=replace(pulled.schedule, adaptive=True)))
    adapted = rows_of(drive)
    assert (adapted["dt_s"] < fixed["dt_s"]).all()  # rock in tension is lighter, so waves are faster
    rows = slice(0, len(fixed) - 1)  # the last one ends with a whole step, or on time
    np.testing.assert_allclose(adapted["time_s"][rows], fixed["time_s"][rows], rtol=1e-12)
    np.testing.assert_allclose(adapted["axial_strain"][rows], fixed["axial_strain"][rows], rtol=1e-9)
    assert adapted["time_s"][-1] == pytest.approx(pulled.t_end, rel=1e-14)
    # a step's force is of its start, so the mean over a row is half a step old: E' times the strain rate times that.
    # The rest is of second order in the step, and of waves that came from it
    newer = 0.5 * (fixed["dt_s"] - adapted["dt_s"])[rows] * E / (1.0 - NU**2) * pulled.loading.strain_rate
    stress = fixed["stress_top_Pa"][rows]
    np.testing.assert_allclose(adapted["stress_top_Pa"][rows], stress + newer, atol=3e-4 * abs(stress).max())
    elastic = fixed["energy_elastic_J"][rows]
    np.testing.assert_allclose(adapted["energy_elastic_J"][rows], elastic, atol=1e-3 * elastic.max())
