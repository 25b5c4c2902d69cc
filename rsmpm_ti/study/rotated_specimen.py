"""The slit specimen of `cube_lab` turned against the grid, loaded by traction on its ends; its cracks, turned back."""

import math
from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti import load_scene
from rsmpm_ti.analysis.wing_cracks import crack_directions
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.records.snapshot import SHEAR, TENSION
from rsmpm_ti.rock.after_failure import CompressionOnly
from rsmpm_ti.rock.nonlocal_mean import Local
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.readout import read_events
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice
from rsmpm_ti.study.flaw_cracks import lost_in_tension, near_flaw

HEIGHT, WIDTH, SIDE = 100e-3, 50e-3, 124e-3
"""Specimen, and edge of the square domain in which it may turn [m]."""

CAP = 5e-3
"""Depth of the end layers that carry the load as a body force [m]."""

SMOOTH_START = 2e-3
"""Time in which the rate of loading rises [s]."""

GROWN, LOOKS = 21e-3, 400
"""A run ends when both wings are so long along the load axis [m]. Looks in a run."""

ENDS = {"0": 1.0, "1": -1.0}
"""The wings: of the flaw's upper end, and of its lower one, whose places are turned by 180 degrees onto the other's."""


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class EndTraction:
    """Pressure on both ends of the turned specimen, as a body force in its end layers: rises by `rate` [Pa/s]."""

    angle: float
    density: float
    rate: float

    @property
    def axis(self) -> tuple[float, float]:
        return -math.sin(math.radians(self.angle)), math.cos(math.radians(self.angle))

    def load(self, time):
        """Nominal axial stress [Pa], compression positive, of times [s]."""
        time = np.asarray(time)
        return self.rate * np.where(time < SMOOTH_START, 0.5 * time**2 / SMOOTH_START, time - 0.5 * SMOOTH_START)

    def time_of(self, load: float) -> float:
        return load / self.rate + 0.5 * SMOOTH_START

    @ti.func
    def acceleration(self, X, t):
        axis = ti.Vector(self.axis)
        along = (X - 0.5 * SIDE).dot(axis)
        load = self.rate * ti.select(t < SMOOTH_START, 0.5 * t * t / SMOOTH_START, t - 0.5 * SMOOTH_START)
        push = ti.Vector([0.0, 0.0])
        if ti.abs(along) > 0.5 * HEIGHT - CAP:
            push = -axis * ti.select(along > 0.0, 1.0, -1.0) * load / (self.density * CAP)
        return push


def turned_scene(
    *, angle: float, dx: float, length: float, seed: int, paper: bool, end: float, time_scale: float
) -> Scene:
    """`cube_lab` turned by `angle` [degrees], loaded up to `end` [Pa]; `paper`: with the paper's rule on a lattice.

    length: of the mean stress [m].
    """
    lab = load_scene("cube_lab", dx=dx, length=length)
    rock = lab.rock
    centre = (0.5 * SIDE, 0.5 * SIDE)
    (flaw,) = lab.bodies[0].region.removed
    flaw = replace(flaw, centre=centre, angle=flaw.angle + angle)
    whole = Slit(centre=centre, length=HEIGHT, width=WIDTH, angle=90.0 + angle)
    seeding = Jittered(seed=seed, fitted=True)
    rate = 800e6
    if paper:
        rock = replace(rock, after_failure=CompressionOnly(), nonlocal_mean=Local())
        seeding = Lattice()
    traction = EndTraction(angle=angle, density=rock.density, rate=rate)
    return Scene(
        title="turned",
        domain=Domain(lower=(0.0, 0.0), upper=(SIDE, SIDE), dx=dx),
        bodies=(Body(region=Difference(whole=whole, removed=(flaw,)), seeding=seeding),),
        rock=rock,
        loading=Loading(force_field=traction, time_scale=time_scale),
        schedule=Schedule(t_end=traction.time_of(end)),
    )


def grow(*, angle: float, dx: float, length: float, seed: int, paper: bool, end: float, time_scale: float) -> dict:
    """Load until both wings are GROWN long, or up to `end` [Pa].

    Of each wing, all turned back: `failed`, positions [n, 2] of what failed in tension, in order of time [m]; `first`,
    angles from the flaw's plane of the first cracks at its end, seen when they had just begun [k] [degrees], none by
    the paper's rule. `onset`: load when strength is first lost in tension near that end; `shear`: when the first
    particle fails in shear; NaN if none does. `load` and `wings`: at every look, with the wings' lengths [k, 2] [m];
    loads in Pa, known to a part in LOOKS of the whole.
    """
    real = ti.lang.impl.get_runtime().default_fp
    scene = turned_scene(angle=angle, dx=dx, length=length, seed=seed, paper=paper, end=end, time_scale=time_scale)
    drive = Drive(scene, scene.particles(), real)
    traction = scene.loading.force_field
    (flaw,) = scene.bodies[0].region.removed
    tip = 0.5 * flaw.length * math.sin(math.radians(flaw.angle - angle))
    first, onset, load, wings, stopped = {}, {}, [], [], ""
    for look in range(1, LOOKS + 1):
        try:
            drive.advance(max(0, round(drive.clock.total * look / LOOKS) - drive.clock.step))
        except UnstableRun as error:
            stopped = str(error)
        load.append(float(traction.load(drive.clock.time)))
        if len(onset) < len(ENDS):
            first = first_cracks(drive, flaw) | first
            onset = dict.fromkeys(first, load[-1]) | onset
        failed = failed_positions(drive, angle)
        wings.append([side[:, 1].max(initial=tip) - tip for side in failed.values()])
        if stopped or min(wings[-1]) > GROWN:
            break
    events = read_events(drive.sim)
    shear = events.time[events.mode == SHEAR]
    return {
        "load": np.array(load),
        "wings": np.array(wings),
        "shear": traction.load(shear[0]) if len(shear) else np.array(np.nan),
        "particles": np.array(drive.sim.particles.count),
        "steps": np.array(drive.clock.step),
        "stopped": np.array(stopped),
        **{f"onset_{name}": np.array(onset.get(name, np.nan)) for name in ENDS},
        **{f"first_{name}": angles for name, angles in first.items() if not paper},
        **{f"failed_{name}": positions for name, positions in failed_positions(drive, angle).items()},
    }


def first_cracks(drive: Drive, flaw: Slit) -> dict[str, np.ndarray]:
    """For each end of the flaw where cracks have begun: their angles from the flaw's plane [k] [degrees]."""
    positions, normals = lost_in_tension(drive)
    near, begun = near_flaw(flaw, positions)
    normals = normals[near] - math.radians(flaw.angle)
    found = {}
    for name, sign in ENDS.items():
        side = sign * begun[:, 0] > 0.0
        if side.any():
            found[name] = crack_directions(begun[side], normals[side], 0.5 * (flaw.length - flaw.width))
    return found


def failed_positions(drive: Drive, angle: float) -> dict[str, np.ndarray]:
    """For each end of the flaw: places of tensile failures in its half of the specimen, turned back [n, 2] [m]."""
    turn = math.radians(angle)
    back = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    events = read_events(drive.sim)
    x = (events.x[events.mode == TENSION].astype(float) - 0.5 * SIDE) @ back
    return {name: sign * x[sign * x[:, 1] > 0.0] for name, sign in ENDS.items()}
