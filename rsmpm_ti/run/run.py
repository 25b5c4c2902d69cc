"""Run a scene from Python: start Taichi, step, let observers look, write."""

import os
import time
import warnings
from collections.abc import Callable
from typing import Any

from rsmpm_ti.analysis.load_curve import FilteredLoad
from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.backend.threads import check_run_threads
from rsmpm_ti.errors import BrokenApart, ObserverError, RockWarning, SceneError, UnstableRun, reason, refuse, still_kept
from rsmpm_ti.output.folder import RunFolder, named, prepare
from rsmpm_ti.records.progress import Progress
from rsmpm_ti.records.tables import Column
from rsmpm_ti.results.result import Result
from rsmpm_ti.run.alone import alone
from rsmpm_ti.run.finish import finish
from rsmpm_ti.run.interrupt import Interrupt, asked_to_stop
from rsmpm_ti.run.settings import CHECKPOINT_S, Settings
from rsmpm_ti.spec.review.sentences import review
from rsmpm_ti.spec.scene import Scene


@alone
def simulate(
    scene: Scene,
    *,
    out: str | os.PathLike | None = None,
    name: str = "scene",
    precision: str = "f64",
    arch: str = "cpu",
    threads: int | None = None,
    deterministic: bool = False,
    overwrite: bool = False,
    resume: bool = False,
    checkpoint_every: float = CHECKPOINT_S,
    progress: Callable[[Progress], None] | None = None,
    columns: tuple[Column, ...] = (),
    observers: tuple = (),
) -> Result:
    """Run a scene to its end and write every file of a run into `out` (nothing is written when `out` is None).

    precision: 'f64' or 'f32'; arch: 'cpu' or 'cuda'; threads: CPU threads, all by default; deterministic: the same
    bits whatever the number of threads, on one kind of machine; overwrite: replace the run that is in `out`, which is
    kept as `<out>.previous` until this one is complete; resume: go on from the checkpoint in `out`, from the start
    where there is none, of a run that was stopped or done: its end, rows and output may be others now, nothing else.
    Without either a folder with a run in it is refused. checkpoint_every: wall time between checkpoints [s]; progress:
    called after each history row; columns: more columns of the history (`Column`); observers: more observers
    (`Observer`), whose states a checkpoint keeps, to be given again, in the same order, to a run that resumes. Ctrl-C,
    SIGTERM and SIGHUP stop after the step, and what there is is still written; a second one does not wait for pictures.
    A specimen that bursts after its peak ends the run, which is then a result.
    What is hard to believe in the scene comes as RockWarning, a sentence each, before it starts.
    Raises SceneError for input that cannot be run, before anything compiles, and when files cannot be written any
    more, and after writing everything up to there UnstableRun, or ObserverError where a column or observer raised.
    """
    settings = Settings(
        name=name, precision=precision, arch=arch, threads=threads, deterministic=deterministic,
        checkpoint_every=checkpoint_every, progress=progress, columns=_tuple(columns), observers=_tuple(observers),
    )  # fmt: skip
    settings.check(scene)
    for name, asked in (("overwrite", overwrite), ("resume", resume)):
        if asked and out is None:
            raise refuse(name, asked, "False without an output folder", "give the folder of the run as `out`")
    if out is not None and not isinstance(out, str | os.PathLike):
        raise refuse("out", out, "the path of a folder, as text or a Path")
    if overwrite and resume:
        raise refuse("overwrite", overwrite, "False with resume", "a run is replaced, or it goes on")
    check_run_threads(threads, writes=out is not None)
    seeds, kept = scene.particles(), None
    said = review(scene, seeds)
    if out is not None:
        from rsmpm_ti.run.forecast import disk_said

        said += disk_said(scene, sum(len(body.x) for body in seeds), out)
    for sentence in said:
        warnings.warn(sentence, RockWarning, stacklevel=3)  # above the decorator
    interrupt = Interrupt()
    with asked_to_stop(interrupt):  # from here on a signal does not find a run half begun
        if out is None:
            return Run(scene, seeds, None, settings, interrupt, said=said).go()
        folder = prepare(scene, out, settings.name, settings.precision, overwrite=overwrite, resume=resume)
        try:
            damaged: list[str] = []
            if resume:
                from rsmpm_ti.run.checkpoint import kept_in

                kept = kept_in(folder, scene, seeds, settings, damaged)
                said += [f"{name} was damaged; the run went on from the checkpoint before it" for name in damaged]
            run = Run(scene, seeds, folder, settings, interrupt, kept, said)
            folder.remove(damaged)  # else the next checkpoint would set it aside, in the place of the good one
            return run.go()
        finally:
            folder.release()


