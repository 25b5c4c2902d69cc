"""The end of a run: what broke is measured, numbers are summed up, and everything that can be written is written."""

import time

from rsmpm_ti.analysis.fracture import Fracture, crack_lines, measure_fracture
from rsmpm_ti.analysis.summary import summarise
from rsmpm_ti.errors import ObserverError, SceneError
from rsmpm_ti.output.files import write_events, write_history
from rsmpm_ti.output.folder import write_all
from rsmpm_ti.output.fracture_tables import write_fracture
from rsmpm_ti.records.files import plain, write_json
from rsmpm_ti.records.result import Result


def finish(run, stopped: str, failure: Exception | None) -> Result:
    """Measure, write and sum up a `Run` that has ended; stopped: why before its end, failure: by which exception."""
    speed, view = run.speed(), run.view()
    fracture = measure_fracture(run.scene, view.history, view.events, view.snapshot)
    summary = {}

    def sum_up() -> None:  # last, since it counts the time of everything else
        summary.update(plain(numbers_of(run, view, fracture, speed, stopped)))  # the same in Python as in the file

    if run.out is None:
        sum_up()
    else:
        write_all(
            [*_writes(run, view, fracture, failure), sum_up, lambda: write_json(run.out / "summary.json", summary)]
        )
    return Result(
        history=view.history, summary=summary, events=view.events, fracture=fracture, snapshot=view.snapshot,
        out=run.out, stopped=stopped,
    )  # fmt: skip


def _writes(run, view, fracture: Fracture, failure: Exception | None) -> list:
    """What is left to be written, in order."""

    def timed(work, *arguments) -> None:
        start = time.perf_counter()
        work(*arguments)
        run.painting_s += time.perf_counter() - start

    def checkpoint() -> None:
        try:
            timed(run.checkpoint)
        except ObserverError as error:  # by what it remembers; the rest is still written
            run.late_failure = error

    writes = [
        lambda: write_history(run.out / "history.csv", view.history),
        lambda: write_events(run.out / "events.csv", view.events),
        lambda: write_fracture(run.out, fracture, view.history),
    ]
    of_user = isinstance(failure, ObserverError)  # the run itself was sound
    if failure is None or of_user:  # else the last one is of a sound state, or nothing more can be written
        writes.append(checkpoint)
    if of_user or not isinstance(failure, SceneError):
        peak = run.largest.pattern
        lines = [] if peak is None else crack_lines(run.scene, view.events, peak)
        last = view.snapshot, view.history, fracture.lines, fracture.acoustic.time, peak, lines
        writes.append(lambda: timed(run.writer.close, *last))
    return writes


def numbers_of(run, view, fracture: Fracture, speed: float, stopped: str) -> dict:
    """summary.json, whose keys `records/summary_table.py` declares."""
    writer = run.writer
    return {
        "particles": run.sim.particles.count,
        "steps": run.clock.step,
        "dt_s": run.clock.dt,
        "wall_s": run.wall(),
        "compile_s": run.started - run.begun,
        "painting_s": run.painting_s,
        "painting_cpu_s": writer.cpu_s if writer is not None else 0.0,
        "particle_steps_per_s": speed,
        "time_scale": run.scene.time_scale,
        **summarise(run.scene, view.history, view.events, run.history.energy_start),
        **fracture.numbers(),
        **run.drive.dropped.numbers(),
        "stopped": stopped,
        "warning": writer.warning if writer is not None else "",
    }
