"""Run cases: one in this process, or several at a time in processes of their own."""

import multiprocessing
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.verify.case import Row
from rsmpm_ti.verify.catalogue import CASES
from rsmpm_ti.verify.report import draw


@dataclass(frozen=True)
class Finished:
    """What came of one case; `problem`: why it broke, if it did."""

    name: str
    rows: tuple[Row, ...]
    seconds: float
    problem: str = ""


def run_case(name: str, full: bool, out: Path | None, threads: int = 1) -> tuple[Row, ...]:
    """Run one case in this process and draw it into `out`; its rows."""
    from rsmpm_ti.run import start_taichi

    start_taichi("f64", "cpu", threads)
    outcome = CASES[name].run(full)
    if out is not None:
        draw(out / f"{name}.png", outcome)
    return outcome.rows


def _work(task: tuple) -> Finished:
    name, full, out, threads = task
    start = time.perf_counter()
    try:
        rows, problem = run_case(name, full, out, threads), ""
    except Exception as error:  # a case that breaks is a miss of that case, and the others still run
        rows, problem = (), f"{type(error).__name__}: {error}"
    return Finished(name, rows, time.perf_counter() - start, problem)


def run_cases(names: list[str], full: bool, out: Path, jobs: int, threads: int) -> Iterator[Finished]:
    """Each case in a process of its own, `jobs` at a time: Taichi's memory of one never meets the next."""
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=1) as pool:
        yield from pool.imap_unordered(_work, [(name, full, out, threads) for name in names])