def _tuple(entries):
    """A list as a tuple; what is neither is refused by its name."""
    return tuple(entries) if isinstance(entries, list) else entries


class Run:
    """One run: the loop, and what is written when. Starts Taichi.

    kept: arrays of the checkpoint from which it goes on, None for one from the start; said: sentences of doubt.
    """

    def __init__(
        self,
        scene: Scene,
        seeds,
        folder: RunFolder | None,
        settings: Settings,
        interrupt: Interrupt,
        kept: dict | None = None,
        said=(),
    ):
        self.scene, self.folder, self.settings, self.interrupt = scene, folder, settings, interrupt
        self.said, self.out = list(said), folder.path if folder is not None else None
        self.writer: Any = None  # an output.writer.Writer where files are written, imported only then: it needs Taichi
        self.lost: list[str] = []  # files of the run before it went on, which cannot be made again
        self.begun = time.perf_counter()
        if folder is not None:  # first, since it gets ready while kernels compile here
            from rsmpm_ti.output.pictures import commission
            from rsmpm_ti.output.writer import Writer

            self.writer = Writer(commission(scene, settings.name, folder.path, seeds), folder, self._in_a_hurry)
        try:
            self._set_up(seeds, kept)
            if folder is not None:
                self._open(folder)
        except BaseException:
            self._abandon()
            raise

    def _open(self, folder: RunFolder) -> None:
        """The folder becomes this run's only now that nothing can refuse the run any more."""
        self.writer.ready()
        folder.begin(goes_on=self.resumed)
        if self.resumed:
            self.lost = [name for files in self.files for name in files.go_on(self.view())]
            if self.lost:
                self.said.append(
                    f"{named(self.lost)} of the part before --resume were missing or damaged, and cannot be made again"
                )

    def _set_up(self, seeds, kept) -> None:
        from rsmpm_ti.run.checkpoint import changed, restore, restore_observers
        from rsmpm_ti.solver.advance import Drive
        from rsmpm_ti.solver.history import History

        real, gpu = start_taichi(self.settings.precision, self.settings.arch, self.settings.threads)
        self.drive = Drive(self.scene, seeds, real, gpu, self.settings.deterministic)
        self.sim, self.clock = self.drive.sim, self.drive.clock
        self.history = History(self.sim, self.clock, self.drive.survey, self.settings.columns)
        self.row_steps = self.scene.row_steps
        self.watches = self._observers()
        self.wall_before, self.resumed = 0.0, kept is not None
        self.ending, self.followed = "", True
        self.load = FilteredLoad(self.scene)
        if kept is not None:
            progress = restore(kept, self.drive, self.history)
            self.load.see_all(self.history.table())
            self.ending = self._fallen(self.view())
            another = changed(kept, self.settings.identity(self.scene))
            fraction = self.clock.fraction if another else None
            restore_observers(self.watches, progress["observers"], kept, fraction)
            self.wall_before = progress["wall_s"]

    def _in_a_hurry(self) -> bool:
        return self.interrupt.hurried

    def _observers(self) -> list:
        """In the order in which they look at a row: pictures, particle files, the user's own, the checkpoint."""
        from rsmpm_ti.run.checkpoint import Checkpoint
        from rsmpm_ti.solver.observer import Watch

        own, last = list[Any](), list[Any]()
        if self.writer is not None:
            from rsmpm_ti.output.observers import Frames, LargestLoad, ParticleFiles

            wanted, self.largest = self.scene.output, LargestLoad()
            self.files = (
                Frames(self.writer, wanted.frames, self.sim.particles.count),
                ParticleFiles(self.writer, wanted.vtu),
            )
            own += [self.largest, *self.files]
            last.append(Checkpoint(self.settings.checkpoint_every, self.write_checkpoint))
        users = [Watch(observer) for observer in self.settings.observers]
        return [*(Watch(o, own=True) for o in own), *users, *(Watch(o, own=True) for o in last)]

    def go(self) -> Result:
        """Steps to the end of the scene or an ending of its own, to a signal or instability; writes; raises as
        `simulate`."""
        stopped = ""
        failure: ObserverError | UnstableRun | SceneError | None = None
        try:
            try:
                self._begin()
                while not self.over and not self.interrupt.signal:
                    self._row()
                stopped = self.ending
                if not self.over:
                    stopped = f"interrupted after step {self.clock.step} of {self.clock.total}"
            except ObserverError as error:
                failure = ObserverError(f"{error}; at step {self.clock.step}, t = {self.clock.time:.6g} s")
                failure.__cause__, stopped = error.__cause__, str(failure)
            except (UnstableRun, SceneError) as error:
                stopped, failure = str(error), error
            except (MemoryError, OSError) as error:
                stopped = f"{reason(error)}; at step {self.clock.step}, t = {self.clock.time:.6g} s"
                failure = SceneError(f"the run cannot go on: {stopped}; {still_kept(stopped)}")
                failure.__cause__ = error
            result, late = finish(self, stopped, failure)
            if not self.interrupt.hurried:  # else what was given up was asked for
                failure = failure or late
            if failure is not None:
                self._abandon()
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

        from rsmpm_ti.run.checkpoint import observer_arrays

        self.started, self.painting_s, self.steps_before = time.perf_counter(), 0.0, self.clock.step
        if not self.resumed and self.scene.loading.settle:
            self._settle()
            if not self.followed:
                return
        if not self.resumed:
            self._look(self.view())  # without a row: no force has acted yet
            if self.writer is not None:  # what no checkpoint can keep is told now, not at the first of them
                observer_arrays(self.watches)
            self.drive.advance(1)
        elif not self.over:
            self._row()
        elif self.writer is not None:
            for files in self.files:
                files.catch_up(self.view())
        ti.sync()
        self.started, self.painting_s, self.steps_before = time.perf_counter(), 0.0, self.clock.step

    def _settle(self) -> None:
        """A run that is stopped meanwhile has not begun: its checkpoint would be of no start."""
        from rsmpm_ti.run.settling import settle
        from rsmpm_ti.solver.history import History

        self.followed = False
        if settle(self.drive, self.interrupt):
            self.followed = True
            self.history = History(self.sim, self.clock, self.drive.survey, self.settings.columns)
            self.history.zero(self.view())

    def _row(self) -> None:
        """Steps up to the next history row."""
        from rsmpm_ti.run.ending import burst

        broken = None
        try:
            self.drive.advance(self.row_steps)
        except BrokenApart as error:
            broken = error
        view = self.view()
        self.history.see(view)
        self.load.see(view.load.stress, view.strain)
        if broken is not None:
            self.ending, self.followed = burst(self.load, view, self.history.books, broken), False
            if not self.ending:
                raise broken
        else:
            self.ending = self._fallen(view)
        if self.ending:
            view.fraction = 1.0  # who looks at the end looks now
        self._look(view)
        if self.writer is not None and self.writer.problem:  # asked now that everybody has seen this row
            raise SceneError(f"{self.out} cannot be written: {self.writer.problem}; {still_kept(self.writer.problem)}")
        self._tell(view)

    @property
    def over(self) -> bool:
        """Whether the run has come to its end, by its schedule or by what happened."""
        return self.clock.done or bool(self.ending)

    def _fallen(self, view) -> str:
        from rsmpm_ti.run.ending import fallen, squeezed

        return fallen(self.load, view, self.scene.schedule.stop_after_drop) or squeezed(view)

    def view(self):
        from rsmpm_ti.solver.view import View

        return View(self.sim, self.clock, self.drive.survey, self.history, self.out)

    def _look(self, view) -> None:
        """Let observers look. What they take is not the solver's time."""
        from rsmpm_ti.solver.observer import look_all

        start = time.perf_counter()
        look_all(self.watches, view)
        self.painting_s += time.perf_counter() - start

    def write_checkpoint(self) -> None:
        """Not of a state that cannot be followed: the one before it stays."""
        if self.followed:
            self.writer.checkpoint(self.checkpoint_arrays())

    def checkpoint_arrays(self) -> dict:
        from rsmpm_ti.run.checkpoint import observer_arrays, take

        parts, arrays = observer_arrays(self.watches)
        progress = {"observers": parts, "wall_s": self.wall()}
        return take(self.drive, self.history, progress, self.settings.identity(self.scene)) | arrays

    def wall(self) -> float:
        return self.wall_before + time.perf_counter() - self.started

    def _tell(self, view) -> None:
        try:
            if self.settings.progress is not None:
                self.settings.progress(self._progress(view))
        except (Exception, SystemExit, GeneratorExit) as error:
            raise ObserverError(f"progress failed: {type(error).__name__}: {error}") from error

    def _progress(self, view) -> Progress:
        return Progress(
            fraction=view.fraction,
            time=view.time,
            strain=view.strain,
            stress=view.load.stress,
            failed_tension=view.survey.failed_tension,
            failed_shear=view.survey.failed_shear,
            particle_steps_per_s=self.speed(),
        )

    def speed(self) -> float:
        solving = max(time.perf_counter() - self.started - self.painting_s, 1e-9)
        return self.sim.particles.count * (self.clock.step - self.steps_before) / solving

    def _abandon(self) -> None:
        if self.writer is not None:
            self.writer.abandon()
