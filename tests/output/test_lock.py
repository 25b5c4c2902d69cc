"""One run at a time in a folder: the other is told who has it, and who was killed has it no more."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output import lock

ROOT = Path(__file__).resolve().parents[2]


def refusal(folder: Path) -> str:
    with pytest.raises(SceneError) as refused:
        lock.Lock(folder)
    return str(refused.value)


def test_one_run_at_a_time_and_the_other_is_named(tmp_path):
    first = lock.Lock(tmp_path)
    assert f"process {os.getpid()} has since 20" in refusal(tmp_path)
    first.release()
    lock.Lock(tmp_path).release()
    assert not list(tmp_path.iterdir())


HOLD = """
import subprocess, sys
from pathlib import Path
from rsmpm_ti.output.lock import Lock
lock = Lock(Path(sys.argv[1]))
subprocess.Popen(["sleep", sys.argv[2]], pass_fds=lock.passed)
print("locked", flush=True)
sys.stdin.read()
"""


def test_the_lock_of_a_run_that_was_killed_is_free_once_its_painter_has_ended(tmp_path):
    command = [sys.executable, "-c", HOLD, str(tmp_path), "0.7"]
    with subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, env=os.environ | {"PYTHONPATH": str(ROOT)}
    ) as holder:
        assert holder.stdout.readline() == b"locked\n"
        began = time.monotonic()
        assert f"process {holder.pid} has" in refusal(tmp_path)
        holder.kill()
    lock.Lock(tmp_path).release()
    assert 0.3 < time.monotonic() - began < lock.GRACE_S


def test_a_lock_whose_file_another_has_in_the_meantime_is_not_removed_on_release(tmp_path):
    """The folder was renamed, and another run has begun in one of that name."""
    (tmp_path / "out").mkdir()
    first = lock.Lock(tmp_path / "out")
    (tmp_path / "out").rename(tmp_path / "elsewhere")
    (tmp_path / "out").mkdir()
    second = lock.Lock(tmp_path / "out")
    first.release()
    assert f"process {os.getpid()} has" in refusal(tmp_path / "out")
    second.release()


def test_where_the_system_has_no_locks_the_file_is_the_lock(tmp_path, monkeypatch):
    monkeypatch.setattr(lock, "fcntl", None)
    first = lock.Lock(tmp_path)
    assert "remove that file if the process is no more" in refusal(tmp_path)
    first.release()
    lock.Lock(tmp_path).release()


@pytest.mark.parametrize("system", ["with locks", "without"])
def test_a_lock_that_was_removed_is_put_back_where_nobody_has_taken_it(tmp_path, monkeypatch, system):
    if system == "without":
        monkeypatch.setattr(lock, "fcntl", None)
    first = lock.Lock(tmp_path)
    before = (tmp_path / lock.FILE).read_bytes()
    for _ in range(2):
        (tmp_path / lock.FILE).unlink()
        first.keep()
        assert (tmp_path / lock.FILE).read_bytes() == before
        assert f"process {os.getpid()} has since 20" in refusal(tmp_path)
    first.release()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("other", ["a run", "a killed one", "a file", "a link", "a folder", "a copy"])
def test_a_lock_that_another_has_taken_meanwhile_is_told(tmp_path, other):
    first, path = lock.Lock(tmp_path), tmp_path / lock.FILE
    copy = path.read_bytes()
    path.unlink()
    if other == "a run":
        second = lock.Lock(tmp_path)
        path.write_bytes(b"process 1 since 2026-01-01 00:00:00\n")
    elif other == "a link":
        path.symlink_to(tmp_path / "elsewhere")
    elif other == "a folder":
        path.mkdir()
    else:
        said = {"a copy": copy, "a file": b"yours", "a killed one": b"process 999999999 since 2026-01-01 00:00:00\n"}
        path.write_bytes(said[other])
    there = path.lstat()
    if other == "a copy":  # as a backup puts it back: nobody else has been there
        first.keep()
        assert f"process {os.getpid()} has since 20" in refusal(tmp_path)
    else:
        with pytest.raises(SceneError, match="was removed during the run, and (process|something else)"):
            first.keep()
        first.release()
        assert path.lstat() == there and [p.name for p in tmp_path.iterdir()] == [lock.FILE]
    if other == "a run":
        second.release()


def strangers(path: Path, kind: str) -> Path | None:
    """Something under the lock's name that no run made; the file behind it, if any."""
    behind = path.parent.parent / "precious.txt"
    if kind == "second name of an empty file":
        behind.touch()
        os.link(behind, path)
        return behind
    if kind == "link":
        behind.write_text("mine")
        path.symlink_to(behind)
        return behind
    if kind == "pipe":
        os.mkfifo(path)
    elif kind == "folder":
        path.mkdir()
    else:
        path.write_text("notes")
    return None


@pytest.mark.parametrize("kind", ["second name of an empty file", "link", "pipe", "folder", "file"])
@pytest.mark.parametrize("when", ["before", "during"])
def test_what_a_stranger_put_in_the_place_of_a_lock_is_left_as_it_is(tmp_path, kind, when):
    (tmp_path / "out").mkdir()
    path = tmp_path / "out" / lock.FILE
    if when == "before":
        behind = strangers(path, kind)
        held = behind and behind.read_bytes()
        assert "is no lock of a run" in refusal(tmp_path / "out")
    else:
        first = lock.Lock(tmp_path / "out")
        path.unlink()
        behind = strangers(path, kind)
        held = behind and behind.read_bytes()
        with pytest.raises(SceneError, match="something else has its place"):
            first.keep()
        first.release()
    assert os.path.lexists(path)
    assert behind is None or behind.read_bytes() == held


def test_an_empty_lock_of_a_run_that_was_killed_as_it_made_it_is_replaced(tmp_path):
    (tmp_path / lock.FILE).touch()
    lock.Lock(tmp_path).release()
    assert not list(tmp_path.iterdir())
