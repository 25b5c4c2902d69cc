"""What a study is: many runs, each in a process of its own and kept on disk, then rows and a picture from all."""

import functools
import hashlib
import inspect
import json
import multiprocessing
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.process import end_with_parent, no_current_folder, without_ctrl_c
from rsmpm_ti.records.files import complete
from rsmpm_ti.spec.library.places import PACKAGE, available

SOLVER = "records rock method spec setups fields analysis failure mpm solver run".split()
"""Rooms whose code a run's numbers may depend on, with the rooms in them, beside the modules that are in none."""


@dataclass(frozen=True)
class Run:
    """One run: `work(**settings)` returns a dict of arrays and numbers. `settings` are plain data; `tag` names it."""

    tag: str
    work: Callable
    settings: dict = field(default_factory=dict)
    precision: str = "f64"


@dataclass(frozen=True)
class Study:
    """`runs(quick)`: what to run; `finish(results)`: rows and picture, results being {tag: dict of arrays}."""

    name: str
    about: str
    runs: Callable[[bool], list[Run]]
    finish: Callable[[dict], Outcome]


def code_behind(work: Callable) -> list[Path]:
    """Files that numbers of `work` depend on: its own, the solver and the scenes."""
    solver = [*PACKAGE.glob("*.py"), *(file for room in SOLVER for file in (PACKAGE / room).rglob("*.py"))]
    return [Path(inspect.getfile(work)), *sorted(solver), *available().values()]


@functools.cache
def sources(work: Callable) -> str:
    """Digest of the code that numbers of `work` depend on.

    So a kept result outlives no change of it: hours are lost by it now and then, but no picture is of another code.
    """
    digest = hashlib.sha256()
    for file in code_behind(work):
        digest.update(file.name.encode() + file.read_bytes())
    return digest.hexdigest()


def stamp(run: Run) -> str:
    """What a kept result must agree with to be used again."""
    common = {"version": __version__, "sources": sources(run.work), "precision": run.precision}
    return json.dumps(common | run.settings, sort_keys=True)


def kept(run: Run, folder: Path) -> dict | None:
    """The result of an earlier run with the same settings, if there is one. Arrays only: no code is loaded."""
    path = folder / f"{run.tag}.npz"
    if not path.is_file():
        return None
    with np.load(path, allow_pickle=False) as file:
        result = {name: file[name] for name in file.files}
    return result if str(result.pop("stamp", "")) == stamp(run) else None


def _work(task: tuple[Run, Path]) -> tuple[str, dict, float]:
    from rsmpm_ti.backend.start import start_taichi

    run, folder = task
    start = time.perf_counter()
    start_taichi(run.precision, "cpu", 1)
    result = run.work(**run.settings)
    with complete(folder / f"{run.tag}.npz") as part, open(part, "wb") as file:
        np.savez_compressed(file, stamp=np.array(stamp(run)), **result)
    return run.tag, result, time.perf_counter() - start


def all_kept(runs: list[Run], folder: Path) -> Iterator[tuple[str, dict, float]]:
    """As `run_all`, of those kept from before only."""
    for run in runs:
        result = kept(run, folder)
        if result is not None:
            yield run.tag, result, 0.0


def run_all(runs: list[Run], folder: Path, jobs: int) -> Iterator[tuple[str, dict, float]]:
    """(tag, result, seconds) of every run as it comes; those kept from before take no time."""
    folder.mkdir(parents=True, exist_ok=True)
    done = set()
    for tag, result, seconds in all_kept(runs, folder):
        done.add(tag)
        yield tag, result, seconds
    waiting = [(run, folder) for run in runs if run.tag not in done]
    if waiting:
        spawn, jobs = multiprocessing.get_context("spawn"), min(jobs, len(waiting))
        with no_current_folder():
            with without_ctrl_c():
                pool = spawn.Pool(jobs, initializer=end_with_parent, maxtasksperchild=1)
            with pool:
                yield from pool.imap_unordered(_work, waiting)
