"""The process that paints and writes: what it says when it cannot, and that it never outlives or outwaits a run."""

import os
import signal

import numpy as np
import pytest
from snapshots import snapshot_of
from writer_orders import NO_ROWS, started

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output import lock
from rsmpm_ti.output.writer import Writer


def finish(writer: Writer) -> None:
    writer.close(snapshot_of(np.array([[0.025, 0.05]])), NO_ROWS, [], np.zeros(0))


def test_a_full_disk_is_reported_in_one_line_and_complete_files_stay(tmp_path):
    writer = started(tmp_path)
    writer.checkpoint({"a": np.zeros(3)})
    writer.vtu([(0.0, "particles_0000.vtu")], None, {})  # anything that the child cannot do
    with pytest.raises(SceneError, match="cannot be written: .+"):
        finish(writer)
    assert np.array_equal(np.load(tmp_path / "checkpoint.npz")["a"], np.zeros(3))
    writer.abandon()  # as a run does after any failure


def test_a_child_that_is_killed_is_named(tmp_path):
    writer = started(tmp_path)
    os.kill(writer._child.pid, signal.SIGKILL)
    with pytest.raises(SceneError, match="ended with status -9"):
        finish(writer)


def test_abandoned_it_is_gone_whatever_it_was_doing(tmp_path):
    writer = started(tmp_path)
    for _ in range(3):
        writer.checkpoint({"a": np.zeros(2_000_000)})
    writer.abandon()
    assert writer._child.returncode is not None
    writer.abandon()  # and once more, from an outer handler


def test_checkpoints_of_a_run_are_written_in_order_and_one_is_kept_in_reserve(tmp_path):
    writer = started(tmp_path)
    for k in range(4):
        writer.checkpoint({"a": np.array(k)})
    finish(writer)
    kept = [int(np.load(tmp_path / name)["a"]) for name in ("checkpoint.npz", "checkpoint.previous.npz")]
    assert kept == [3, 2]
    assert writer.cpu_s > 0.0 and writer.warning == ""


def test_nothing_is_written_into_a_folder_whose_lock_names_another(tmp_path):
    """The order was given before the lock was removed and another took it."""
    writer = started(tmp_path)
    writer.ready()
    (tmp_path / lock.FILE).write_text("process 1 since 2026-01-01 00:00:00\n")
    before = sorted(path.name for path in tmp_path.rglob("*"))
    with pytest.raises(SceneError, match="its lock was removed during the run, and another has it"):
        writer.checkpoint({"a": np.zeros(3)})
        finish(writer)
    assert sorted(path.name for path in tmp_path.rglob("*")) == before
