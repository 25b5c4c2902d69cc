"""A run that is killed at any single change to the disk, and the one after it."""

import os
import pathlib

import pytest
from folders import FILES, contents, mark_of, run

from rsmpm_ti.output import manifest
from rsmpm_ti.output.earlier import previous_of


@pytest.fixture(autouse=True)
def no_loss_of_power(monkeypatch):
    """Nothing here waits for the disk."""
    monkeypatch.setattr(os, "fsync", lambda _: None)


CALLS = ("rename", "replace", "unlink", "mkdir", "rmdir")


def killed_at(count: int, monkeypatch, work) -> bool:
    """Whether work, in a process of its own, ended before its `count`-th change to the disk, at which it is killed."""
    left = count

    def dying(call):
        def change(*arguments, **keywords):
            nonlocal left
            left -= 1
            if left < 0:
                os._exit(1)
            return call(*arguments, **keywords)

        return change

    child = os.fork()
    if child == 0:
        for name in CALLS:
            dies = dying(getattr(os, name))
            monkeypatch.setattr(os, name, dies)
            if hasattr(pathlib, "_NormalAccessor"):  # of Python 3.10, whose paths have taken the calls out of os
                monkeypatch.setattr(pathlib._NormalAccessor, name, staticmethod(dies))
        try:
            work()
            os._exit(0)
        finally:
            os._exit(2)
    status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    assert status in (0, 1)
    return status == 0


def test_killed_anywhere_a_rerun_loses_no_complete_run(tmp_path, monkeypatch):
    """At every single change to the disk; then again to the end."""
    count, done = 0, False
    while not done:
        out = tmp_path / f"{count}"
        run(out, "first")
        done = killed_at(count, monkeypatch, lambda out=out: run(out, "second", overwrite=True))
        kept = [folder / name for name in FILES for folder in (out, previous_of(out)) if (folder / name).exists()]
        marks = [path.read_text() for path in kept]
        assert len(FILES) in (marks.count("first"), marks.count("second")), f"killed at change {count}"
        assert mark_of(out) in ("", "first", "second")  # of one run alone
        run(out, "third", overwrite=True)
        assert contents(out).keys() == {*FILES, "scene.json", "summary.json", manifest.FILE}
        assert mark_of(out) == "third" and not previous_of(out).exists(), f"killed at change {count}"
        count += 1
    assert count > 30


def test_killed_anywhere_a_run_that_goes_on_goes_on_again(tmp_path, monkeypatch):
    count, done = 0, False
    while not done:
        out = tmp_path / f"{count}"
        run(out, "run")
        done = killed_at(count, monkeypatch, lambda out=out: run(out, "run", resume=True))
        run(out, "run", resume=True)
        assert contents(out).keys() == {*FILES, "scene.json", "summary.json", manifest.FILE}
        assert mark_of(out) == "run" and not previous_of(out).exists(), f"killed at change {count}"
        count += 1
    assert count > 10
