"""The history of a run: rows of named columns, and the guard that stops a run which makes energy."""

from dataclasses import asdict

import numpy as np

from rsmpm_ti.errors import ObserverError
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.records.history_table import HISTORY
from rsmpm_ti.records.tables import Column
from rsmpm_ti.solver.extensometer import Extensometer
from rsmpm_ti.solver.gauges import gauge_columns
from rsmpm_ti.solver.guard import EnergyBooks, guard_energy, quiet_energy
from rsmpm_ti.solver.reactions import ReactionRows
from rsmpm_ti.solver.survey import Survey
from rsmpm_ti.solver.view import View
from rsmpm_ti.spec.load_cell import NO_LOAD


class History:
    """The rows of history.csv: an observer of every row. Forces are means over the steps since the row before."""

    every = 0.0

    def __init__(self, sim: Simulation, clock: Clock, start: Survey, columns: tuple[Column, ...] = ()):
        """start: a survey of the particles as they are; columns: more of them, of whoever asks for them."""
        self._sim, self._clock = sim, clock
        self.columns = (*HISTORY.columns, *gauge_columns(sim), *columns)
        self._asked_for = columns
        self._rows: list[tuple[float, ...]] = []
        self._table = None
        self.books = EnergyBooks(start=start.kinetic + start.elastic, quiet=quiet_energy(sim)).after(start)
        self._impulse, self._time = start.impulse, clock.time
        self._cell, self.extensometer = sim.scene.loading.load_cell, Extensometer(sim)
        self.load, self.reactions = NO_LOAD, ReactionRows(sim)
        self._zero = np.zeros(len(self.columns))  # readings of instruments when the clock started

    def zero(self, view: View) -> None:
        """What is measured on the specimen counts from here: after bodies have settled."""
        gauges = [gauge.column for gauge in self._sim.scene.loading.cell.gauges]
        counted = {"lateral_strain", "volumetric_strain", *gauges}
        self._zero = np.array([column.value(view) if column.name in counted else 0.0 for column in self.columns])

    @property
    def energy_start(self) -> float:
        """Kinetic and elastic energy with which the run started [J]."""
        return self.books.start

    @property
    def failed(self) -> float:
        """Failures up to the latest row."""
        if not self._rows:
            return 0.0
        latest = dict(zip((column.name for column in self.columns), self._rows[-1], strict=True))
        return latest["failed_tension"] + latest["failed_shear"]

    def record(self, survey: Survey) -> None:
        """Add a row of the particles as they are, of which this is a survey; raises as `see`."""
        self.see(View(self._sim, self._clock, survey, self))

    def see(self, view: View) -> None:
        """Add a row.

        Raises UnstableRun, the row included, if the run has made energy out of nothing, and ObserverError, without the
        row, if a column that was asked for fails.
        """
        survey = view.survey
        went = view.time - self._time
        forces = (survey.impulse - self._impulse) / (went if went > 0.0 else np.nan)
        if self._cell is not None and went > 0.0:
            self.load = self._cell.read(forces, self._sim.scene.loading.confinement)
        else:
            self.load = NO_LOAD
        zeros = zip(self.columns, self._zero, strict=True)
        self._rows.append(tuple(self._value(column, view) - float(zero) for column, zero in zeros))
        self.reactions.see(view.time, forces)
        self._impulse, self._time = survey.impulse, view.time
        self.books = self.books.after(survey)
        guard_energy(self._sim, self._clock, survey, self.books)

    def _value(self, column: Column, view: View) -> float:
        try:
            return float(column.value(view))
        except Exception as error:
            if column not in self._asked_for:
                raise
            said = f"{type(error).__name__}: {error}"
            raise ObserverError(f"history column {column.name} failed: {said}") from error

    def table(self) -> np.ndarray:
        """Structured array of the rows so far, a float64 field for each column."""
        if self._table is None or len(self._table) != len(self._rows):
            self._table = np.array(self._rows, dtype=[(column.name, np.float64) for column in self.columns])
        return self._table

    def state(self) -> dict[str, np.ndarray]:
        """The rows, and what the next one is counted from: the books of energy [J], impulses [N s] and time [s]."""
        return {
            "history": np.array(self._rows, dtype=float).reshape(-1, len(self.columns)),
            **{f"history_energy_{name}": np.array(value) for name, value in asdict(self.books).items()},
            "history_impulse": np.array(self._impulse),
            "history_time": np.array(self._time),
            "history_zero": self._zero,
            **self.reactions.state(),
        }

    def resume(self, state: dict[str, np.ndarray]) -> None:
        self._rows, self._table = [tuple(row) for row in state["history"].tolist()], None
        self.books = EnergyBooks(**{name: float(state[f"history_energy_{name}"]) for name in asdict(self.books)})
        self._impulse, self._time = state["history_impulse"], float(state["history_time"])
        self._zero = state["history_zero"]
        self.reactions.resume(state)
