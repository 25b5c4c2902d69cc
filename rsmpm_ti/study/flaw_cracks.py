"""A specimen with one flaw, loaded until it cracks from the flaw: where and at which load it begins, at which angle."""

from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti import load_scene
from rsmpm_ti.analysis.crack_path import REACH
from rsmpm_ti.analysis.load_curve import loading_curve
from rsmpm_ti.analysis.neighbours import bands_of, neighbour_graph
from rsmpm_ti.analysis.wing_cracks import crack_directions, leaving_angle
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.records.snapshot import TENSION
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import read_events
from rsmpm_ti.spec.regions import Slit, slits_of
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Jittered

WIDTH = 3e-3
"""Width of every flaw [m]."""

STRAIN_END = {"cube": 1.0e-3, "disc": 4.0e-4}
"""A specimen that has not cracked by then does not."""

LOOKS = 1000
"""Looks at a run; its onset is known to a part in this."""

GROWN = 5e-3
"""A wing is measured when it is this long [m]."""

TIP_DISTANCE = 6e-3
"""What cracks farther than this from the flaw's ends [m] is the platens' doing."""

MIDDLE = 0.3
"""A crack began in the middle of the flaw if its place along the flaw is less than this fraction of half its length."""

JITTERED = {"bodies.0.seeding": Jittered(), "transfer": PicFlip()}
"""Both scenes of the paper, on a grid along their specimens."""

LAST = 0.2
"""The load at onset is read from a line through this last fraction of the loading before it."""


def flawed_scene(*, specimen: str, angle: float, dx: float, paper: bool) -> Scene:
    """The slit cube or disc with the lab's rock, or as the paper has it, both with flaws WIDTH wide.

    angle [degrees]: of the flaw from the platens in the cube, from the line of the load in the disc.
    """
    common = {"dx": dx, "flaw_width": WIDTH, "time_scale": 16.0, "strain_end": STRAIN_END[specimen]}
    if specimen == "cube":
        if not paper:
            return load_scene("cube_lab", flaw_angle=angle, **common)
        return load_scene("cube", flaw_angle=angle, turn=0.0, settings=JITTERED, **common)
    scene = load_scene("disc", flaw_angle=90.0 - angle, settings=JITTERED, **common)
    if paper:
        return scene
    region = scene.bodies[0].region
    region = replace(region, removed=tuple(replace(slit, rounded=True) for slit in region.removed))
    body = replace(scene.bodies[0], region=region, seeding=Jittered(seed=1, fitted=True))
    return replace(scene, bodies=(body,), rock=load_scene("cube_lab", dx=dx).rock)


