"""The slit specimen of `cube_lab` turned against the grid, loaded by traction on its ends; its cracks, turned back."""

import math
from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti import load_scene
from rsmpm_ti.averaging import Local
from rsmpm_ti.drive import Drive
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.laws import CompressionOnly
from rsmpm_ti.observe import read_events
from rsmpm_ti.regions import Difference, Slit
from rsmpm_ti.seeding import Jittered, Lattice
from rsmpm_ti.snapshot import TENSION
from rsmpm_ti.spec import Body, Domain, Loading, Scene, Schedule

HEIGHT, WIDTH, SIDE = 100e-3, 50e-3, 124e-3
"""Specimen, and edge of the square domain in which it may turn [m]."""

CAP = 5e-3
"""Depth of the end layers that carry the load as a body force [m]."""

SMOOTH_START = 2e-3
"""Time in which the rate of loading rises [s]."""

YOUNG, GROWN, LOOKS = 5e-3, 21e-3, 200
"""A wing is measured when it is so long along the load axis [m]: its first direction, then its path. Looks in a run."""


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


def turned_scene(*, angle: float, dx: float, seed: int, paper: bool, end: float, time_scale: float) -> Scene:
    """`cube_lab` turned by `angle` [degrees], loaded up to `end` [Pa]; `paper`: with the paper's rule on a lattice."""
    lab = load_scene("cube_lab", dx=dx)
    rock = lab.rock
    centre = (0.5 * SIDE, 0.5 * SIDE)
    (flaw,) = lab.bodies[0].region.removed
    flaw = replace(flaw, centre=centre, angle=flaw.angle + angle)
    whole = Slit(centre=centre, length=HEIGHT, width=WIDTH, angle=90.0 + angle)
    seeding = Jittered(seed=seed, fitted=True)
    rate = 800e6
    if paper:
        rock = replace(rock, after_failure=CompressionOnly(), averaging=Local())
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


def opened(drive: Drive, dx: float) -> tuple[np.ndarray, np.ndarray]:
    """Places [m] of particles that have cracked in tension, and how far each has opened [m]."""
    particles = drive.sim.particles
    place = particles.reference.to_numpy() + particles.u.to_numpy()
    if particles.cracks:
        gap = particles.opening.to_numpy()[:, 0] * drive.sim.band
    else:
        gap = np.maximum(particles.J.to_numpy() - 1.0, 0.0) * dx
    cracked = (particles.mode.to_numpy() == TENSION) & (gap > 0.0)
    return place[cracked], gap[cracked]


def grow(*, angle: float, dx: float, seed: int, paper: bool, end: float, time_scale: float) -> dict:
    """Load until both wings are GROWN long, or up to `end` [Pa].

    Of each wing, "0" the upper and "1" the lower one, turned back and the lower one by 180 degrees: place and gap of
    what has opened when it was YOUNG and when it was GROWN (or at the end), place of its first failure; all [m].
    Loads [Pa].
    """
    real = ti.lang.impl.get_runtime().default_fp
    scene = turned_scene(angle=angle, dx=dx, seed=seed, paper=paper, end=end, time_scale=time_scale)
    drive = Drive(scene, scene.particles(), real)
    traction = scene.loading.force_field
    turn = math.radians(angle)
    back = np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
    tip = 0.5 * scene.bodies[0].region.removed[0].length * math.sin(math.radians(45.0))
    wings, stopped = {}, ""
    for look in range(1, LOOKS + 1):
        try:
            drive.advance(max(0, round(drive.clock.total * look / LOOKS) - drive.clock.step))
        except UnstableRun as error:
            stopped = str(error)
        events = read_events(drive.sim)
        failed = (events.x[events.mode == TENSION].astype(float) - 0.5 * SIDE) @ back
        for name, sign in (("0", 1.0), ("1", -1.0)):
            side = failed[sign * failed[:, 1] > 0.0] * sign
            for age, length in (("young", YOUNG), ("grown", GROWN)):
                ripe = len(side) > 0 and (side[:, 1].max() - tip > length or stopped or look == LOOKS)
                if ripe and f"{age}_x_{name}" not in wings:
                    place, gap = opened(drive, dx)
                    place = (place.astype(float) - 0.5 * SIDE) @ back * sign
                    half = place[:, 1] > 0.0
                    wings |= {f"{age}_x_{name}": place[half], f"{age}_gap_{name}": gap[half]}
                    wings[f"start_{name}"] = side[0]
        if {"grown_x_0", "grown_x_1"} <= wings.keys() or stopped:
            break
    return {
        "load": traction.load(drive.clock.time),
        "onset": traction.load(min(drive.sim.events.onset[None], events.time.min(initial=np.inf))),
        "particles": np.array(drive.sim.particles.count),
        "steps": np.array(drive.clock.step),
        "stopped": np.array(stopped),
        **wings,
    }
