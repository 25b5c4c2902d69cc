"""Run a scene from Python: start Taichi, step, observe, write. The only module that starts Taichi."""

import math
import os
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.errors import SceneError, UnstableRun, refuse
from rsmpm_ti.output.folder import forget, prepare, write_all, write_record
from rsmpm_ti.records.result import Progress, Result
from rsmpm_ti.run.interrupt import asked_to_stop
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.scene_checks import check_precision

CHECKPOINT_S = 60.0
"""Seconds of wall time between checkpoints, unless said otherwise."""


def simulate(
    scene: Scene,
    *,
    out: str | os.PathLike | None = None,
    name: str = "scene",
    precision: str = "f64",
    arch: str = "cpu",
    threads: int | None = None,
    deterministic: bool = False,
    resume: bool = False,
    checkpoint_every: float = CHECKPOINT_S,
    progress: Callable[[Progress], None] | None = None,
) -> Result:
    """Run a scene to its end and write every file of a run into `out` (nothing is written when `out` is None).

    precision: 'f64' or 'f32'; arch: 'cpu' or 'cuda'; threads: CPU threads, all by default; deterministic: the same
    bits whatever the number of threads, on one kind of machine; resume: go on from the
    checkpoint in `out`, from the start where there is none; checkpoint_every: wall time between checkpoints [s];
    progress: called after each history row. Ctrl-C and SIGTERM stop after the step and still write what there is.
    Raises SceneError for input that cannot be run, before anything compiles, and when files cannot be written any
    more, and UnstableRun after writing everything up to there.
    """
    if precision not in ("f64", "f32"):
        raise refuse("precision", precision, "'f64' or 'f32'")
    check_precision(scene, precision)
    if arch not in ("cpu", "cuda"):
        raise refuse("arch", arch, "'cpu' or 'cuda'")
    if threads is not None and not (type(threads) is int and 1 <= threads <= 1024):
        raise refuse("threads", threads, "a whole number from 1 to 1024")
    if deterministic and arch != "cpu":
        raise refuse(
            "deterministic", deterministic, "False on a GPU", "its sums are taken in any order; use --arch cpu"
        )
    if not (math.isfinite(checkpoint_every) and checkpoint_every >= 0.0):
        raise refuse("checkpoint_every", checkpoint_every, "a number of seconds, 0 for one after each history row")
    if resume and out is None:
        raise refuse("resume", resume, "False without an output folder", "give the folder of the run as `out`")
    settings = Settings(
        name=name, precision=precision, arch=arch, threads=threads, deterministic=deterministic,
        checkpoint_every=checkpoint_every, progress=progress,
    )  # fmt: skip
    seeds, kept = scene.particles(), None
    if resume and out is not None:
        from rsmpm_ti.run.checkpoint import read

        kept = read(Path(out), settings.identity(scene))
    if out is not None:
        out = prepare(scene, out, keep=kept is not None)
    return Run(scene, seeds, out, settings, kept).go()


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How a scene is run; arguments of `simulate`."""

    name: str = "scene"
    precision: str = "f64"
    arch: str = "cpu"
    threads: int | None = None
    deterministic: bool = False
    checkpoint_every: float = CHECKPOINT_S
    progress: Callable[[Progress], None] | None = None

    def identity(self, scene: Scene) -> dict:
        """What two runs must share if one goes on from the other's checkpoint."""
        from rsmpm_ti.spec.scene_json import to_plain

        shared = {"precision": self.precision, "arch": self.arch, "deterministic": self.deterministic}
        return {"rsmpm_ti": __version__, **shared, "scene": to_plain(scene)}


