"""Specimens run in processes of their own, each an ordinary run in its folder, and read back from there."""

import json
import multiprocessing
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.errors import RockWarning, SceneError, UnstableRun
from rsmpm_ti.lab.standard import Measured, Specimen
from rsmpm_ti.output.earlier import summary_of
from rsmpm_ti.process import end_with_parent, no_current_folder, without_ctrl_c
from rsmpm_ti.results.loading import load_result
from rsmpm_ti.spec.scene_json import to_plain


@dataclass(frozen=True)
class Task:
    """What a process is given to run."""

    specimen: Specimen
    folder: Path
    threads: int


@dataclass(frozen=True)
class Done:
    """problem: why it came to no end, "" where it did; kept: whether it was there before; unstable: whether the problem
    is the specimen's, and not one of the disk, the memory, the folder."""

    label: str
    seconds: float
    problem: str = ""
    kept: bool = False
    unstable: bool = False


def is_done(specimen: Specimen, folder: Path) -> bool:
    """Whether a complete run of the same scene is in the folder."""
    try:
        recorded = json.loads((folder / "scene.json").read_text(encoding="utf-8"))["scene"]
        return bool(summary_of(folder).get("complete")) and recorded == json.loads(json.dumps(to_plain(specimen.scene)))
    except (OSError, ValueError, KeyError, TypeError):
        return False


def of_another(specimens: list[Specimen], out: Path) -> list[str]:
    """Folders among those of the specimens that hold a complete run of another scene."""
    folders = (out / one.label for one in specimens if not is_done(one, out / one.label))
    return [str(folder) for folder in folders if summary_of(folder).get("complete")]


def run_all(specimens: list[Specimen], out: Path, *, jobs: int, threads: int, resume: bool) -> Iterator[Done]:
    """Every specimen as it comes to its end. resume: what is complete is kept.

    jobs: processes at a time; threads: of each.
    """
    waiting = []
    for specimen in specimens:
        folder = out / specimen.label
        if resume and is_done(specimen, folder):
            yield Done(specimen.label, 0.0, kept=True)
        else:
            waiting.append(Task(specimen, folder, threads))
    if waiting:
        spawn = multiprocessing.get_context("spawn")
        with no_current_folder():
            with without_ctrl_c():
                pool = spawn.Pool(min(jobs, len(waiting)), initializer=end_with_parent, maxtasksperchild=1)
            with pool:
                yield from pool.imap_unordered(_run, waiting)


def _run(task: Task) -> Done:
    import time

    from rsmpm_ti.run.run import simulate

    begun, problem, unstable = time.perf_counter(), "", False
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RockWarning)  # they stand in summary.json, and in the report
            simulate(task.specimen.scene, out=task.folder, name="run", threads=task.threads, overwrite=True)
    except (SceneError, UnstableRun) as error:
        problem, unstable = str(error), isinstance(error, UnstableRun)
    return Done(task.specimen.label, time.perf_counter() - begun, problem, unstable=unstable)


def read_back(specimen: Specimen, folder: Path) -> Measured:
    """The records of a run that is complete. Raises SceneError where they cannot be read."""
    result = load_result(folder)
    return Measured(specimen=specimen, history=result.history, summary=result.summary, folder=folder)
