"""Runs that are stopped, in every way, and go on: the same files as of one that never stopped."""

import json
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from rsmpm_ti import load_result
from rsmpm_ti.errors import RockWarning, SceneError
from rsmpm_ti.output import manifest
from rsmpm_ti.output.files import CHECKPOINTS, write_checkpoint
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.records.progress import Progress
from rsmpm_ti.run import checkpoint
from rsmpm_ti.run.run import simulate
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.scene import build, main, parser

RUN = [
    "cube",
    "--set",
    "dx=0.002",
    "--set",
    "flaw_width=0.006",
    "--set",
    "time_scale=16",
    "--set",
    "shape=Linear",
    "--set",
    "schedule.rows=60",
    "--frames",
    "4",
    "--set",
    "output.vtu=2",
    "--set",
    "schedule.adaptive=true",
    "--threads",
    "1",
    "--checkpoint-every",
    "0",
]
"""Failures from a third of its strain on; Linear compiles fastest. Steps that adapt have the longer memory."""


def files(folder: Path) -> dict[str, bytes]:
    """Every file of a run that tells neither the time of day nor which run it is of."""
    timed = {"summary.json", manifest.FILE, *CHECKPOINTS}
    return {
        str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file() and p.name not in timed
    }


def physics(folder: Path) -> dict:
    timed = {"wall_s", "compile_s", "painting_s", "painting_cpu_s", "particle_steps_per_s"}
    return {k: v for k, v in json.loads((folder / "summary.json").read_text()).items() if k not in timed}


def final_state(folder: Path) -> dict[str, np.ndarray]:
    with np.load(folder / CHECKPOINTS[0], allow_pickle=False) as file:
        return {key: file[key] for key in file.files if key != "text"}


@pytest.fixture(scope="module")
def whole(tmp_path_factory) -> Path:
    """A run that nobody stops."""
    out = tmp_path_factory.mktemp("whole")
    assert main([*RUN, "--out", str(out)]) == 0
    return out


def assert_same_run(folder: Path, whole: Path) -> None:
    mine, theirs = files(folder), files(whole)
    assert sorted(mine) == sorted(theirs), "no gap, no leftover"
    assert [name for name in mine if mine[name] != theirs[name]] == []
    assert physics(folder) == physics(whole)
    one, other = final_state(folder), final_state(whole)
    assert all(np.array_equal(one[key], other[key], equal_nan=True) for key in one), "bit for bit on one thread"


@pytest.mark.parametrize("kills", [3, pytest.param(20, marks=pytest.mark.validation)])
@pytest.mark.thorough("3")
def test_killed_again_and_again_it_ends_with_the_same_files(whole, tmp_path, kills):
    """SIGKILL at random times, start-up included: whatever was under way is done again, not lost and not doubled."""
    dice, command = random.Random(1), [sys.executable, "-m", "rsmpm_ti.scene", *RUN, "--out", str(tmp_path), "--resume"]
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    running = 0
    for _ in range(kills):
        run = subprocess.Popen(command, **quiet)
        before = checkpoint_time(tmp_path)
        while run.poll() is None and checkpoint_time(tmp_path) == before:  # until it runs, however long that takes
            time.sleep(0.02)
        time.sleep(dice.uniform(0.0, 0.6))
        running += run.poll() is None
        run.send_signal(signal.SIGKILL)
        run.wait()
    assert running >= 0.8 * kills, "it was killed while it ran"
    assert subprocess.run(command, **quiet, timeout=300).returncode == 0
    assert_same_run(tmp_path, whole)


def checkpoint_time(folder: Path) -> float:
    try:
        return (folder / CHECKPOINTS[0]).stat().st_mtime
    except FileNotFoundError:  # not yet, or just being replaced
        return 0.0


@pytest.mark.thorough
def test_ctrl_c_and_sigterm_write_what_there_is_and_resume_goes_on(whole, tmp_path):
    scene, stops = build(parser().parse_args(RUN)), {0.3: signal.SIGINT, 0.6: signal.SIGTERM}
    for fraction, number in stops.items():

        def stop(progress: Progress, fraction=fraction, number=number) -> None:
            if progress.fraction > fraction:
                os.kill(os.getpid(), number)

        result = simulate(scene, out=tmp_path, name="cube", threads=1, resume=True, progress=stop)
        assert result.stopped.startswith("interrupted after step")
        assert fraction < result.history["axial_strain"][-1] / 2.5e-4 < fraction + 0.05
        assert json.loads((tmp_path / "summary.json").read_text())["stopped"] == result.stopped
        assert (tmp_path / "history.csv").exists() and (tmp_path / "cube.mp4").exists()
    assert main([*RUN, "--out", str(tmp_path), "--resume"]) == 0
    assert_same_run(tmp_path, whole)


