"""When each frame of a run was painted, and the load then: frames.csv."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.records.rows import Rows
from rsmpm_ti.records.tables import Column, Table


@dataclass(frozen=True)
class FrameTimes:
    """time: of each frame [s], ascending, [k]; history: of the run up to its end."""

    time: np.ndarray
    history: np.ndarray

    def then(self, values: np.ndarray) -> np.ndarray:
        """Of values by row of the history those of each frame's own row; NaN where it has none, as at the start."""
        row = np.searchsorted(self.history["time_s"], self.time)
        known = row < len(self.history)
        known[known] = self.history["time_s"][row[known]] == self.time[known]
        found = np.full(len(self.time), np.nan)
        found[known] = values[row[known]]
        return found

    def table(self) -> Rows:
        """A row for each frame, a float64 field for each column of the file."""
        found = FRAMES.filled(self, 2)
        table = np.empty(len(self.time), dtype=[(name, np.float64) for name in found])
        for name, entries in found.items():
            table[name] = entries
        return table.view(Rows)


FRAMES = Table(
    file="frames.csv",
    about=(
        "The instants of the frames, one row per number; no file where none were asked for. `Result.frames` is the "
        "same as a structured NumPy array. Of a run that went on, pictures that were lost before have their rows too."
    ),
    columns=(
        Column(
            name="frame", unit="1", about="number in the names of its pictures",
            value=lambda frames: np.arange(len(frames.time)),
        ),
        Column(name="time_s", unit="s", about="time of the run, that of the platens", value=lambda frames: frames.time),
        Column(
            name="axial_strain", unit="1", about="nominal strain then, compression positive",
            value=lambda frames: frames.then(frames.history["axial_strain"]),
        ),
        Column(
            name="nominal_stress_Pa", unit="Pa", about="mean of both sides of the load cell since the history row "
            "before, confining pressure included; compression positive",
            value=lambda frames: frames.then(nominal_stress(frames.history)),
        ),
    ),
)  # fmt: skip
