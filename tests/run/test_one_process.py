"""Runs in a process that does other things too: forks, threads, callbacks, Taichi fields of the user."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.thorough

ROOT = Path(__file__).resolve().parents[2]

SCRIPT = """
import json, multiprocessing, threading
import taichi as ti
from rsmpm_ti import load_scene, simulate

scene = load_scene("intact", dx=0.01, settings={"t_end": "1e-5", "strain_end": "none", "time_scale": "1"})
said = {}


def refused(name, run=lambda: simulate(scene, threads=1)):
    try:
        run()
        said[name] = "ran"
    except Exception as error:
        said[name] = f"{type(error).__name__}: {error}"


def ask(progress):
    if "callback" not in said:
        thread = threading.Thread(target=refused, args=("thread",))
        thread.start()
        thread.join()
        refused("callback")


if __name__ == "__main__":
    ti.init(arch=ti.cpu, log_level=ti.ERROR)
    own = ti.field(ti.f32, 3)
    own.fill(2.0)
    refused("own fields")
    said["own"] = float(own[1])
    ti.reset()
    refused("after reset")
    refused("asks", lambda: simulate(scene, threads=1, progress=ask))
    later = ti.field(ti.f32, 3)
    refused("once more")
    refused("later", lambda: later[0])
    refused("later whole", lambda: later.to_numpy())
    with multiprocessing.get_context("fork").Pool(1) as pool:
        refused("fork", lambda: pool.apply_async(simulate, (scene,)).get(timeout=20))
    print(json.dumps(said))
"""


@pytest.fixture(scope="module")
def said(tmp_path_factory):
    script = tmp_path_factory.mktemp("script") / "script.py"
    script.write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, str(script)], env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True, text=True,
        timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr[-2000:]
    return json.loads(done.stdout.splitlines()[-1])


def test_a_run_in_a_fork_of_a_process_that_ran_is_refused(said):
    assert said["fork"].startswith("SceneError: this process is the fork of one in which Taichi ran")


@pytest.mark.parametrize("place", ["thread", "callback"])
def test_a_second_run_at_the_same_time_is_refused_and_the_first_goes_on(said, place):
    assert said[place].startswith("SceneError: a run is under way in this process")
    assert said["asks"] == said["once more"] == "ran"


def test_fields_of_a_user_are_not_freed_by_a_run(said):
    assert said["own fields"].startswith("SceneError: Taichi holds fields of your own in this process")
    assert (said["own"], said["after reset"]) == (2.0, "ran")


@pytest.mark.parametrize("use", ["later", "later whole"])
def test_fields_made_after_a_run_raise_when_another_has_freed_them(said, use):
    assert said[use].startswith("RuntimeError: this Taichi field is gone")


FORK = """
import multiprocessing, sys
import taichi as ti
{before}
scene = 'load_scene("intact", dx=0.01, settings={{"t_end": "1e-5", "strain_end": "none", "time_scale": "1"}})'


def child():
    from rsmpm_ti import load_scene, simulate
    try:
        simulate(eval(scene))
    except Exception as error:
        print(type(error).__name__, error, flush=True)


if __name__ == "__main__":
    ti.init(arch=ti.cpu, cpu_max_num_threads=1, log_level=ti.ERROR)
    {then}
    process = multiprocessing.get_context("fork").Process(target=child)
    process.start()
    process.join(30)
    process.kill()
"""
USED = "ti.field(ti.f32, 3).fill(1.0)"


@pytest.mark.skipif(sys.platform != "linux", reason="threads of a process are counted by Linux's /proc")
@pytest.mark.parametrize("before, then", [("import rsmpm_ti", "pass"), ("", "pass"), ("", USED)])
def test_a_run_in_a_fork_of_a_process_that_started_taichi_itself_is_refused(tmp_path, before, then):
    """What is imported only in the child has not seen the fork."""
    (tmp_path / "script.py").write_text(FORK.format(before=before, then=then))
    done = subprocess.run(
        [sys.executable, "script.py"], cwd=tmp_path, env=os.environ | {"PYTHONPATH": str(ROOT)}, capture_output=True,
        text=True, timeout=60,
    )  # fmt: skip
    said = done.stdout.splitlines()[-1]
    assert said.startswith("SceneError this process is the fork of one in which Taichi ran"), done.stderr
