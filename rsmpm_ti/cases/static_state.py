"""Ways to bring a scene to the state that a reference describes. They all step the real solver."""

from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti.records.snapshot import Snapshot
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.loading_start import Press
from rsmpm_ti.spec.scene import Scene, Schedule

LOOKS = 24
"""Snapshots over the hold of a static state, whose mean removes what still swings."""


def set_up(scene: Scene, real=ti.f64) -> Drive:
    """The scene's particles and clock; Taichi must have been started."""
    return Drive(scene, scene.particles(), real)


@dataclass(frozen=True)
class Static:
    """A static state: snapshot with the mean stress of the hold, nominal stress and platen strain (compression +)."""

    snapshot: Snapshot
    sigma: np.ndarray  # mean Cauchy stress of the hold, tension positive [Pa], [n, 3, 3]
    nominal: float  # mean platen force over the loaded width, [Pa]
    strain: float


def without_viscosity(scene: Scene) -> Scene:
    """The same scene, none of whose rocks has artificial viscosity."""

    def plain(rock: Rock) -> Rock:
        return replace(rock, viscosity=NoViscosity())

    bodies = tuple(body if body.rock is None else replace(body, rock=plain(body.rock)) for body in scene.bodies)
    return replace(scene, rock=plain(scene.rock), bodies=bodies)


def static_state(scene: Scene, *, press: float = 8.0, hold: float = 4.0, cfl: float = 1.0) -> Static:
    """Press the platens together during `press` wave transits, hold for `hold` more, and average over the hold.

    Failure, viscosity and mass scaling are switched off: they have no part in an elastic static state.
    """
    scene = without_viscosity(scene.elastic())
    transit = scene.loading.height / scene.rock.wave_speed()
    loading = replace(scene.loading, start=Press(time=press * transit), time_scale=1.0)
    schedule = Schedule(t_end=(press + hold) * transit, cfl=cfl)
    drive = set_up(replace(scene, loading=loading, schedule=schedule))
    clock = drive.clock
    drive.advance(round(press * transit / clock.dt))
    impulse, start, sigma = drive.survey.impulse, clock.time, np.zeros(())
    for left in range(LOOKS, 0, -1):
        drive.advance(max(1, (clock.total - clock.step) // left))
        snapshot = take_snapshot(drive.sim, clock.time)
        sigma = sigma + snapshot.sigma / LOOKS
    forces, cell = (drive.survey.impulse - impulse) / (clock.time - start), loading.load_cell
    assert cell is not None  # a scene with a height has two platens
    return Static(snapshot, sigma, cell.read(forces).stress, clock.strain)
