"""A static start: bodies come to rest before the clock starts. Under what, `spec/ground/settling.py` says.

Dynamic relaxation with kinetic damping: bodies move freely, and whenever their kinetic energy has passed a maximum,
where they are near their equilibrium, all velocity is taken from them. Cundall (1976), Explicit finite-difference
methods in geomechanics; Barnes (1999), Int. J. Space Struct. 14:89. No parameter has to fit the specimen.

Loads that come at once overshoot by as much as they are. So bodies come to rest twice: first nothing fails, then rock
that is overloaded at rest does, and what it throws off is borne by the rest.
"""

import math

import numpy as np

from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.fields.records import NEVER
from rsmpm_ti.mpm.rest import bring_to_rest
from rsmpm_ti.run.interrupt import Interrupt
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.survey import survey

REST = 1e-8
"""Bodies are at rest where the maximum of their kinetic energy is below this fraction of the elastic energy. Amplitudes
go by its root: stresses then swing by 1e-4 of their size."""

MOST_TRANSITS = 1000
"""Steps after which bodies that have not come to rest never will, in times that a wave needs along the scene. The
slowest mode of a slender beam, of length over depth 20, swings eight times in that."""

GOLDEN = 0.5 * (math.sqrt(5.0) - 1.0)
"""Fractions of its multiples are never near each other."""

LOOKS, MOST_STEPS = 8, 10
"""Looks at the kinetic energy in a transit, and most steps between two: a maximum is then passed by an eighth of a
radian or so."""


def settle(drive: Drive, interrupt: Interrupt) -> bool:
    """Bring the bodies of a drive that has not begun to rest, and let everything that is counted count from there.

    False where a signal came before. Raises UnstableRun for bodies that do not come to rest.
    """
    sim, clock = drive.sim, drive.clock
    velocity, begun, factor = _by_id(sim, sim.particles.v), clock.state(), clock.factor
    transit = max(1.0, max(_extent(sim.scene)) / (sim.scene.wave_speed * clock.dt))  # [steps]
    clock.total, clock.factor = math.ceil(MOST_TRANSITS * transit), lambda time: factor(0.0)
    sim.grid.pace[None], drive.digging.rests = 0.0, True
    bring_to_rest(sim, clock.dt, factor(0.0))
    _may_break(drive, False)
    rested = _relax(drive, interrupt, transit)
    _may_break(drive, True)
    if rested and sim.particles.breaks:
        clock.total += clock.step
        rested = _relax(drive, interrupt, transit)
    clock.factor = factor
    clock.resume(begun)
    sim.grid.pace[None], drive.digging.rests = 1.0, False
    sim.particles.v.from_numpy(velocity[sim.particles.id.to_numpy()])
    _count_from_here(drive)
    return rested


def _may_break(drive: Drive, may: bool) -> None:
    drive.sim.particles.breaking[None], drive.clock.tracks = int(may), may


def _relax(drive: Drive, interrupt: Interrupt, transit: float) -> bool:
    """Until no maximum of the kinetic energy within a transit is above REST of the elastic energy.

    transit: steps that a wave needs along the bodies. Between two stops there is at least half of it, a quarter of the
    period of the slowest wave between two walls: else the noise of fast modes has maxima at every look, and slow ones
    never come to move. And it is never the same, or a mode of just this period would always be met where it turns.
    """
    before, quiet, free, stops = 0.0, 0, 0, 0
    steps = max(1, min(MOST_STEPS, math.floor(transit / LOOKS)))
    while not interrupt.signal:
        taken = drive.take(max(1, steps - stops % 3))
        quiet, free = quiet + taken, free + taken
        now, stored = drive.survey.kinetic, drive.survey.elastic
        if max(before, now) > REST * stored:
            quiet = 0
        if now <= before and free >= 0.5 * (1.0 + GOLDEN * stops % 1.0) * transit:
            bring_to_rest(drive.sim, drive.clock.dt, drive.clock.factor(0.0))
            if quiet >= transit:
                return True
            now, free, stops = 0.0, 0, stops + 1
        before = now
        if drive.clock.done:
            raise UnstableRun(
                f"bodies did not come to rest in {drive.clock.step} steps of loading.settle: their kinetic energy is "
                f"{now / max(stored, 1e-300):.2g} of the elastic energy, above {REST:g}; likely cause: nothing holds "
                f"them in some direction, or rock that falls apart under what loads it at time 0; add boundaries, or "
                f"set loading.settle = False"
            )
    return False


def _count_from_here(drive: Drive) -> None:
    """Sums over steps, the travel of sides and times of failures start at nothing."""
    sim = drive.sim
    ledger, events = sim.ledger, sim.events
    sim.grid.count_from_here(ledger.impulse.to_numpy())
    for field in (ledger.impulse, ledger.work, ledger.latest, ledger.mean_speed):
        field.fill(0.0)
    ledger.begin(sim.scene)
    for field in (ledger.body_work, ledger.viscous, ledger.released, ledger.damped, ledger.mixed, ledger.stopped):
        field.fill(0.0)
    ledger.body_work[0] = -survey(sim).work  # the confining pressure's, which is a sum over particles
    time = events.time.to_numpy()
    time[: min(events.count[None], events.capacity)] = 0.0
    events.time.from_numpy(time)
    if events.onset[None] < NEVER:
        events.onset[None] = 0.0
    drive.survey = survey(sim)


def _by_id(sim, field) -> np.ndarray:
    """A field of the particles in the order of their ids."""
    entries, ids = field.to_numpy(), sim.particles.id.to_numpy()
    found = np.empty_like(entries)
    found[ids] = entries
    return found


def _extent(scene) -> np.ndarray:
    """Of all bodies together along each axis [m]."""
    lows, highs = zip(*(body.region.bounds() for body in scene.bodies), strict=True)
    return np.max(highs, axis=0) - np.min(lows, axis=0)
