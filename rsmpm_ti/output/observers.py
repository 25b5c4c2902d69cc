"""The observers that have pictures and particle files made of a run: they say when, the writer's process does it."""

import math

from rsmpm_ti.output.files import frame_name, number_of, vtu_name
from rsmpm_ti.output.manifest import FRAMES
from rsmpm_ti.output.writer import Writer
from rsmpm_ti.records.snapshot import INSTANT, Pattern
from rsmpm_ti.solver.observer import Observer
from rsmpm_ti.solver.view import View

JUMP_FRACTION, JUMP_GROWTH = 0.0003, 0.05
"""A frame is added when failures since the last one exceed these fractions of all particles and of all so far."""


class Frames(Observer):
    """Pictures at equal intervals of the run, and more of them when failed particles jump."""

    every = 0.0  # it looks at every row for jumps

    def __init__(self, writer: Writer, frames: int, particle_count: int):
        """frames: how many at equal intervals, beside that of the start; jumps at most double that."""
        self._writer, self._frames = writer, frames
        self._jump = max(1.0, JUMP_FRACTION * particle_count)
        self._used, self._next = 0, 0  # frames added at jumps; the next one that is due
        self._failed = 0.0
        self.times: list[float] = []  # of the frames, by number [s]

    def see(self, view: View) -> None:
        if self._due(view.fraction, float(view.survey.failed_tension + view.survey.failed_shear)):
            self._writer.frame(len(self.times), view.readout, view.history)
            self.times.append(view.time)

    def _due(self, fraction: float, failed: float) -> bool:
        """failed: particles failed so far."""
        if self._frames == 0:
            return False
        due = fraction >= self._next / self._frames - 1e-9
        if due:
            self._next = math.floor(fraction * self._frames + 1e-9) + 1
        elif self._used < self._frames and failed - self._failed >= max(self._jump, JUMP_GROWTH * self._failed):
            self._used += 1
            due = True
        if due:
            self._failed = failed
        return due

    def state(self) -> dict:
        return {"next": self._next, "used": self._used, "failed": self._failed, "times": self.times}

    def resume(self, state: dict) -> None:
        self._next, self._used = state["next"], state["used"]
        self._failed, self.times = state["failed"], [float(time) for time in state["times"]]

    def go_on(self, view: View) -> list[str]:
        """Remove what a run that was killed had painted after its checkpoint, film what is there before it, paint a
        last frame again that is of the checkpoint's own state. Returns the names of what is lost."""
        folder, count = self._writer.folder, len(self.times)
        there = [name for name in folder.names if name.startswith(f"{FRAMES}/")]
        folder.remove([name for name in there if number_of(name) >= count])
        filmed = {frame_name(kind, number): number for number in range(count) for kind in ("stress", "cracks")}
        lost = folder.lost(sorted({*filmed, *(name for name in there if number_of(name) < count)}))
        last = count - 1
        again = self.times[-1:] == [view.time] and any(number_of(name) == last for name in lost)
        gaps = {filmed.get(name) for name in lost} | ({last} if again else set())
        self._writer.refilm([number for number in range(count) if number not in gaps])
        if again:
            self._writer.frame(last, view.readout, view.history)
        return [name for name in lost if not (again and number_of(name) == last)]

    def realign(self, fraction: float) -> None:
        self._next = math.floor(fraction * self._frames + 1e-9) + 1 if self.times else 0

    def catch_up(self, view: View) -> None:
        """The first picture of a run that was done without any."""
        if not self.times:
            self.see(view)


class LargestLoad(Observer):
    """Keeps the crack pattern at the history row of the largest load, for summary.png; None while nothing has cracked.

    A collapse leaves rubble: the pattern that a test is known by is the one at its peak.
    """

    every = 0.0  # it looks at every row

    def __init__(self):
        self.pattern: Pattern | None = None
        self._largest = 0.0

    def see(self, view: View) -> None:
        load = abs(view.load.stress)
        if load > self._largest:  # not so of NaN
            self._largest, self.pattern = load, view.pattern if view.begun else None

    def state(self) -> dict:
        return {"largest": self._largest, **({} if self.pattern is None else vars(self.pattern))}

    def resume(self, state: dict) -> None:
        self._largest = state["largest"]
        kept = {name: value for name, value in state.items() if name != "largest"}
        self.pattern = Pattern(**kept) if kept else None


class ParticleFiles(Observer):
    """A VTU file of all particles at equal intervals of the run."""

    def __init__(self, writer: Writer, files: int):
        """files: how many, beside that of the start; 0 for none at all."""
        self._writer, self._files, self.every = writer, files, 1.0 / max(files, 1)
        self._entries: list[tuple[float, str]] = []
        self._lost: set[str] = set()

    def see(self, view: View) -> None:
        if self._files == 0:
            return
        self._entries.append((view.time, vtu_name(len(self._entries))))
        self._write(view)

    def _write(self, view: View) -> None:
        instant = {column.name: float(column.value(view)) for column in INSTANT.columns if column.value is not None}
        self._writer.vtu(self._there(), view.readout, instant)

    def _there(self) -> list[tuple[float, str]]:
        return [entry for entry in self._entries if entry[1] not in self._lost]

    def state(self) -> dict:
        return {"entries": self._entries}

    def resume(self, state: dict) -> None:
        self._entries = [tuple(entry) for entry in state["entries"]]

    def go_on(self, view: View) -> list[str]:
        """As `Frames.go_on`; particles.pvd is written again without what is lost."""
        folder = self._writer.folder
        there = [name for name in folder.names if name.endswith(".vtu")]
        folder.remove([name for name in there if number_of(name) >= len(self._entries)])
        self._lost = set(folder.lost([name for _, name in self._entries]))
        if self._entries and self._entries[-1][1] in self._lost and self._entries[-1][0] == view.time:
            self._lost.remove(self._entries[-1][1])
            self._write(view)
        elif self._entries:
            self._writer.collect(self._there())
        return sorted(self._lost)

    def catch_up(self, view: View) -> None:
        """The first file of a run that was done without any."""
        if not self._entries:
            self.see(view)
