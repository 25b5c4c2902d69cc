"""Painter, encoder, disk or user fail while a run is under way: the cause in one line, the tables, and no hang."""

import json
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from rsmpm_ti.output.files import CHECKPOINTS

ROOT = Path(__file__).resolve().parents[2]
SMALL = [
    sys.executable, "-m", "rsmpm_ti.scene", "cube", "--set", "dx=0.002", "--set", "flaw_width=0.006", "--set",
    "shape=Linear", "--set", "bodies.0.seeding=Lattice", "--set", "time_scale=16", "--set", "schedule.rows=60",
    "--frames", "3", "--set", "output.vtu=2", "--threads", "1",
]  # fmt: skip
SLOW = ["--set", "schedule.cfl=0.002", "--frames", "60", "--set", "output.vtu=0"]
"""Some minute of steps, and a frame each sixtieth of them."""

TABLES = {"history.csv", "reactions.csv", "events.csv", "summary.json"}


def started(out: Path, *more: str, env: dict | None = None, **popen) -> subprocess.Popen:
    environment = os.environ | {"PYTHONPATH": str(ROOT)} | (env or {})
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "env": environment, "cwd": ROOT}
    return subprocess.Popen([*SMALL, *more, "--out", str(out)], **pipes, **popen)


def painter_of(run: subprocess.Popen) -> int:
    """Process id of its painter, as soon as it has painted."""
    children = Path(f"/proc/{run.pid}/task/{run.pid}/children")
    return int(children.read_text().split()[0])


def wait_for(path: Path, run: subprocess.Popen) -> None:
    until = time.monotonic() + 60.0
    while not path.exists():
        assert run.poll() is None and time.monotonic() < until, run.communicate()
        time.sleep(0.02)


def ended(run: subprocess.Popen, status: int) -> tuple[str, str]:
    """What it said; within a minute, without a traceback, and leaving nobody behind."""
    out, err = run.communicate(timeout=60)
    assert run.returncode == status, err
    assert "Traceback" not in err + out
    return out, err


def one_line(err: str) -> str:
    said = [line for line in err.splitlines() if not line.startswith("rsmpm_ti: warning")]
    assert len(said) == 1 and said[0].startswith("rsmpm_ti: "), err
    return said[0]


def unfinished(out: Path) -> list[Path]:
    return [path for path in out.rglob("*") if ".part" in path.name]


linux = pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds a run's painter by Linux's /proc")


@linux
@pytest.mark.validation
def test_killed_painter_costs_pictures_and_nothing_else(tmp_path):
    run = started(tmp_path, *SLOW, "--checkpoint-every", "1000")
    wait_for(tmp_path / "frames" / "stress_0002.png", run)
    os.kill(painter_of(run), signal.SIGKILL)
    line = one_line(ended(run, 2)[1])
    assert "ended with status -9" in line and "go on with --resume" in line
    assert {path.name for path in tmp_path.iterdir()} >= TABLES | {"cracks.csv", CHECKPOINTS[0]}
    assert "ended with status -9" in json.loads((tmp_path / "summary.json").read_text())["stopped"]
    rows = np.genfromtxt(tmp_path / "history.csv", delimiter=",", names=True)
    resumed = started(tmp_path, *SLOW, "--resume", "--set", "strain_end=1e-4")
    ended(resumed, 0)
    again = np.genfromtxt(tmp_path / "history.csv", delimiter=",", names=True)
    assert len(again) > len(rows) and np.array_equal(again[: len(rows)], rows)


@linux
@pytest.mark.thorough
def test_stopped_painter_ends_with_the_run_at_a_second_signal(tmp_path):
    run = started(tmp_path, *SLOW)
    wait_for(tmp_path / "frames" / "stress_0002.png", run)
    painter = painter_of(run)
    os.kill(painter, signal.SIGSTOP)
    for _ in range(2):
        run.send_signal(signal.SIGINT)
        time.sleep(1.0)
    out, err = ended(run, 130)
    assert err == "" and "given up at a second signal" in out
    assert {path.name for path in tmp_path.iterdir()} >= TABLES | {CHECKPOINTS[0]}
    with pytest.raises(ProcessLookupError):
        os.kill(painter, 0)


