"""Run cases: one in this process, or several at a time in processes of their own."""

import importlib
import multiprocessing
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.cases.case import Case, Outcome, Row
from rsmpm_ti.cases.report import draw
from rsmpm_ti.process import end_with_parent, no_current_folder, without_ctrl_c


@dataclass(frozen=True)
class Finished:
    """What came of one case; `problem`: why it broke, or, where it has rows, why its picture is not there; else ""."""

    name: str
    rows: tuple[Row, ...]
    seconds: float
    problem: str = ""


def cases_of(catalogue: str) -> dict[str, Case]:
    """Cases by name, of a module that holds them as CASES."""
    return importlib.import_module(catalogue).CASES


def run_case(catalogue: str, name: str, full: bool, out: Path | None, threads: int = 1) -> tuple[Row, ...]:
    """Run one case in this process and draw it into `out`, if it has a picture; its rows."""
    outcome = _outcome(catalogue, name, full, threads)
    if out is not None:
        _draw(out, name, outcome)
    return outcome.rows


def _outcome(catalogue: str, name: str, full: bool, threads: int) -> Outcome:
    from rsmpm_ti.backend.start import start_taichi

    start_taichi("f64", "cpu", threads)
    case = cases_of(catalogue)[name]
    return case.run(case.in_full(full))


def _draw(out: Path, name: str, outcome: Outcome) -> None:
    if outcome.draw is not None:
        draw(out / f"{name}.png", outcome)


def _work(task: tuple) -> Finished:
    catalogue, name, full, out, threads = task
    start, problem = time.perf_counter(), ""
    rows: tuple[Row, ...] = ()
    try:
        outcome = _outcome(catalogue, name, full, threads)
        rows = outcome.rows
        _draw(out, name, outcome)
    except Exception as error:  # a case that breaks is a miss of that case, and the others still run
        problem = f"{type(error).__name__}: {error}"
    return Finished(name, rows, time.perf_counter() - start, problem)


def run_cases(catalogue: str, names: list[str], full: bool, out: Path, jobs: int, threads: int) -> Iterator[Finished]:
    """Each case in a process of its own, `jobs` at a time: Taichi's memory of one never meets the next."""
    tasks = [(catalogue, name, full, out, threads) for name in names]
    with no_current_folder(), ThreadPoolExecutor(jobs) as pool:
        begun = [pool.submit(_alone, task) for task in tasks]
        try:
            for done in as_completed(begun):
                yield done.result()
        except BaseException:  # Ctrl-C, for one: nobody wants what is still to come
            pool.shutdown(wait=False, cancel_futures=True)
            while not all(done.done() for done in begun):
                for process in multiprocessing.active_children():
                    process.kill()
                time.sleep(0.01)
            raise


def _alone(task: tuple) -> Finished:
    """A task in a process of its own, which may be killed: a pool of `multiprocessing` would wait for it for ever."""
    context, start = multiprocessing.get_context("spawn"), time.perf_counter()
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=_answer, args=(sender, task), daemon=True)
    with without_ctrl_c():
        process.start()
    sender.close()
    try:
        return receiver.recv()
    except EOFError:
        process.join()
        said = f"its process ended with status {process.exitcode}"
        return Finished(task[1], (), time.perf_counter() - start, said)
    finally:
        process.join()


def _answer(sender, task: tuple) -> None:
    end_with_parent()
    sender.send(_work(task))
