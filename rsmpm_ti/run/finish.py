"""The end of a run: what cannot be made again is written first, then what broke is measured, painted and summed up.

So a failure, or an impatient user, costs what comes later: pictures and the tables of cracks, which `--resume` makes
again from the last checkpoint.
"""

import time
from pathlib import Path

import numpy as np

from rsmpm_ti.analysis.fracture import Fracture, crack_lines, measure_fracture
from rsmpm_ti.analysis.summary import failures_by_rock, summarise
from rsmpm_ti.errors import ObserverError, SceneError
from rsmpm_ti.output.files import write_checkpoint, write_events, write_rows
from rsmpm_ti.output.folder import SUMMARY
from rsmpm_ti.output.fracture_tables import write_fracture
from rsmpm_ti.records.files import plain, write_json
from rsmpm_ti.records.frame_table import FrameTimes
from rsmpm_ti.records.rows import Rows
from rsmpm_ti.results.result import Result
from rsmpm_ti.run.attempts import Attempts
from rsmpm_ti.run.damping import damped_energy, damping_said, mixing_energy, stopped_energy, viscous_energy
from rsmpm_ti.run.warnings import kinetic_share_after, walls_moved, warnings_of
from rsmpm_ti.solver.readout import read_rocks
from rsmpm_ti.spec.bodies.rocks import named_rocks


def finish(run, stopped: str, failure: Exception | None) -> tuple[Result, SceneError | None]:
    """Write, measure and sum up a `Run` that has ended, and say what of this failed first.

    stopped: why the run ended before its end; failure: by which exception.
    """
    end = End(run, stopped, failure)
    if run.folder is not None:
        end.write_tables()
    fracture = end.attempt(measure_fracture, *end.broken, what="what broke cannot be measured")
    if run.folder is not None:
        end.write_rest(fracture)
    well = run.over and failure is None and end.attempt.problem is None
    summary = end.sum_up(fracture, complete=well and not run.lost)
    if run.folder is not None and summary.get("complete") and end.attempt.problem is None:
        run.folder.complete()
    view, given_up = end.view, run.writer.problem if run.writer is not None and run.interrupt.hurried else ""
    result = Result(
        history=view.history.view(Rows), summary=summary, events=view.events, fracture=fracture, snapshot=view.snapshot,
        out=run.out, stopped=stopped or given_up, frames=end.frames,
        reactions=None if end.reactions is None else end.reactions.view(Rows),
        signal=0 if run.over and not given_up else run.interrupt.signal, run=run.folder.run if run.folder else "",
    )  # fmt: skip
    return result, end.attempt.problem


