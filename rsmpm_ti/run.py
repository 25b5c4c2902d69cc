"""Run a scene from Python: start Taichi, step, observe, write. The only module that starts Taichi."""

import contextlib
import io
import os
import signal
import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.errors import SceneError, UnstableRun, refuse
from rsmpm_ti.snapshot import Snapshot
from rsmpm_ti.spec import Scene


@dataclass(frozen=True)
class Result:
    """What a run leaves behind. `history`: structured array of HISTORY_COLUMNS; `summary`: the dict of summary.json;
    `events`: EventTable; `fracture`: cracks, fragments and acoustic events measured on them; `snapshot`: last state.
    `stopped`: "" when the run reached its end, else why it did not."""

    history: np.ndarray
    summary: dict
    events: object
    fracture: object
    snapshot: Snapshot
    out: Path | None
    stopped: str = ""


@dataclass(frozen=True)
class Progress:
    """What a progress bar shows."""

    share: float
    time: float
    strain: float
    stress: float
    failed_tension: int
    failed_shear: int
    particle_steps_per_s: float


def simulate(
    scene: Scene,
    *,
    out: str | os.PathLike | None = None,
    name: str = "scene",
    precision: str = "f64",
    arch: str = "cpu",
    threads: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> Result:
    """Run a scene to its end and write every file of a run into `out` (nothing is written when `out` is None).

    precision: 'f64' or 'f32'; arch: 'cpu' or 'cuda'; threads: CPU threads, all by default; progress: called after
    each history row. Ctrl-C stops after the step and still writes what there is. Raises SceneError for input that
    cannot be run, before anything compiles, and UnstableRun after writing everything up to there.
    """
    if precision not in ("f64", "f32"):
        raise refuse("precision", precision, "'f64' or 'f32'")
    if arch not in ("cpu", "cuda"):
        raise refuse("arch", arch, "'cpu' or 'cuda'")
    if threads is not None and not (isinstance(threads, int) and 1 <= threads <= 1024):
        raise refuse("threads", threads, "a whole number from 1 to 1024")
    seeds = scene.particles()
    out = _prepare(scene, out)
    real, gpu = start_taichi(precision, arch, threads)
    run = _Run(scene, seeds, out, name, real, gpu, progress, precision)
    return run.go()


def _prepare(scene: Scene, out) -> Path | None:
    """Make the output folder now, so that an unwritable one costs no computing; check the painter likewise."""
    if out is None:
        return None
    if scene.output.painter == "ggui" and scene.output.frames:
        from rsmpm_ti.paint.ggui import probe

        usable, reason = probe()
        if not usable:
            raise refuse("output.painter", "ggui", "raster on this machine", reason)
    out = Path(out)
    try:
        (out / "frames").mkdir(parents=True, exist_ok=True)
        for old in (*out.glob("frames/*.png"), *out.glob("particles_*.vtu")):
            old.unlink()  # a shorter run must not leave the frames of a longer one behind
        probe_file = out / ".writable"
        probe_file.touch()
        probe_file.unlink()
    except OSError as error:
        raise SceneError(f"output folder {out} cannot be written: {error.strerror}; give another with --out") from None
    return out


def start_taichi(precision: str, arch: str, threads: int | None):
    import taichi as ti

    real = ti.f64 if precision == "f64" else ti.f32
    # never ti.gpu: it crashes without Vulkan, or runs silently on a software Vulkan with wrong numbers
    wanted = [ti.cuda, ti.cpu] if arch == "cuda" else ti.cpu
    with contextlib.redirect_stdout(io.StringIO()):  # it announces its backend there
        ti.init(
            arch=wanted, default_fp=real, cpu_max_num_threads=threads or os.cpu_count() or 1, log_level=ti.ERROR,
            cfg_optimization=False,  # LLVM does the same; its time grows faster than the kernel: 20 s for one of 6 s
        )  # fmt: skip
    if arch == "cuda" and ti.lang.impl.current_cfg().arch != ti.cuda:
        raise SceneError("arch = 'cuda' is refused: no usable CUDA device was found; use --arch cpu")
    return real, arch == "cuda"


class _Run:
    """One run: the loop, and what is written when."""

    def __init__(self, scene, seeds, out, name, real, gpu, progress, precision):
        from rsmpm_ti.drive import Drive
        from rsmpm_ti.observe import History

        self.scene, self.out, self.name, self.progress, self.precision = scene, out, name, progress, precision
        self.compile_s = -time.perf_counter()
        self.drive = Drive(scene, seeds, real, gpu)
        self.sim, self.clock = self.drive.sim, self.drive.clock
        self.history = History(self.sim, self.clock, self.drive.survey)
        self.row_steps = max(1, self.clock.total // scene.schedule.rows)
        self.gallery = self.timetable = None
        self.interrupted = threading.Event()
        if out is not None:
            from rsmpm_ti.frames import Gallery, Timetable

            self._write_record()
            self.timetable = Timetable(scene, self.sim.particles.count)
            volume = float(sum(body.volume.sum() for body in seeds))
            self.gallery = Gallery(scene, name, out, volume)

    def go(self) -> Result:
        old = None
        if threading.current_thread() is threading.main_thread():
            old = signal.signal(signal.SIGINT, lambda *_: self.interrupted.set())
        stopped, failure = "", None
        try:
            self._first_step()
            while not self.clock.done and not self.interrupted.is_set():
                self._row()
            if not self.clock.done:
                stopped = f"interrupted after step {self.clock.step} of {self.clock.total}"
        except UnstableRun as error:
            stopped, failure = str(error), error
        finally:
            if old is not None:
                signal.signal(signal.SIGINT, old)
        result = self._finish(stopped)
        if failure is not None:
            failure.result = result
            raise failure
        return result

    def _first_step(self) -> None:
        """One step apart, so that compilation is not counted as running."""
        import taichi as ti

        self._output(force=True)
        self.drive.advance(1)
        ti.sync()
        self.compile_s += time.perf_counter()
        self.started, self.steps_before = time.perf_counter(), self.clock.step
        self.painting_s = 0.0

    def _row(self) -> None:
        """Steps up to the next history row."""
        self.drive.advance(self.row_steps)
        self.history.record(self.drive.survey)
        self._output()
        if self.progress is not None:
            self.progress(self._progress())

    def _output(self, force: bool = False) -> None:
        if self.gallery is None:
            return
        from rsmpm_ti.observe import take_snapshot

        start = time.perf_counter()
        share = self.clock.share
        frame = self.timetable.frame_due(share, self.history.failed)
        vtu = self.timetable.vtu_due(share)
        if frame or vtu or force:
            snapshot = take_snapshot(self.sim, self.clock.time)
            if frame:
                self.gallery.frame(snapshot, self.history.table())
            if vtu:
                self.gallery.vtu(snapshot)
            if not force:
                self.painting_s += time.perf_counter() - start

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

    def _write_record(self) -> None:
        from rsmpm_ti.library import machine
        from rsmpm_ti.output import write_json
        from rsmpm_ti.record import to_plain

        seeds = [getattr(body.seeding, "seed", None) for body in self.scene.bodies]
        record = {
            "rsmpm_ti": __version__, "name": self.name, "precision": self.precision, "seeds": seeds,
            "machine": machine(), "time_scale": self.scene.time_scale, "scene": to_plain(self.scene),
        }  # fmt: skip
        write_json(self.out / "scene.json", record)

    def _finish(self, stopped: str) -> Result:
        from rsmpm_ti.fracture import measure_fracture
        from rsmpm_ti.observe import read_events, take_snapshot
        from rsmpm_ti.summary import summarise

        wall = time.perf_counter() - self.started
        speed = self._speed()
        history, events = self.history.table(), read_events(self.sim)
        snapshot = take_snapshot(self.sim, self.clock.time)
        fracture = measure_fracture(self.scene, history, events, snapshot)
        summary = {
            "particles": self.sim.particles.count,
            "steps": self.clock.step,
            "dt_s": self.clock.dt,
            "wall_s": wall,
            "compile_s": self.compile_s,
            "painting_s": self.painting_s,
            "particle_steps_per_s": speed,
            "time_scale": self.scene.time_scale,
            **summarise(self.scene, history, events, self.history.energy_start),
            **fracture.numbers(),
            **self.drive.dropped.numbers(),
            "stopped": stopped,
        }
        if self.out is not None:
            self._write(history, events, fracture, snapshot, summary)
        return Result(
            history=history, summary=summary, events=events, fracture=fracture, snapshot=snapshot, out=self.out,
            stopped=stopped,
        )  # fmt: skip

    def _write(self, history, events, fracture, snapshot, summary) -> None:
        from rsmpm_ti.fracture import write_fracture
        from rsmpm_ti.output import write_checkpoint, write_events, write_history, write_json
        from rsmpm_ti.sorting import particle_arrays

        write_history(self.out / "history.csv", history)
        write_events(self.out / "events.csv", events)
        write_fracture(self.out, fracture, history)
        write_json(self.out / "summary.json", summary)
        clock = {"step": np.array(self.clock.step), "strain": np.array(self.clock.strain)}
        write_checkpoint(self.out / "checkpoint.npz", clock | particle_arrays(self.sim))
        self.gallery.close(snapshot, history, fracture.paths, fracture.acoustic.time)
