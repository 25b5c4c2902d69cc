"""What a run hands out: what it leaves behind, and what a progress bar shows meanwhile."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import Snapshot


@dataclass(frozen=True)
class Result:
    """What a run leaves behind.

    `history`: structured array with the columns of history.csv; `summary`: the dict of summary.json; `events`:
    EventTable; `fracture`: cracks, fragments and acoustic events measured on them; `snapshot`: last state; `reactions`:
    structured array with the columns of reactions.csv, None where the scene has no boundaries.
    `stopped`: "" when the run reached the end of its schedule, else why it did not: by a rule of its own, because the
    specimen had burst, or by a signal, whose number is `signal`.
    """

    history: np.ndarray
    summary: dict
    events: EventTable
    fracture: object
    snapshot: Snapshot
    out: Path | None
    stopped: str = ""
    signal: int = 0
    reactions: np.ndarray | None = None

    def __repr__(self) -> str:
        """In a line: the arrays of a run would fill a terminal."""
        end = self.stopped or "to its end"
        return f"Result({len(self.history)} rows, {len(self.events)} failures, {end}, out={str(self.out)!r})"


@dataclass(frozen=True)
class Progress:
    """What a progress bar shows."""

    fraction: float
    time: float
    strain: float
    stress: float
    failed_tension: int
    failed_shear: int
    particle_steps_per_s: float
