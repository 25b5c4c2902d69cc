"""What `--check` says of memory, disk and time, held to real runs: within 30 %."""

import subprocess
import sys
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.run.forecast import CHECKPOINTS, FILMED, disk, disk_said, solving_time
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.spec.review.memory import memory

BLOCK = Path(__file__).resolve().parents[1] / "block_3d.py"

RUNS = {
    "paper": ("cube", {"dx": 1e-3, "flaw_width": 3e-3, "time_scale": 16.0}, 60),
    "elastic": ("intact", {"dx": 0.5e-3, "rock.criterion": "Unbreakable"}, 30),
    "directional": ("cube_lab", {"dx": 1e-3, "length": 2e-3}, 60),
    "hat": ("cube", {"dx": 0.5e-3, "flaw_width": 1.5e-3, "shape": "Linear"}, 30),
    "3d": (str(BLOCK), {}, 10),
}
"""Scene, settings and steps: from some 20 000 to 80 000 particles."""

WIDE = {"dx": 1e-3, "flaw_width": 3e-3, "time_scale": 16.0, "domain.lower": "-2,0", "domain.upper": "2,1"}
LARGE = RUNS | {
    "fine": ("cube", {"dx": 0.25e-3, "flaw_width": 0.75e-3, "time_scale": 16.0}, 20),
    "many nodes": ("cube", WIDE, 20),
    "sparse": ("cube", WIDE | {"domain.grid": "sparse"}, 20),
    "huge sparse": ("cube", WIDE | {"domain.grid": "sparse", "domain.lower": "-20,0", "domain.upper": "20,20"}, 10),
}
"""The same with memory of other kinds."""

LARGEST = """
import resource, sys
from rsmpm_ti import load_scene, simulate
name, settings, steps, out = eval(sys.argv[1])
scene = load_scene(name, settings=settings)
settings |= {"strain_end": None, "schedule.strain_end": None, "t_end": steps * scene.dt, "schedule.rows": 5}
settings |= {"output.frames": 2, "output.vtu": 1}
settings.pop("strain_end")
simulate(load_scene(name, settings=settings), out=out, threads=1)
# not getrusage, which counts what the process had that started this one
print(next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM")))
print(resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss)
"""
"""Run, and print the largest resident memory of this process, which solves, and of the one that paints [KiB on
Linux]."""


@pytest.mark.skipif(sys.platform != "linux", reason="memory is counted in other units elsewhere")
@pytest.mark.parametrize(
    "name", [n if n == "directional" else pytest.param(n, marks=pytest.mark.validation) for n in LARGE]
)
@pytest.mark.thorough
def test_memory_is_what_a_run_takes_at_its_largest(tmp_path, name):
    scene_name, settings, steps = LARGE[name]
    wanted = repr((scene_name, settings, steps, str(tmp_path)))
    done = subprocess.run([sys.executable, "-c", LARGEST, wanted], capture_output=True, text=True, timeout=500)
    assert done.returncode == 0, done.stderr
    scene = load_scene(scene_name, settings=settings)
    count = sum(len(body.x) for body in scene.particles())
    solved, painted = (1024.0 * int(size) for size in done.stdout.split()[-2:])
    assert memory(scene, count) == (pytest.approx(solved, rel=0.3), pytest.approx(painted, rel=0.3))


WHOLE = {
    "paper": ("cube", {"dx": 1e-3, "flaw_width": 3e-3, "time_scale": 16.0, "shape": "Linear"}),
    "directional": ("cube_lab", {"dx": 1e-3, "length": 2e-3, "loading.time_scale": 100.0}),
}


@pytest.mark.validation
@pytest.mark.parametrize("name", WHOLE)
def test_disk_is_what_a_run_takes(tmp_path, name):
    """Of pictures as many as there are: some more come where much fails."""
    scene_name, settings = WHOLE[name]
    scene = load_scene(scene_name, settings=settings)
    scene = replace(scene, output=replace(scene.output, frames=5, vtu=5))
    result = simulate(scene, out=tmp_path, threads=1)
    sizes = {kind: [path.stat().st_size for path in tmp_path.glob(kind)] for kind in ("frames/*", "*.vtu", "*.npz")}
    pictures, files, checkpoints = disk(scene, result.summary["particles"])
    film = FILMED * 6
    assert (pictures - film) / 12 == pytest.approx(np.mean(sizes["frames/*"]), rel=0.3)
    assert files == pytest.approx(sum(sizes["*.vtu"]), rel=0.3)
    assert checkpoints / CHECKPOINTS == pytest.approx(max(sizes["*.npz"]), rel=0.3)


@pytest.mark.validation
@pytest.mark.parametrize("name", RUNS)
def test_time_is_what_steps_take_before_much_has_cracked(name):
    """In processor time, which other programs on this machine change less; the best of three."""
    scene_name, settings, steps = RUNS[name]
    scene = load_scene(scene_name, settings=settings)
    scene = replace(scene, schedule=replace(scene.schedule, strain_end=None, t_end=steps * scene.dt))
    real, gpu = start_taichi("f64", "cpu", 1)
    drive = Drive(scene, scene.particles(), real, gpu)
    drive.advance(2)
    best = float("inf")
    for _ in range(3):
        start = time.process_time()
        drive.advance((steps - 2) // 3)
        drive.sim.particles.u.to_numpy()  # which waits for the steps
        best = min(best, (time.process_time() - start) / ((steps - 2) // 3) * steps)
    assert solving_time(scene, drive.sim.particles.count, 1) == pytest.approx(best, rel=0.3)


def test_time_grows_with_the_work_and_falls_with_threads():
    scene = load_scene("cube", quick=True)
    one = solving_time(scene, 20_000, 1)
    assert solving_time(scene, 40_000, 1) == pytest.approx(2.0 * one, rel=0.3)  # each timed anew
    assert solving_time(scene, 20_000, 2) < 0.8 * one


def test_a_disk_with_less_is_said(tmp_path, monkeypatch):
    scene = load_scene("cube", quick=True)
    assert disk_said(scene, 16_000, tmp_path) == []
    monkeypatch.setattr("rsmpm_ti.run.forecast.free_disk", lambda folder: 1e6)
    (said,) = disk_said(scene, 16_000, tmp_path)
    assert str(tmp_path) in said and "1 MB left" in said and "make room" in said