@pytest.mark.parametrize(
    "number, status", [(signal.SIGHUP, 129), pytest.param(signal.SIGTERM, 143, marks=pytest.mark.validation)]
)
def test_signal_stops_a_run_which_writes_what_there_is(tmp_path, number, status):
    run = started(tmp_path, *SLOW)
    wait_for(tmp_path / "frames" / "stress_0002.png", run)
    run.send_signal(number)
    out, err = ended(run, status)
    assert err == "" and "go on with --resume" in out
    assert {path.name for path in tmp_path.iterdir()} >= TABLES | {CHECKPOINTS[0], "summary.png", "cube.mp4"}


@pytest.mark.validation
def test_signal_that_was_ignored_before_is_ignored(tmp_path):
    run = started(tmp_path, preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    wait_for(tmp_path / "frames" / "stress_0000.png", run)
    run.send_signal(signal.SIGHUP)
    ended(run, 0)


@pytest.mark.parametrize("after", [1.0, *(pytest.param(t, marks=pytest.mark.validation) for t in (2.0, 4.0))])
def test_ctrl_c_during_start_up_is_one_line(tmp_path, after):
    run = started(tmp_path / "out")
    time.sleep(after)
    run.send_signal(signal.SIGINT)
    out, err = run.communicate(timeout=60)
    if "runpy" in err or run.returncode == -signal.SIGINT:
        pytest.skip("Python itself was starting")
    assert run.returncode == 130 and "Traceback" not in err + out, err


ENCODERS = {
    "missing": None,
    "false": "exit 1",
    "hanging": "sleep 1000",
    "hanging at its end": "cat > /dev/null; sleep 1000",
    "ending well without a file": "cat > /dev/null; exit 0",
}


@pytest.mark.parametrize(
    "kind", ["false", *(pytest.param(kind, marks=pytest.mark.validation) for kind in ENCODERS if kind != "false")]
)
@pytest.mark.thorough
def test_encoder_that_fails_costs_the_movie_and_a_warning(tmp_path, kind):
    program = tmp_path / "ffmpeg"
    if ENCODERS[kind] is not None:
        program.write_text(f"#!/bin/sh\n{ENCODERS[kind]}\n")
        program.chmod(0o755)
    run = started(tmp_path / "out", env={"IMAGEIO_FFMPEG_EXE": str(program)})
    out, err = ended(run, 0)
    assert err == "" and "warning: no movie is written: " in out
    assert "no movie is written" in " ".join(json.loads((tmp_path / "out" / "summary.json").read_text())["warnings"])
    assert not unfinished(tmp_path / "out") and not list((tmp_path / "out").glob("*.mp4"))


STARVED = [("RLIMIT_FSIZE", 300_000), ("RLIMIT_NOFILE", 20), ("RLIMIT_NOFILE", 8), ("RLIMIT_AS", 2_000_000_000)]


@pytest.mark.parametrize(
    "limit, most",
    [
        ("RLIMIT_FSIZE", 50_000),
        ("RLIMIT_NOFILE", 14),
        *(pytest.param(*entry, marks=pytest.mark.validation) for entry in STARVED),
    ],
)
@pytest.mark.thorough
def test_starved_run_says_so_in_one_line(tmp_path, limit, most):
    kind = getattr(resource, limit)

    def starve() -> None:
        resource.setrlimit(kind, (most, resource.getrlimit(kind)[1]))

    run = started(tmp_path, preexec_fn=starve)
    out, err = run.communicate(timeout=60)
    assert "Traceback" not in err + out and not unfinished(tmp_path)
    if run.returncode != 0:
        assert run.returncode == 2
        one_line("".join(line for line in err.splitlines(True) if line.strip() and not line.startswith("[E ")))