def near_flaw(slit: Slit, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Which of positions x [n, 2] lie near a flaw, bool [n]; and those, along and across it [k, 2] [m]."""
    local = slit.frame(x)
    near = np.linalg.norm(local, axis=1) < 0.5 * slit.length + TIP_DISTANCE
    return near, local[near]


def crack(*, specimen: str, angle: float, dx: float, paper: bool) -> dict:
    """Load until both wings are GROWN long, or to the end.

    Places are along and across the flaw from its middle [m]: `begun`, of what had begun to lose strength in tension
    when that was first seen, at `onset` [s]; `x`, of what failed in tension near the flaw, in order of time. `normal`:
    angle of the normal of each crack of `begun` from the flaw's plane [rad], NaN by the paper's rule, which has none.
    `time` [s], `stress` [Pa]: the load so far; `spacing`, `half`: of particles, half the flaw's length [m].
    """
    scene = flawed_scene(specimen=specimen, angle=angle, dx=dx, paper=paper)
    (slit,) = slits_of(scene.bodies[0].region)
    drive = Drive(scene, scene.particles(), ti.lang.impl.get_runtime().default_fp)
    history = History(drive.sim, drive.clock, drive.survey)
    spacing = dx / scene.bodies[0].seeding.particles_per_axis
    begun, x, normal, onset, stopped = np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), np.nan, ""
    for look in range(1, LOOKS + 1):
        try:
            drive.advance(max(0, round(drive.clock.total * look / LOOKS) - drive.clock.step))
        except UnstableRun as error:
            stopped = str(error)
            break
        history.record(drive.survey)
        if len(begun) == 0:
            positions, normals = lost_in_tension(drive)
            near, begun = near_flaw(slit, positions)
            if len(begun):
                onset, normal = drive.clock.time, normals[near] - np.radians(slit.angle)
        elif drive.sim.events.count[None]:
            events = read_events(drive.sim)
            x = near_flaw(slit, events.x[events.mode == TENSION].astype(float))[1]
            if all(wing.length >= GROWN for wing in wings(begun, x, spacing, 0.5 * slit.length)):
                break
    time, stress, _ = loading_curve(history.table())
    return {
        "time": time,
        "stress": stress,
        "onset": np.array(onset),
        "begun": begun,
        "normal": normal,
        "x": x,
        "spacing": np.array(spacing),
        "half": np.array(0.5 * slit.length),
        "steps": np.array(drive.clock.step),
        "particles": np.array(drive.sim.particles.count),
        "stopped": np.array(stopped),
    }


def lost_in_tension(drive: Drive) -> tuple[np.ndarray, np.ndarray]:
    """Positions [k, 2] [m] of particles that have begun to lose strength in tension, and their normals [k] [rad]."""
    particles = drive.sim.particles
    lost = particles.mode.to_numpy() == TENSION
    if not lost.any():
        return np.zeros((0, 2)), np.zeros(0)
    position = (particles.reference.to_numpy() + particles.u.to_numpy())[lost].astype(float)
    normal = np.full(len(position), np.nan)
    if particles.history.has_normal:
        across, up = particles.history.crack_normal.to_numpy()[lost].astype(float).T
        normal = np.arctan2(up, across)
    return position, normal


@dataclass(frozen=True)
class WingStart:
    """One of the two cracks of a flaw: its length so far [m], and the angle from the flaw's plane at which it left,
    over the first `wings.FIT_LENGTH` [degrees]; 0 and NaN where nothing has failed."""

    length: float
    angle: float


def position_along(begun: np.ndarray, half: float) -> float:
    """Mean distance from the flaw's middle, along it, over half its length [m], of places begun [k, 2] [m]."""
    return float(np.abs(begun[:, 0]).mean() / half)


def wings(begun: np.ndarray, x: np.ndarray, spacing: float, half: float) -> tuple[WingStart, WingStart]:
    """The crack on the side of the flaw where it began, and that on the other, a half turn away.

    A crack is what is connected to the first failure on its side: of a flaw cracked in its middle the sides are those
    of its faces, else of its ends. The flaw's plane is taken outwards, from its middle to the end on that side. Lengths
    in metres: positions [k, 2] and [e, 2] as in `crack`, particle spacing, half the flaw's length.
    """
    across = position_along(begun, half) < MIDDLE
    side = np.array([0.0, 1.0]) if across else begun[0] / np.linalg.norm(begun[0])
    return tuple(_wing(x[sign * (x @ side) > 0.0], sign * side, spacing) for sign in (1.0, -1.0))


def _wing(x: np.ndarray, side: np.ndarray, spacing: float) -> WingStart:
    if len(x) == 0:
        return WingStart(0.0, float("nan"))
    labels = bands_of(neighbour_graph(x, REACH * spacing))
    x = x[labels == labels[0]]
    outward = np.array([1.0 if side[0] >= 0.0 else -1.0, 0.0])
    return WingStart(float(np.linalg.norm(x - x[0], axis=1).max()), leaving_angle(x, x[0], outward))


@dataclass(frozen=True)
class Beginning:
    """How a flaw cracked: nominal stress at onset [Pa], place along the flaw over half its length, angle from its plane
    of the first cracks [degrees], and of the path over its first 3 mm, mean of the wings that are GROWN; NaN where it
    did not crack or grow, or where cracks have no angle."""

    stress: float
    along: float
    first: float
    path: float


def read_beginning(result: dict) -> Beginning:
    """The result of `crack` in four numbers."""
    begun, half = result["begun"], float(result["half"])
    if len(begun) == 0:
        return Beginning(*4 * [float("nan")])
    time, onset = result["time"], float(result["onset"])
    last = (time > (1.0 - LAST) * onset) & (time <= onset)
    stress = float(np.polyval(np.polyfit(time[last], result["stress"][last], 1), onset))
    first = float(crack_directions(begun, result["normal"], half - 0.5 * WIDTH).mean())
    pair = wings(begun, result["x"], float(result["spacing"]), half)
    angles = [wing.angle for wing in pair if wing.length >= GROWN]
    return Beginning(stress, position_along(begun, half), first, float(np.mean(angles or [np.nan])))
