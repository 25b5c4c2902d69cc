"""What a run hands out."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.rows import Rows
from rsmpm_ti.records.snapshot import Snapshot


@dataclass(frozen=True)
class Result:
    """What a run leaves behind.

    `history`: structured array with the columns of history.csv; `summary`: the dict of summary.json; `events`:
    EventTable; `fracture`: cracks, fragments and acoustic events measured on them; `snapshot`: last state; `reactions`:
    structured array with the columns of reactions.csv, None where the scene has no boundaries.
    `out`: the run's folder, None where nothing was written; `frames`: structured array with the columns of frames.csv,
    None without frames; `run`: by which the folder's manifest.txt identifies the run.
    `stopped`: "" when the run reached the end of its schedule, else why it did not: by a rule of its own, because the
    specimen had burst, or by a signal, whose number is `signal`.
    Of a run that was read back (`load_result`) there is no `fracture` and no `snapshot`: None.
    The three tables and `events` have `to_frame()`, for pandas.
    """

    history: Rows
    summary: dict
    events: EventTable
    fracture: Any
    snapshot: Snapshot
    out: Path | None
    stopped: str = ""
    signal: int = 0
    reactions: Rows | None = None
    frames: Rows | None = None
    run: str = ""

    def __repr__(self) -> str:
        """In a line: the arrays of a run would fill a terminal."""
        end = self.stopped or "to its end"
        return f"Result({len(self.history)} rows, {len(self.events)} failures, {end}, out={str(self.out)!r})"

    def _repr_html_(self) -> str:
        from rsmpm_ti.results.short_table import short_table

        return short_table(self.summary, len(self.history), self.stopped, str(self.out or ""))

    def plot(self):
        """The load over the strain, failures and acoustic events, as a matplotlib.figure.Figure of 900 x 600 pixels.

        It marks the first failure and the peak. Where no strain was recorded all is over time. Its axes are
        `figure.axes`, for what is to be added; `figure.savefig(path)` writes it.
        """
        from rsmpm_ti.results.curve import NONE, curve_figure

        acoustic = NONE if self.fracture is None else self.fracture.acoustic.time
        return curve_figure(self.history, self.events, acoustic)

    def frame(self, at: str | float = "peak", kind: str = "cracks"):
        """The frame of the run that is nearest to an instant, a PIL.Image.Image, RGB; `info` holds its row of `frames`.

        at: "start", "first failure", "peak", "end", or an axial strain [1]; kind: "cracks", "stress", or "margin".
        Raises SceneError where the run has no such instant or frame, was not written, or its folder is another's now.
        """
        from rsmpm_ti.results.moments import time_of
        from rsmpm_ti.results.painted import frame_nearest
        from rsmpm_ti.results.stored import stored

        time = time_of(at, self.history, self.events)
        return frame_nearest(stored(self.out, self.run), self.frames, time, kind)

    def movie(self):
        """The movie of the run, which a notebook shows; `path` is its file. Raises SceneError where there is none."""
        from rsmpm_ti.results.movie import Movie
        from rsmpm_ti.results.stored import stored

        return Movie(stored(self.out, self.run))
