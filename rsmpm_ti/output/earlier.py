"""The run that was in a folder before: kept beside it, in `<folder>.previous`, until the new one is complete.

Of two earlier runs the one that is complete is kept. Each step may be the last before a kill: the list of the files
says in which folder they are, or that they are on their way.
"""

import json
import os
from dataclasses import replace
from pathlib import Path

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output import manifest
from rsmpm_ti.output.lock import FILE, Lock
from rsmpm_ti.output.manifest import ASIDE, MOVING, Manifest, is_file, is_folder, mode_of, remove
from rsmpm_ti.records.files import part_of

SUMMARY_BYTES = 2**24

BEFORE_LIST = {FILE, part_of(Path(manifest.FILE)).name}
"""What may be in a folder that a run was to be moved to when a kill came: as much as nothing."""


def previous_of(folder: Path) -> Path:
    """Beside the folder itself, where a link leads to it, so that moving is renaming."""
    folder = folder.resolve()
    return folder.with_name(f"{folder.name}.previous")


def summary_of(folder: Path) -> dict:
    """summary.json of the run in a folder; empty where there is none that can be read."""
    try:
        if not is_file(folder, "summary.json") or (folder / "summary.json").stat().st_size > SUMMARY_BYTES:
            return {}
        found = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return {}
    return found if isinstance(found, dict) else {}


def check_place(previous: Path, run: Manifest | None) -> None:
    """Refuse where the earlier run cannot be set aside: something else has its place. None: of an earlier version."""
    if not mode_of(previous) or (is_folder(previous) and set(os.listdir(previous)) <= BEFORE_LIST):
        return
    there = manifest.read(previous) if is_folder(previous) else None
    fits = there is not None and run is not None and (there.state == ASIDE or there == replace(run, state=MOVING))
    if not fits or (mode_of(previous / manifest.FRAMES) and not is_folder(previous / manifest.FRAMES)):
        raise _in_the_way(previous)


def _in_the_way(path: Path) -> SceneError:
    return SceneError(
        f"{path} is in the way: the earlier run is kept there until the new one is complete; rename or remove it, or "
        f"give another folder with --out"
    )


def set_aside(folder: Path, run: Manifest, previous: Path) -> None:
    """Move an earlier run's files out of its folder; one that is not complete gives way to one that was set aside."""
    previous.mkdir(exist_ok=True)
    with Lock(previous):
        there = manifest.read(previous)
        if there is not None and there.state == ASIDE and not summary_of(folder).get("complete"):
            _clear(folder, run)
            return
        names, listed = [name for name in run.names if is_file(folder, name)], there.names if there is not None else ()
        for name in names:
            if mode_of(previous / name) and name not in listed:  # of the user
                raise _in_the_way(previous / name)
        if there is not None and there.state == ASIDE:
            _clear(previous, there)
        manifest.write(previous, replace(run, state=MOVING))
        for name in names:
            (previous / name).parent.mkdir(exist_ok=True)
            os.rename(folder / name, previous / name)
        _clear(folder, run)
        manifest.write(previous, replace(run, state=ASIDE))


def set_all_aside(folder: Path, previous: Path) -> None:
    """Move everything: what is a run's and what is the user's in the folder of an earlier version is not known."""
    previous.mkdir(exist_ok=True)
    stay = {FILE, part_of(Path("scene.json")).name}  # the new run's
    for path in list(folder.iterdir()):
        if path.name not in stay:
            path.rename(previous / path.name)


def remove_aside(previous: Path) -> None:
    """Remove a run that was set aside, not what the user has put beside it."""
    there = manifest.read(previous) if is_folder(previous) else None
    if there is None or there.state != ASIDE:
        return
    with Lock(previous):
        _clear(previous, there)
        (previous / manifest.FILE).unlink()
    if not any(previous.iterdir()):
        previous.rmdir()


def _clear(folder: Path, run: Manifest) -> None:
    """Remove a run's files, and the folder of its frames if that leaves it empty."""
    remove(folder, run.names)
    frames = folder / manifest.FRAMES
    if is_folder(frames) and not any(frames.iterdir()):
        frames.rmdir()
