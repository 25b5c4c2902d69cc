"""What is seen of a run while it goes: history rows, failure events, and the guard that stops it."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.measure import Survey
from rsmpm_ti.snapshot import HISTORY_COLUMNS
from rsmpm_ti.state import Simulation
from rsmpm_ti.stepper import Clock

J_BOUNDS = (0.05, 20.0)
"""A particle squeezed or stretched beyond these is no longer rock; the run has become unstable."""

CREATED_SHARE = 0.5
"""Share of a run's energy that may have come from nowhere: beyond it the run has become unstable.

Runs of rock create up to 0.5 % (docs/stability.md). Velocity and stress are half a step apart, so that the energy of a
wave beats by sin(w dt/2): 0.3 for one of ten cells at CFL 1. In an unstable run the share tends to 1, since its energy
grows exponentially, whatever was put into it.
"""

QUIET_STRAIN = 1e-6
"""Below the energy of so much strain throughout, a hundredth of what breaks rock, round-off may make energy."""


@dataclass(frozen=True)
class EventTable:
    """Failure events in the order of time. Shapes [e], x [e, dim]; SI; mode 1 tension, 2 shear.

    crack_angle: of the normal of the particle's crack, from +x [rad]; None for rock without a direction.
    """

    time: np.ndarray
    x: np.ndarray
    mode: np.ndarray
    sigma_1: np.ndarray
    sigma_3: np.ndarray
    released: np.ndarray
    id: np.ndarray
    crack_angle: np.ndarray | None = None
    onset: float = np.inf
    """When a particle of rock with a direction first began to lose strength [s]: not after the first event."""

    def __len__(self) -> int:
        return len(self.time)


def read_events(sim: Simulation) -> EventTable:
    """All events so far, sorted by time, then particle id, so that threads do not show."""
    names = ["time", "x", "mode", "sigma_1", "sigma_3", "released", "id"]
    if sim.events.directional:
        names.append("crack_angle")
    n = sim.events.count[None]
    columns = {name: getattr(sim.events, name).to_numpy()[:n] for name in names}
    order = np.lexsort((columns["id"], columns["time"]))
    columns = {name: column[order] for name, column in columns.items()}
    return EventTable(**columns, onset=float(sim.events.onset[None]))


class History:
    """The rows of history.csv. Platen stress is the mean over the steps since the row before.

    It is the mean axial stress of a section of the loaded width: platen force over width, and the confining pressure,
    which the platens do not read (see `confinement.py`) and which the rest of such a section's end feels too.
    """

    def __init__(self, sim: Simulation, clock: Clock, start: Survey):
        self._sim, self._clock = sim, clock
        self.rows: list[tuple[float, ...]] = []
        self._energy_start = start.kinetic + start.elastic
        self._quiet = _quiet_energy(sim)
        self._impulse = start.impulse
        self._time = clock.time
        loading = sim.scene.loading
        self._platens = None
        if loading.platens is not None and loading.width is not None:
            self._platens = tuple(loading.boundaries.index(platen) for platen in loading.platens)

    @property
    def baseline(self) -> dict[str, np.ndarray]:
        """What the next row is counted from: energy of the start [J], impulses [N s] and time [s] of the last row."""
        return {"energy_start": self._energy_start, "impulse": self._impulse, "time": self._time}

    @baseline.setter
    def baseline(self, kept: dict[str, np.ndarray]) -> None:
        self._energy_start, self._time = float(kept["energy_start"]), float(kept["time"])
        self._impulse = kept["impulse"]

    @property
    def energy_start(self) -> float:
        """Kinetic and elastic energy with which the run started [J]."""
        return self._energy_start

    def record(self, survey: Survey) -> None:
        """Add a row. Raises UnstableRun, the row included, if the run has made energy out of nothing."""
        clock, loading = self._clock, self._sim.scene.loading
        bottom = top = np.nan
        if self._platens is not None and clock.time > self._time:
            axis = loading.platens[0].axis
            force = (survey.impulse - self._impulse)[:, axis] / (clock.time - self._time) / loading.width
            # the lower plate pushes the specimen along +axis in compression, the upper one along -axis
            bottom = loading.confinement + force[self._platens[0]]
            top = loading.confinement - force[self._platens[1]]
        self.rows.append(
            (
                clock.time, clock.strain, top, bottom, survey.kinetic, survey.elastic, survey.dissipated, survey.work,
                float(survey.failed_tension), float(survey.failed_shear), clock.dt,
            )
        )  # fmt: skip
        self._impulse, self._time = survey.impulse, clock.time
        guard_energy(self._sim, clock, survey, self._energy_start, self._quiet)

    def table(self) -> np.ndarray:
        """Structured array with the fields HISTORY_COLUMNS."""
        return np.array(self.rows, dtype=[(name, np.float64) for name in HISTORY_COLUMNS])

    @property
    def failed(self) -> float:
        return self.rows[-1][8] + self.rows[-1][9] if self.rows else 0.0


def guard(sim: Simulation, clock: Clock, survey: Survey) -> None:
    """Stop a run whose numbers mean nothing any more, with step, place, likely cause and remedy."""
    where = ""
    if survey.sick:
        reference = sim.particles.reference.to_numpy()[np.flatnonzero(sim.particles.id.to_numpy() == survey.sick_id)[0]]
        where = f" (one started at {np.array2string(1e3 * reference, precision=3)} mm)"
    at = f"at step {clock.step}, t = {clock.time:.6g} s"
    if survey.sick:
        raise UnstableRun(
            f"{survey.sick} particles are not finite or left the domain {at}{where}; likely cause: a time step too "
            f"long for this loading, or fragments flying off; lower schedule.cfl, enlarge the domain, or take "
            f"domain.outside = drop or grow"
        )
    if survey.J_min < J_BOUNDS[0] or survey.J_max > J_BOUNDS[1]:
        raise UnstableRun(
            f"a particle has J = {survey.J_min:.3g} .. {survey.J_max:.3g} {at}, outside {J_BOUNDS}; likely cause: "
            f"an unstable step or a collapse beyond the law; lower schedule.cfl or end the run earlier"
        )


def _quiet_energy(sim: Simulation) -> float:
    """What round-off may make [J]."""
    volume = sim.particles.volume.to_numpy().sum(dtype=np.float64)
    return float(0.5 * sim.density * sim.wave_speed**2 * QUIET_STRAIN**2 * volume)


def guard_energy(sim: Simulation, clock: Clock, survey: Survey, energy_start: float, quiet: float) -> None:
    """Stop a run that makes energy: kinetic + elastic + dissipated exceed what it started with and the work since.

    It is for a history, not for `guard`, which also sees states that were changed by hand on the way. quiet: [J].
    """
    present = survey.kinetic + survey.elastic + survey.dissipated
    created = present - survey.work - energy_start
    if not created <= CREATED_SHARE * present + quiet:
        velocity, place = sim.particles.v.to_numpy(), sim.particles.reference.to_numpy() + sim.particles.u.to_numpy()
        fastest = int(np.argmax(np.linalg.norm(velocity, axis=1)))
        raise UnstableRun(
            f"{100.0 * created / present:.0f} % of the energy of {present:.3g} J came from nowhere at step "
            f"{clock.step}, t = {clock.time:.6g} s; the fastest particle, {survey.speed:.3g} m/s, is at "
            f"{np.array2string(1e3 * place[fastest], precision=3)} mm; likely cause: a time step too long for this "
            f"shape function and transfer, or particles that cross cells with linear functions; lower schedule.cfl, or "
            f"take QuadraticBSpline"
        )
