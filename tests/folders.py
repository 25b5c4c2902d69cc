"""Folders of runs that were never run, for tests of what happens to their files."""

from dataclasses import replace
from pathlib import Path

import pytest

from rsmpm_ti import load_scene
from rsmpm_ti.errors import SceneError
from rsmpm_ti.output import lock, manifest
from rsmpm_ti.output.folder import RunFolder, prepare
from rsmpm_ti.records.files import write_json
from rsmpm_ti.spec.scene import Output

SCENE = replace(load_scene("cube", quick=True), output=Output(frames=2, vtu=1))
FILES = ("frames/stress_0000.png", "frames/cracks_0000.png", "particles_0000.vtu", "history.csv")


def contents(folder: Path) -> dict[str, bytes]:
    found = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
    return {name: data for name, data in found.items() if name != lock.FILE}


def begun(out: Path, **how) -> RunFolder:
    folder = prepare(SCENE, out, "cube", **how)
    folder.begin(goes_on=bool(how.get("resume")))
    return folder


def run(out: Path, mark: str, complete: bool = True, **how) -> None:
    """What a run leaves in its folder, without running."""
    folder = begun(out, **how)
    try:
        for name in FILES:
            folder.file(name).write_text(mark)
        write_json(folder.file("summary.json"), {"mark": mark, "complete": complete})
        folder.verify()
        if complete:
            folder.complete()
    finally:
        folder.release()


def refusal(out: Path, **how) -> str:
    before = contents(out)
    with pytest.raises(SceneError) as refused:
        prepare(SCENE, out, "cube", **how)
    assert contents(out) == before and "\n" not in str(refused.value)
    return str(refused.value)


def mark_of(folder: Path) -> str:
    """Of the one run whose files, and no others', are in a folder; "" where there is no run."""
    listed = manifest.read(folder)
    names = () if listed is None else [name for name in listed.names if name in FILES and (folder / name).exists()]
    marks = {(folder / name).read_text() for name in names}
    assert len(marks) <= 1, "files of two runs"
    return marks.pop() if marks else ""
