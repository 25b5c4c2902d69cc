"""A user who may have few processes and threads: a line in place of Taichi's abort, or of waiting for ever."""

import os
import resource
import shutil
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from rsmpm_ti.backend import threads
from rsmpm_ti.errors import SceneError

ROOT = Path(__file__).resolve().parents[2]


def few(monkeypatch, most: int) -> None:
    """From now on so many threads start, and no more."""
    start, begun = threading.Thread.start, []

    def limited(thread) -> None:
        if len(begun) == most:
            raise RuntimeError("can't start new thread")
        begun.append(thread)
        start(thread)

    monkeypatch.setattr(threading.Thread, "start", limited)


def test_threads_that_cannot_start_are_told_with_what_to_do(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 6)
    before = threading.active_count()
    few(monkeypatch, 7)
    with pytest.raises(SceneError, match="^10 threads are needed, and 7 can be started.*less than 6 --threads") as told:
        threads.check_run_threads(None, writes=False)
    assert "\n" not in str(told.value) and threading.active_count() == before
    monkeypatch.undo()
    threads.check_run_threads(3, writes=True)
    assert threading.active_count() == before


LOWEST = ["--inh-caps=-all,+dac_override", "--ambient-caps=-all,+dac_override"]
OTHER = ["setpriv", "--reuid", "54321", *LOWEST] if os.geteuid() == 0 else []
"""Limits do not hold for root; a Python in root's home is still to be read."""


@pytest.mark.skipif(sys.platform != "linux" or bool(OTHER and not shutil.which("setpriv")), reason="no setpriv")
@pytest.mark.parametrize("most, needed", [(1, 2 * (threads.cores() - 1)), (2 * threads.cores(), None)])
def test_a_user_who_may_have_few_processes_is_told_in_a_line(tmp_path, most, needed):
    """The first: not those of NumPy."""
    tmp_path.chmod(0o777)
    if needed == 0:
        pytest.skip("one core: NumPy starts no threads")
    command = [sys.executable, "-m", "rsmpm_ti.scene", "intact", "--quick", "--threads", "1", "--out", "out"]
    environment = os.environ | {"PYTHONPATH": str(ROOT), "HOME": str(tmp_path), "PYTHONDONTWRITEBYTECODE": "1"}

    def starve() -> None:
        resource.setrlimit(resource.RLIMIT_NPROC, (most, most))

    done = subprocess.run(
        [*OTHER, *command], env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=60, preexec_fn=starve
    )
    assert done.returncode == 2 and done.stderr.count("\n") == 1, done.stderr
    assert "threads are needed, and " in done.stderr and f"threads: {most})" in done.stderr
    assert not list(tmp_path.iterdir())