def read(folder: Path):
    """The checkpoint from which RUN would go on in a folder."""
    scene = build(parser().parse_args(RUN))
    return checkpoint.read(folder, scene, scene.particles(), Settings(threads=1))


def damage(path: Path, how: str) -> None:
    data = path.read_bytes()
    if how == "truncated":
        path.write_bytes(data[: len(data) // 2])
    elif how == "flipped":
        middle = len(data) // 3
        path.write_bytes(data[:middle] + bytes([data[middle] ^ 0xFF]) + data[middle + 1 :])
    else:
        path.write_bytes(b"")


@pytest.mark.parametrize("how", ["truncated", "flipped", "emptied"])
def test_a_damaged_checkpoint_is_passed_over_for_the_one_before(whole, tmp_path, how):
    for name in CHECKPOINTS:
        shutil.copy(whole / name, tmp_path / name)
    with np.load(whole / CHECKPOINTS[0]) as latest, np.load(whole / CHECKPOINTS[1]) as previous:
        assert latest["clock_step"] >= previous["clock_step"]
        rows = len(previous["history"])
    damage(tmp_path / CHECKPOINTS[0], how)
    with pytest.warns(RockWarning, match=r"checkpoint.npz is damaged .*; the run goes on from checkpoint.previous.npz"):
        assert len(read(tmp_path)["history"]) == rows
    damage(tmp_path / CHECKPOINTS[1], how)
    with pytest.raises(SceneError, match="damaged .* start anew"):
        read(tmp_path)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (["--set", "flaw_angle=44"], r"scene\.bodies\[0\]\.region\.removed\[0\]\.angle is 45\.0 there and 44\.0 here"),
        (["--precision", "f32"], "precision is 'f64' there and 'f32' here"),
        (["--set", "schedule.cfl=0.3"], r"scene\.schedule\.cfl is .* there and 0\.3 here"),
    ],
)
def test_a_checkpoint_of_another_run_is_refused_with_the_difference(whole, capsys, change, named):
    before = files(whole)
    assert main([*RUN, *change, "--out", str(whole), "--resume"]) == 2
    words = capsys.readouterr().err
    assert re.search(named, words) and len(words.splitlines()) == 1
    assert files(whole) == before, "nothing was touched"


def test_a_checkpoint_of_another_version_is_refused(whole, tmp_path):
    with np.load(whole / CHECKPOINTS[0]) as file:
        arrays = {key: file[key] for key in file.files}
    text = json.loads(str(arrays["text"]))
    text["identity"]["rsmpm_ti"] = "0.0.1"
    write_checkpoint(tmp_path, arrays | {"text": np.array(json.dumps(text))})
    with pytest.raises(SceneError, match="rsmpm_ti is '0.0.1' there"):
        read(tmp_path)


def test_loading_a_checkpoint_runs_nobodys_code(tmp_path):
    class Trap:
        def __reduce__(self):
            return (Path.touch, (tmp_path / "sprung",))

    np.savez(tmp_path / CHECKPOINTS[0], text=np.array([Trap()], dtype=object))
    with pytest.raises(SceneError, match="damaged"):
        read(tmp_path)
    assert not (tmp_path / "sprung").exists()


def test_without_a_checkpoint_resume_starts_from_the_start(tmp_path):
    assert read(tmp_path) is None


ELASTIC = ["intact", "--elastic", "--set", "dx=0.01", "--set", "shape=Linear", "--threads", "1", "--no-movie"]


def ran(folder: Path, *options: str) -> dict:
    assert main([*ELASTIC, *options, "--out", str(folder)]) == 0
    return json.loads((folder / "summary.json").read_text())


def names(folder: Path, pattern: str) -> list[str]:
    return sorted(path.name for path in folder.glob(pattern))


def strain_of(checkpoint) -> float:
    """How far the platens of `cube`, 100 mm apart, have come closer."""
    lower, upper = checkpoint["grid_travel"][1]
    return float(lower - upper) / 0.1