class Run:
    """One run: the loop, and what is written when. Starts Taichi.

    kept: arrays of the checkpoint from which it goes on, None for a run from the start.
    """

    def __init__(self, scene: Scene, seeds, out: Path | None, settings: Settings, kept=None):
        self.scene, self.settings = scene, settings
        self.out: Any = out  # with its writer: asked for only where files are written
        self.writer: Any = None
        self.compile_s = -time.perf_counter()
        if out is not None:  # first, since it gets ready while kernels compile here
            from rsmpm_ti.output.pictures import commission
            from rsmpm_ti.output.writer import Writer

            write_record(out, scene, settings.name, settings.precision)
            volume = float(sum(body.volume.sum() for body in seeds))
            self.writer = Writer(commission(scene, settings.name, out, volume))
        try:
            self._set_up(seeds, kept)
        except BaseException:
            self._abandon()
            raise

    def _set_up(self, seeds, kept) -> None:
        from rsmpm_ti.solver.advance import Drive
        from rsmpm_ti.solver.history import History

        real, gpu = start_taichi(self.settings.precision, self.settings.arch, self.settings.threads)
        self.drive = Drive(self.scene, seeds, real, gpu, self.settings.deterministic)
        self.sim, self.clock = self.drive.sim, self.drive.clock
        self.history = History(self.sim, self.clock, self.drive.survey)
        self.row_steps = max(1, self.clock.total // self.scene.schedule.rows)
        self.frame_count = 0
        self.vtus: list[tuple[float, str]] = []
        self.wall_before, self.resumed = 0.0, kept is not None
        self.interrupted = threading.Event()
        if self.writer is not None:
            from rsmpm_ti.output.timetable import Timetable

            self.timetable = Timetable(self.scene, self.sim.particles.count)
        if kept is not None:
            self._go_on(kept)

    def _go_on(self, kept: dict[str, np.ndarray]) -> None:
        from rsmpm_ti.run.checkpoint import restore

        progress = restore(kept, self.drive, self.history)
        self.timetable.resume(progress["timetable"])
        self.frame_count, self.wall_before = progress["frames"], progress["wall_s"]
        self.vtus = [tuple(entry) for entry in progress["vtus"]]
        forget(self.out, frames=self.frame_count, vtus=len(self.vtus))
        self.writer.refilm(self.frame_count)

    def go(self) -> Result:
        """Steps to the end of the scene, to Ctrl-C, SIGTERM or instability; writes; raises as `simulate`."""
        stopped = ""
        failure: UnstableRun | SceneError | None = None
        try:
            with asked_to_stop(self.interrupted):
                try:
                    self._begin()
                    while not self.clock.done and not self.interrupted.is_set():
                        self._row()
                    if not self.clock.done:
                        stopped = f"interrupted after step {self.clock.step} of {self.clock.total}"
                except (UnstableRun, SceneError) as error:
                    stopped, failure = str(error), error
            result = self._finish(stopped, failure)
        except BaseException:
            self._abandon()
            raise
        if failure is not None:
            failure.result = result
            raise failure
        return result

    def _begin(self) -> None:
        """One step apart, or the first row of a run that goes on, so that compilation is not counted as running."""
        import taichi as ti

        self.started, self.painting_s = time.perf_counter(), 0.0
        self.steps_before, self.saved = self.clock.step, time.perf_counter()
        if not self.resumed:
            self._output()
            self.drive.advance(1)
        elif not self.clock.done:
            self._row()
        ti.sync()
        self.started, self.painting_s, self.steps_before = time.perf_counter(), 0.0, self.clock.step
        self.compile_s += self.started

    def _row(self) -> None:
        """Steps up to the next history row."""
        self.drive.advance(self.row_steps)
        self.history.record(self.drive.survey)
        self._output()
        if self.writer is not None and time.perf_counter() - self.saved >= self.settings.checkpoint_every:
            self._checkpoint()
        if self.settings.progress is not None:
            self.settings.progress(self._progress())

    def _output(self) -> None:
        if self.writer is None:
            return
        from rsmpm_ti.solver.readout import read_out

        start = time.perf_counter()
        share = self.clock.share
        frame = self.timetable.frame_due(share, self.history.failed)
        vtu = self.timetable.vtu_due(share)
        if frame or vtu:
            readout = read_out(self.sim, self.clock.time)
            if frame:
                self.writer.frame(self.frame_count, readout, self.history.table())
                self.frame_count += 1
            if vtu:
                self.vtus.append((readout.time, f"particles_{len(self.vtus):04d}.vtu"))
                self.writer.vtu(list(self.vtus), readout)
            self.painting_s += time.perf_counter() - start

    def _checkpoint(self) -> None:
        from rsmpm_ti.run.checkpoint import take

        start = time.perf_counter()
        progress = {
            "timetable": self.timetable.state(), "frames": self.frame_count, "vtus": self.vtus, "wall_s": self._wall(),
        }  # fmt: skip
        self.writer.checkpoint(take(self.drive, self.history, progress, self.settings.identity(self.scene)))
        self.saved = time.perf_counter()
        self.painting_s += self.saved - start

    def _wall(self) -> float:
        return self.wall_before + time.perf_counter() - self.started

    def _progress(self) -> Progress:
        row = self.history.rows[-1]
        return Progress(
            share=self.clock.share,
            time=row[0],
            strain=row[1],
            stress=0.5 * (row[2] + row[3]),
            failed_tension=int(row[8]),
            failed_shear=int(row[9]),
            particle_steps_per_s=self._speed(),
        )

    def _speed(self) -> float:
        solving = time.perf_counter() - self.started - self.painting_s
        return self.sim.particles.count * (self.clock.step - self.steps_before) / max(solving, 1e-9)

    def _finish(self, stopped: str, failure: Exception | None) -> Result:
        from rsmpm_ti.analysis.fracture import measure_fracture
        from rsmpm_ti.solver.readout import read_events, take_snapshot

        speed = self._speed()
        history, events = self.history.table(), read_events(self.sim)
        snapshot = take_snapshot(self.sim, self.clock.time)
        fracture = measure_fracture(self.scene, history, events, snapshot)
        summary: dict = {}
        summarise = partial(self._summarise, summary, history, events, fracture, speed, stopped)
        if self.out is None:
            summarise()
        else:
            self._write(history, events, fracture, snapshot, summarise, summary, failure)
        return Result(
            history=history, summary=summary, events=events, fracture=fracture, snapshot=snapshot, out=self.out,
            stopped=stopped,
        )  # fmt: skip

    def _summarise(self, summary: dict, history, events, fracture, speed: float, stopped: str) -> None:
        """Fill summary.json's numbers in, last: they count the time of everything else."""
        from rsmpm_ti.analysis.summary import summarise

        writer = self.writer
        summary |= {
            "particles": self.sim.particles.count,
            "steps": self.clock.step,
            "dt_s": self.clock.dt,
            "wall_s": self._wall(),
            "compile_s": self.compile_s,
            "painting_s": self.painting_s,
            "painting_cpu_s": writer.cpu_s if writer is not None else 0.0,
            "particle_steps_per_s": speed,
            "time_scale": self.scene.time_scale,
            **summarise(self.scene, history, events, self.history.energy_start),
            **fracture.numbers(),
            **self.drive.dropped.numbers(),
            "stopped": stopped,
            "warning": writer.warning if writer is not None else "",
        }

    def _write(self, history, events, fracture, snapshot, summarise, summary, failure) -> None:
        from rsmpm_ti.output.files import write_events, write_history, write_json
        from rsmpm_ti.output.fracture_tables import write_fracture

        def close() -> None:
            start = time.perf_counter()
            self.writer.close(snapshot, history, fracture.paths, fracture.acoustic.time)
            self.painting_s += time.perf_counter() - start

        writes = [
            lambda: write_history(self.out / "history.csv", history),
            lambda: write_events(self.out / "events.csv", events),
            lambda: write_fracture(self.out, fracture, history),
        ]
        if failure is None:  # else the last checkpoint is of a sound state, or nothing more can be written
            writes.append(self._checkpoint)
        if not isinstance(failure, SceneError):
            writes.append(close)
        writes += [summarise, lambda: write_json(self.out / "summary.json", summary)]
        write_all(writes)

    def _abandon(self) -> None:
        if self.writer is not None:
            self.writer.abandon()
