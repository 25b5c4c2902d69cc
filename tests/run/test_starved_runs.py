"""A hundred runs that are killed or starved, by random means at random moments: nothing hangs, lies or does harm."""

import contextlib
import json
import os
import random
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import meshio
import pytest
from PIL import Image

from rsmpm_ti.output import manifest

ROOT = Path(__file__).resolve().parents[2]
RUN = [
    sys.executable, "-m", "rsmpm_ti.scene", "cube", "--set", "dx=0.002", "--set", "flaw_width=0.006", "--set",
    "shape=Linear", "--set", "bodies.0.seeding=Lattice", "--set", "time_scale=16", "--set", "schedule.rows=60",
    "--set", "schedule.cfl=0.05", "--set", "output.vtu=2", "--frames", "3", "--threads", "1", "--checkpoint-every",
    "0.3",
]  # fmt: skip
LASTS_S = 12.0
"""Of such a run, start-up included, on one of two cores."""

YOURS = (
    "checkpoint_mine.npz", "frames/photo_0001.png", "frames/stress_0001_small.png", "particles_0099.vtu",
    ".notes.part1", ".writable", "frames/.thumbs.part.png", "notes.txt", "../beside.txt",
)  # fmt: skip
"""Files that no run has made."""

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(not Path("/proc/self/task").exists(), reason="finds the processes of a run by Linux's /proc"),
]


def started(out: Path, *more: str, limits=(), env=None) -> subprocess.Popen:
    def starve() -> None:
        for kind, most in limits:
            resource.setrlimit(kind, (most, most))

    environment = os.environ | {"PYTHONPATH": str(ROOT)} | (env or {})
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True, "cwd": ROOT}
    return subprocess.Popen([*RUN, *more, "--out", str(out)], env=environment, preexec_fn=starve, **pipes)


def children(process: int) -> list[int]:
    """Process ids, those of children's children last."""
    found: list[int] = []
    with contextlib.suppress(OSError):
        for task in Path(f"/proc/{process}/task").iterdir():
            found += map(int, (task / "children").read_text().split())
    return found + [grandchild for child in found for grandchild in children(child)]


def send(process: int, number: int) -> None:
    with contextlib.suppress(ProcessLookupError):
        os.kill(process, number)


def harm(run: subprocess.Popen, dice: random.Random) -> str:
    """Signals to the solver, its painter, or the encoder; what was done."""
    whom = dice.choice(["solver", "painter", "encoder", "encoder"])
    kin = [run.pid, *children(run.pid)]
    process = kin[min(["solver", "painter", "encoder"].index(whom), len(kin) - 1)]
    numbers = ["SIGKILL", "SIGTERM", "SIGINT", "SIGHUP", "twice", "paused"] if process == run.pid else []
    number = dice.choice(numbers or ["SIGKILL", "SIGTERM", "SIGSEGV", "SIGSTOP"])
    if number == "twice":
        for _ in range(2):
            send(process, signal.SIGINT)
            time.sleep(dice.uniform(0.0, 0.5))
    elif number == "paused":
        send(process, signal.SIGSTOP)
        time.sleep(1.0)
        send(process, signal.SIGCONT)
    else:
        send(process, getattr(signal, number))
    return f"{whom} {number}"


LIMITS = {
    resource.RLIMIT_FSIZE: lambda dice: int(10 ** dice.uniform(3.5, 6.5)),
    resource.RLIMIT_NOFILE: lambda dice: dice.randint(8, 40),
    resource.RLIMIT_AS: lambda dice: int(dice.uniform(1.5e9, 3.5e9)),
}


@contextlib.contextmanager
def small_disk(folder: Path, size: int):
    """A disk of so many bytes there; only root can have one."""
    done = subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={size}", "tmpfs", str(folder)], capture_output=True)
    if done.returncode:
        pytest.skip("no small disk can be mounted")
    try:
        yield
    finally:
        subprocess.run(["umount", "-l", str(folder)], check=True)


def yours(out: Path) -> dict[str, bytes]:
    for name in YOURS:
        (out / name).parent.mkdir(parents=True, exist_ok=True)
        (out / name).write_bytes(name.encode())
    return {name: name.encode() for name in YOURS}


def check(out: Path, status: int, said: str, mine: dict[str, bytes]) -> None:
    assert "Traceback" not in said, said
    assert {name: (out / name).read_bytes() for name in mine} == mine
    if status != 0:
        return
    summary = json.loads((out / "summary.json").read_text())
    assert not summary["stopped"]
    if not summary["complete"]:  # a painter that died has taken frames along, and that is said
        assert any("cannot be made again" in sentence for sentence in summary["warnings"])
        return
    names = manifest.read(out).names
    parts = [path.name for path in out.rglob("*") if ".part" in path.name and path.name not in " ".join(mine)]
    assert not parts
    assert set(names) >= {f"frames/{kind}_{k:04d}.png" for kind in ("stress", "cracks") for k in range(4)}
    assert set(names) >= {f"particles_{k:04d}.vtu" for k in range(3)} | {"history.csv", "summary.png", "checkpoint.npz"}
    for name in names:
        if name.endswith(".mp4") and any("no movie is written" in sentence for sentence in summary["warnings"]):
            continue
        assert (out / name).stat().st_size > 0
        if name.endswith(".png"):
            with Image.open(out / name) as picture:
                picture.load()
        if name.endswith(".vtu"):
            meshio.read(out / name)


def ended(run: subprocess.Popen, within: float) -> str:
    try:
        out, err = run.communicate(timeout=within)
    except subprocess.TimeoutExpired:
        for process in (run.pid, *children(run.pid)):
            send(process, signal.SIGKILL)
        raise
    return out + err


@pytest.mark.parametrize("seed", range(100))
def test_a_run_that_is_harmed(tmp_path, seed):
    dice = random.Random(seed)
    out = tmp_path / "out"
    out.mkdir()
    with contextlib.ExitStack() as disk:
        limits, means = [], dice.choice(["signal"] * 6 + ["limit"] * 3 + ["disk"])
        if means == "disk":
            disk.enter_context(small_disk(out, int(10 ** dice.uniform(4.8, 7.0))))
        mine = yours(out)
        if means == "limit":
            kind = dice.choice(list(LIMITS))
            limits = [(kind, LIMITS[kind](dice))]
        run = started(out, limits=limits)
        if means == "signal":
            with contextlib.suppress(subprocess.TimeoutExpired):
                run.wait(dice.uniform(1.0, LASTS_S))
            means = harm(run, dice)
        said = ended(run, 60.0 + LASTS_S)
        print(means, limits, run.returncode, said)
        check(out, run.returncode, said, mine)
        if dice.random() < 0.3 and not limits:
            again = started(out, dice.choice(["--resume", "--overwrite"]))
            said = ended(again, 60.0 + LASTS_S)
            print(again.args, again.returncode, said)
            check(out, again.returncode, said, mine)
            assert again.returncode == 0 or means == "disk"


@pytest.mark.parametrize("seed", range(5))
def test_two_runs_in_one_folder(tmp_path, seed):
    dice = random.Random(seed)
    out = tmp_path / "out"
    out.mkdir()
    mine = yours(out)
    first = started(out)
    time.sleep(dice.uniform(0.0, 2.0))
    second = started(out)
    said = [ended(run, 60.0 + LASTS_S) for run in (first, second)]
    statuses = [first.returncode, second.returncode]
    assert sorted(statuses) == [0, 2], said
    refused = said[statuses.index(2)]
    assert "into which no other run writes" in refused or "a folder without a run" in refused
    check(out, 0, "".join(said), mine)
