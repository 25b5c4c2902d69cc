"""The end of a run: what broke is measured, numbers are summed up, and everything that can be written is written."""

import time

from rsmpm_ti.analysis.fracture import Fracture, crack_lines, measure_fracture
from rsmpm_ti.analysis.summary import summarise
from rsmpm_ti.errors import ObserverError, SceneError
from rsmpm_ti.output.files import write_events, write_history, write_reactions
from rsmpm_ti.output.folder import SUMMARY, write_all
from rsmpm_ti.output.fracture_tables import write_fracture
from rsmpm_ti.records.files import plain, write_json
from rsmpm_ti.records.result import Result
from rsmpm_ti.run.warnings import kinetic_share_after, warnings_of
from rsmpm_ti.solver.damping import damping_said, viscous_energy


def finish(run, stopped: str, failure: Exception | None) -> Result:
    """Measure, write and sum up a `Run` that has ended; stopped: why before its end, failure: by which exception."""
    speed, view = run.speed(), run.view()
    fracture = measure_fracture(run.scene, view.history, view.events, view.snapshot)
    summary = {}

    def sum_up(well: bool) -> None:  # last, since it counts the time of everything else, and says how that went
        done = well and run.over and failure is None and run.late_failure is None
        numbers = numbers_of(run, view, fracture, speed, stopped, done)
        summary.update(plain(numbers))  # the same in Python as in the file
        if run.folder is not None:
            write_json(run.folder.file(SUMMARY), summary)

    if run.folder is None:
        sum_up(True)
    else:
        write_all(_writes(run, view, fracture, failure), sum_up)
        if summary["complete"]:
            run.folder.complete()
    return Result(
        history=view.history, summary=summary, events=view.events, fracture=fracture, snapshot=view.snapshot,
        out=run.out, stopped=stopped, signal=0 if run.over else run.interrupt.signal,
        reactions=run.history.reactions.table(),
    )  # fmt: skip


def _writes(run, view, fracture: Fracture, failure: Exception | None) -> list:
    """What is left to be written, in order."""

    def timed(work, *arguments) -> None:
        start = time.perf_counter()
        work(*arguments)
        run.painting_s += time.perf_counter() - start

    def checkpoint() -> None:
        try:
            timed(run.write_checkpoint)
        except ObserverError as error:  # by what it remembers; the rest is still written
            run.late_failure = error

    file, reactions = run.folder.file, run.history.reactions.table()
    writes = [
        lambda: write_history(file("history.csv"), view.history),
        lambda: write_events(file("events.csv"), view.events),
        lambda: write_fracture(file, fracture, view.history),
    ]
    if reactions is not None:
        writes.append(lambda: write_reactions(file("reactions.csv"), reactions))
    of_user = isinstance(failure, ObserverError)  # the run itself was sound
    if failure is None or of_user:  # else the last one is of a sound state, or nothing more can be written
        writes.append(checkpoint)
    if of_user or not isinstance(failure, SceneError):
        peak = run.largest.pattern
        lines = [] if peak is None else crack_lines(run.scene, view.events, peak)
        last = view.snapshot, view.history, fracture.lines, fracture.acoustic.time, peak, lines
        writes.append(lambda: timed(run.writer.close, *last))
        movie = f"{run.settings.name}.mp4"
        writes.append(lambda: run.folder.verify(unless=[movie] if run.writer.warning else []))
    return writes


def numbers_of(run, view, fracture: Fracture, speed: float, stopped: str, complete: bool) -> dict:
    """summary.json, whose keys `records/summary_table.py` declares."""
    writer = run.writer
    what_broke = summarise(run.scene, view.history, view.events, run.history.energy_start)
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
        **what_broke,
        "kinetic_share_after": kinetic_share_after(view.history, what_broke["first_failure_time_s"]),
        **fracture.numbers(),
        **run.drive.dropped.numbers(),
        "stopped": stopped,
        "complete": complete,
    }
    beside = [writer.warning] if writer is not None and writer.warning else []
    found = warnings_of(run.scene, numbers, view.history, view.events)
    damped = damping_said(run.scene, view.history, run.history.energy_start, viscous_energy(run.sim))
    return numbers | {"warnings": [*run.said, *found, *damped, *beside]}