class End:
    """The last state of a run, and everything that is written of it."""

    def __init__(self, run, stopped: str, failure: Exception | None):
        self.run, self.stopped, self.failure, self.attempt = run, stopped, failure, Attempts()
        self.speed, self.view = run.speed(), run.view()
        self.reactions = run.history.reactions.table()
        self.frames = None
        if run.writer is not None and run.files[0].times:
            self.frames = FrameTimes(np.array(run.files[0].times), self.view.history).table()
        self.broken = run.scene, self.view.history, self.view.events, self.view.snapshot
        self._arrays: dict | None = None

    def write_tables(self) -> None:
        """The run itself: its tables, a checkpoint and its numbers so far."""
        view, attempt, writer = self.view, self.attempt, self.run.writer
        attempt(lambda: write_rows(self._file("history.csv"), view.history))
        if self.reactions is not None:
            attempt(lambda: write_rows(self._file("reactions.csv"), self.reactions))
        if (frames := self.frames) is not None:
            attempt(lambda: write_rows(self._file("frames.csv"), frames))
        attempt(lambda: write_events(self._file("events.csv"), view.events))
        # of a state that is sound: a user's observer and the writer say nothing against it, other failures do
        elsewhere = isinstance(self.failure, ObserverError) or (isinstance(self.failure, SceneError) and writer.problem)
        if self.run.followed and (self.failure is None or elsewhere):
            self._arrays = attempt(self.run.checkpoint_arrays)
        if self._arrays is not None:
            attempt(self._timed, writer.checkpoint, self._arrays)
        self.sum_up(None, complete=False)

    def write_rest(self, fracture: Fracture | None) -> None:
        """What is measured and painted, while the checkpoint is on its way to the disk."""
        if fracture is not None:
            self.attempt(write_fracture, self._file, fracture, self.view.history)
        if not self.run.writer.problem:
            self.attempt(self._paint, fracture, what="summary.png cannot be painted")
        elif self.failure is None:  # it has failed since the last row was looked at
            self.attempt(self.run.writer.check)
        if self.run.writer.problem and self._arrays is not None:  # it may have got no further than to be ordered
            self.attempt(self._keep, self._arrays)
        if not self.run.writer.problem:
            movie = f"{self.run.settings.name}.mp4"
            self.attempt(self.run.folder.verify, [movie] if self.run.writer.warning else [])

    def _file(self, name: str) -> Path:
        """Where a file is to be written, inside of an attempt: a folder that is another now is not written into."""
        return self.run.folder.file(name)

    def _keep(self, arrays: dict) -> None:
        """The checkpoint, by this process."""
        self.run.folder.claim(*self.run.folder.checkpoint_names())
        write_checkpoint(self.run.out, arrays)

    def _paint(self, fracture: Fracture | None) -> None:
        run, view, peak = self.run, self.view, self.run.largest.pattern
        lines = [] if peak is None else crack_lines(run.scene, view.events, peak)
        measured = ([], []) if fracture is None else (fracture.lines, fracture.acoustic.time)
        self._timed(run.writer.close, view.snapshot, view.history, *measured, peak, lines)

    def _timed(self, work, *arguments) -> None:
        start = time.perf_counter()
        try:
            work(*arguments)
        finally:
            self.run.painting_s += time.perf_counter() - start

    def sum_up(self, fracture: Fracture | None, *, complete: bool) -> dict:
        """The numbers of the run, the same in Python as in the file; none where they could not be had."""

        def numbers() -> dict:
            return plain(numbers_of(self.run, self.view, fracture, self.speed, self.stopped, complete))

        found = self.attempt(numbers, what="the run cannot be summed up") or {}
        if found and self.run.folder is not None:
            self.attempt(lambda: write_json(self._file(SUMMARY), found))
        return found


def numbers_of(run, view, fracture: Fracture | None, speed: float, stopped: str, complete: bool) -> dict:
    """summary.json, whose keys `records/summary_table.py` declares. Without a Fracture those of what broke are missing:
    it has not been measured yet, or could not be."""
    writer = run.writer
    what_broke = summarise(run.scene, view.history, view.events, run.history.energy_start)
    if run.sim.several:
        names = [name for name, _ in named_rocks(run.scene)]
        what_broke["by_rock"] = failures_by_rock(names, read_rocks(run.sim), view.events)
    numbers = {
        "particles": run.sim.particles.count,
        "steps": run.clock.step,
        "dt_s": run.clock.dt,
        "wall_s": run.wall(),
        "compile_s": run.started - run.begun,
        "painting_s": run.painting_s,
        "painting_cpu_s": writer.cpu_s if writer is not None else 0.0,
        "particle_steps_per_s": speed,
        "time_scale": run.scene.time_scale,
        "least_pace": run.drive.control.least if run.drive.control is not None else 1.0,
        "local_damping_J": damped_energy(run.sim),
        **what_broke,
        "kinetic_share_after": kinetic_share_after(view.history, what_broke["first_failure_time_s"]),
        **(fracture.numbers() if fracture is not None else {}),
        **run.drive.dropped.numbers(),
        "excavated": run.drive.digging.taken,
        "stopped": stopped,
        "complete": complete,
    }
    beside = [said for said in (writer.warning, writer.problem) if said] if writer is not None else []
    found = warnings_of(run.scene, numbers, view.history, view.events)
    found += walls_moved(run.scene, view.snapshot, run.sim.grid.state()["grid_frame"])
    booked = mixing_energy(run.sim) + stopped_energy(run.sim)
    damped = damping_said(run.scene, view.history, run.history.energy_start, viscous_energy(run.sim), booked)
    return numbers | {"warnings": [*run.said, *found, *damped, *beside]}
