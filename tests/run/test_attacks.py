"""What an attacker found, each seen to fail: folders that change under a run, modules of the current one, ends of all
kinds."""

import json
import os
import shutil
import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import pytest
from small_scene import SPEED, make

from rsmpm_ti.cases.running import run_cases
from rsmpm_ti.errors import ObserverError, SceneError
from rsmpm_ti.output import manifest
from rsmpm_ti.output.files import CHECKPOINTS
from rsmpm_ti.output.folder import prepare
from rsmpm_ti.run.run import simulate
from rsmpm_ti.scene import main
from rsmpm_ti.spec.scene import Output

ROOT = Path(__file__).resolve().parents[2]
QUICK = replace(
    make(schedule={"t_end": 20 * 0.5e-3 / SPEED}, domain_dx=5e-3), output=Output(frames=1, movie=False, vtu=0)
)


def test_a_module_of_the_current_folder_is_not_run_by_the_painter(tmp_path):
    """`python -m` puts the whole name of the current folder into the search path."""
    (tmp_path / "PIL.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')\nraise ImportError('evil')\n")
    command = [
        sys.executable, "-m", "rsmpm_ti.scene", "cube", "--quick", "--set", "dx=2mm", "--set", "flaw_width=6mm",
        "--set", "strain_end=1e-5", "--set", "shape=Linear", "--threads", "1", "--frames", "1", "--out", "out",
    ]  # fmt: skip
    done = subprocess.run(
        command, cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0 and not (tmp_path / "ran").exists(), done.stderr


@pytest.mark.parametrize("ending", [SystemExit(0), GeneratorExit(), ValueError("x")], ids=repr)
def test_whatever_ends_a_users_function_the_tables_are_written(tmp_path, ending):
    def progress(_):
        raise ending

    with pytest.raises(ObserverError, match="progress failed"):
        simulate(QUICK, out=tmp_path, threads=1, progress=progress)
    assert {"history.csv", "summary.json", CHECKPOINTS[0]} <= {path.name for path in tmp_path.iterdir()}
    assert json.loads((tmp_path / "summary.json").read_text())["complete"] is False


def test_a_list_that_becomes_a_pipe_or_a_file_of_somebody_is_not_written_into(tmp_path):
    folder = prepare(QUICK, tmp_path)
    folder.begin()
    path = tmp_path / manifest.FILE
    for make_other in (lambda: os.mkfifo(path), lambda: path.write_text("mine")):
        path.unlink()
        make_other()
        start = time.monotonic()
        with pytest.raises(SceneError, match="no list of a run any more|cannot be written"):
            folder.claim("events.csv")
        assert time.monotonic() - start < 5.0
    assert path.read_text() == "mine"
    folder.release()


def test_a_part_of_somebodys_list_is_in_the_way(tmp_path):
    (tmp_path / ".manifest.part.txt").write_text("mine")
    with pytest.raises(SceneError, match="is in the way"):
        prepare(QUICK, tmp_path)
    assert (tmp_path / ".manifest.part.txt").read_text() == "mine"


def test_a_folder_that_took_the_place_of_the_runs_is_not_written_into(tmp_path):
    """The painter is behind the solver, and looks itself."""
    out, mine, deadline = tmp_path / "out", {}, time.monotonic() + 120.0

    def progress(_):
        if not mine:
            while not (out / "frames" / "cracks_0000.png").exists():  # the painter starts slowly on a busy machine
                time.sleep(0.05)
                assert time.monotonic() < deadline
            time.sleep(0.5)  # it has done what it was told to so far
            out.rename(tmp_path / "elsewhere")
            shutil.copytree(tmp_path / "elsewhere", out)
            for path in out.rglob("*"):
                if path.is_file():
                    path.write_text("mine")
                    mine[path] = "mine"
        time.sleep(0.05)

    scene = replace(QUICK, output=Output(frames=10, movie=False, vtu=0))
    scene = replace(scene, schedule=replace(scene.schedule, t_end=10.0 * scene.schedule.t_end, rows=60))
    with pytest.raises(SceneError, match="moved, removed or replaced"):
        simulate(scene, out=out, threads=1, progress=progress)
    assert mine and {path: path.read_text() for path in mine} == mine
    assert {path for path in out.rglob("*") if path.is_file()} == set(mine)


def test_a_case_whose_process_is_killed_breaks_alone(tmp_path):
    killed = run_cases("killed_case", ["kills"], False, tmp_path, 1, 1)
    (done,) = list(killed)
    assert done.rows == () and "ended with status -9" in done.problem


@pytest.mark.parametrize("out", [b"bytes", 5, True, 1.5])
def test_a_folder_is_named_by_a_path(out):
    with pytest.raises(SceneError, match="out = .* is refused: it must be the path of a folder"):
        simulate(QUICK, out=out)


@pytest.mark.parametrize("options", [("--threads", "0"), ("--threads", "9999"), ("--checkpoint-every", "nan")])
def test_a_check_refuses_what_a_run_refuses(capsys, options):
    assert main(["cube", "--quick", "--check", *options]) == 2
    assert "is refused" in capsys.readouterr().err


def test_a_painter_that_dies_after_the_last_row_is_told(tmp_path, monkeypatch):
    def killed(self, _):
        self._child.kill()
        self._wait(lambda: self._child.poll() is not None)
        self._end()

    monkeypatch.setattr("rsmpm_ti.output.writer.Writer.checkpoint", killed)
    with pytest.raises(SceneError, match="ended with status -9; what is complete is kept; go on with --resume"):
        simulate(QUICK, out=tmp_path, threads=1, checkpoint_every=1e6)
    assert json.loads((tmp_path / "summary.json").read_text())["complete"] is False
    assert (tmp_path / CHECKPOINTS[0]).exists()
