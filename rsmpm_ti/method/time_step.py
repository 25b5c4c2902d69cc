"""The time step: what a scene may take, and how it follows wave and particle speeds in a run."""

import math

import numpy as np

from rsmpm_ti.errors import SceneError, refuse

PAPER_DT = 1.91e-5
"""The time step the paper prints [s]; a hundred times what its grid allows (paper sec. 4.1)."""

USL_CFL = 0.55
"""Smallest stability limit of usl over offsets and shape functions other than linear, in units of dx/c_p: 0.56 is found
for Gimp (docs/stability.md)."""

MIN_CFL = 1e-6
"""Smallest step over the time a wave needs for one cell: below it a run never ends and adds up round-off."""

MAX_COUNT = 2_000_000_000
"""Most particles, grid nodes and steps: 32-bit numbers count them, and no machine here would hold or finish more."""


def adapted(dt: float, wave_speed: float, J: float, speed: float) -> float:
    """A step [s] for rock that moves, of the one that fits rock at rest: cfl dx/(c + |v|), never longer than dt.

    dt = cfl dx/c_p; J: largest volume ratio of intact rock; speed: largest of a particle [m/s]. Moduli are constant and
    the density is rho/J, so waves run at c = c_p sqrt(J). Failed rock, which only resists compression, is slower. The
    sum is the speed of a wave through the cells that material carries along (Courant, Friedrichs & Lewy 1928).
    """
    return dt / max(1.0, math.sqrt(J) + speed / wave_speed)


def stable_cfl(scene) -> float:
    """Largest stable step of shape function, transfer and order, in units of dx/c_p."""
    limit = scene.shape.affine_cfl if scene.transfer.affine else scene.shape.stable_cfl
    return min(limit, USL_CFL) if scene.order == "usl" else limit


HELD_STRAIN = 0.1
"""What a platen that a force moves may squeeze a specimen by, so that steps suit the grid that goes with it."""


MEETING, LOOKS = 0.9, 2001
"""What platens may come closer by, over their distance, and times at which their way is looked at."""


def smallest_spacing(scene) -> float:
    """Of nodes in a run [m]: the grid goes with the platens, and shrinks as they come closer."""
    loading = scene.loading
    if any(boundary.held for boundary in loading.boundaries):
        return (1.0 - HELD_STRAIN) * scene.domain.dx
    if loading.platens is None or loading.height <= 0.0 or loading.strain_rate == 0.0:
        return scene.domain.dx
    closer = scene.schedule.strain_end if scene.schedule.strain_end is not None else _closest(scene)
    return scene.domain.dx * (1.0 - max(0.0, closer))


def _closest(scene) -> float:
    """How far the platens come closer at most, over their distance, by their speeds and the start's factors.

    Raises SceneError where they meet.
    """
    loading = scene.loading
    times = np.linspace(0.0, scene.t_end, LOOKS)
    factors = np.array([loading.start.factor(time) for time in times])
    strain = loading.strain_rate * np.cumsum(0.5 * (factors[1:] + factors[:-1]) * np.diff(times))
    if strain.max() > MEETING:
        meet = times[1:][np.argmax(strain > MEETING)]
        allowed = (
            f"less than {meet:.4g} s: there the platens have come closer by {100.0 * MEETING:g} % of their distance"
        )
        raise refuse("schedule.t_end", scene.t_end, allowed, "slow them down, or let loading.start = Program hold them")
    return max(0.0, float(strain.max()))


def check_step(scene) -> None:
    """Raises SceneError unless the steps of a `Scene` are stable and can be counted."""
    schedule = scene.schedule
    limit = stable_cfl(scene) * smallest_spacing(scene) / scene.wave_speed
    transit = scene.domain.dx / scene.wave_speed
    true_transit = scene.domain.dx / max(
        rock.wave_speed() for rock in scene.rocks
    )  # without mass scaling: what the paper's digits are
    if MIN_CFL * transit <= scene.dt <= limit:
        name = "t_end" if schedule.strain_end is None else "strain_end"
        count = scene.t_end / scene.dt
        if not 1.0 - 1e-9 <= count <= MAX_COUNT:
            allowed = f"from 1 to {MAX_COUNT:.3g} steps of {scene.dt:.4g} s, not {count:.3g}"
            causes = "cfl, dx, density, E, nu and time_scale"
            if name == "strain_end":
                causes += ", and the end from the platens' speed, position and start.time"
            raise refuse(f"schedule.{name}", getattr(schedule, name), allowed, f"a step follows from {causes}")
        return
    if schedule.dt is not None and math.isclose(schedule.dt, PAPER_DT, rel_tol=0.01):
        raise SceneError(
            f"schedule.dt = {schedule.dt:g} s is refused: the paper prints this value, but it is "
            f"{schedule.dt / true_transit:.0f} times dx/c_p = {true_transit:.5g} s, the time a P-wave needs "
            f"for one cell; its digits are those of dx/c_p, so its exponent or unit is wrong; leave dt out or use "
            f"at most {limit:.4g} s"
        )
    given = "schedule.dt" if schedule.dt is not None else "schedule.cfl"
    raise refuse(
        given,
        schedule.dt if schedule.dt is not None else schedule.cfl,
        f"such that dt = {scene.dt:.4g} is in [{MIN_CFL * transit:.4g}, {limit:.4g}] s (dx/c_p = {transit:.4g} s)",
        f"use cfl <= {limit / transit:.2f} with shape = {type(scene.shape).__name__}, transfer = "
        f"{type(scene.transfer).__name__} and order = {scene.order}",
    )
