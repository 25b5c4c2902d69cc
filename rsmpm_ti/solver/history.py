"""What is seen of a run while it goes: history rows, failure events, and the guard that stops it."""

import numpy as np

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.records.snapshot import HISTORY_COLUMNS
from rsmpm_ti.solver.guard import _quiet_energy, guard_energy
from rsmpm_ti.solver.survey import Survey


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