@pytest.mark.parametrize("adaptive", ["false", "true"])
@pytest.mark.thorough("true", "false")
def test_a_run_that_is_done_goes_on_to_a_later_end_as_if_it_had_been_asked_for(tmp_path, adaptive):
    """With other rows and other output too: the same steps, but where they are cut to end in time (adaptive ones)."""
    steps = ("--set", f"schedule.adaptive={adaptive}")
    ran(tmp_path / "a", *steps, "--set", "strain_end=1e-4", "--set", "schedule.rows=10", "--frames", "2")
    more = (*steps, "--set", "strain_end=2e-4", "--set", "schedule.rows=40", "--frames", "4", "--set", "output.vtu=4")
    summaries = [ran(tmp_path / "a", *more, "--resume"), ran(tmp_path / "b", *more)]
    stored = [final_state(tmp_path / k)["history"][-1, HISTORY_COLUMNS.index("energy_elastic_J")] for k in "ab"]
    # an adaptive step more or less, of 210, is 1e-5 of the strain where the specimen has swung
    assert stored[0] == pytest.approx(stored[1], rel=1e-9 if adaptive == "false" else 1e-4)
    assert abs(summaries[0]["steps"] - summaries[1]["steps"]) <= (
        3 if adaptive == "true" else 0
    )  # one at the old end, one per row
    one, other = final_state(tmp_path / "a"), final_state(tmp_path / "b")
    assert strain_of(one) == pytest.approx(2e-4, rel=5e-3)  # a step of 200 more, since steps are whole
    assert strain_of(one) == pytest.approx(strain_of(other), rel=1e-9)
    rows = np.diff(one["history"][:, 0])
    assert (rows > 0.0).all() and len(rows) > 25, "half of the run at 10 rows for it, half at 40 for the whole"
    # before: 0, 1/2 and 1 of half the run; after: 3/4 and all of the whole
    assert names(tmp_path / "a", "frames/stress_*.png") == [f"stress_{k:04d}.png" for k in range(5)]
    strains = load_result(tmp_path / "a").frames["axial_strain"]
    assert strains == pytest.approx([np.nan, 5e-5, 1e-4, 1.5e-4, 2e-4], abs=1e-5, nan_ok=True)  # within a row
    assert json.loads((tmp_path / "a" / "scene.json").read_text())["scene"]["schedule"]["strain_end"] == 2e-4


@pytest.mark.thorough
def test_output_may_be_asked_for_after_the_end(tmp_path):
    first = ran(tmp_path, "--set", "strain_end=1e-4", "--frames", "0", "--set", "output.vtu=0")
    assert names(tmp_path, "frames/*") == names(tmp_path, "*.vtu") == []
    again = ran(tmp_path, "--set", "strain_end=1e-4", "--frames", "3", "--set", "output.vtu=2", "--resume")
    assert names(tmp_path, "frames/stress*") == ["stress_0000.png"] and names(tmp_path, "*.vtu") == [
        "particles_0000.vtu"
    ]
    assert again["steps"] == first["steps"] and again["peak_stress_Pa"] == first["peak_stress_Pa"]


@pytest.mark.thorough
def test_an_end_by_time_takes_the_place_of_one_by_strain(tmp_path):
    ran(tmp_path, "--set", "strain_end=1e-4", "--frames", "0")
    summary = ran(tmp_path, "--set", "strain_end=none", "--set", "t_end=3ms", "--frames", "0", "--resume")
    assert summary["steps"] * summary["dt_s"] == pytest.approx(3e-3, rel=1e-2)


def test_an_end_that_is_past_is_refused_and_so_is_any_other_change(tmp_path, capsys):
    ran(tmp_path, "--set", "strain_end=1e-4", "--frames", "0")
    before = files(tmp_path)
    changes = {
        "strain_end=5e-5": r"schedule.strain_end = 5e-05 is refused: .*ends after t = 0\.002",
        "time_scale=12": r"time_scale is 10\.0 there and 12\.0 here",
        "rock.elasticity.nu=0.2": r"scene\.rock\.elasticity\.nu is 0\.14 there",
        "loading.quasi_static=0.02": r"scene\.loading\.quasi_static",
    }
    for change, named in changes.items():
        capsys.readouterr()
        wanted = [] if "strain_end" in change else ["--set", "strain_end=1e-4"]
        assert main([*ELASTIC, *wanted, "--set", change, "--frames", "0", "--out", str(tmp_path), "--resume"]) == 2
        assert re.search(named, capsys.readouterr().err)
    assert files(tmp_path) == before, "nothing was touched"
