"""Memory over long runs, and over many runs in one process. Longer tier: some minutes."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = [
    pytest.mark.validation,
    pytest.mark.skipif(not Path("/proc/self/statm").exists(), reason="memory in use is read from Linux's /proc"),
]

GROWTH = 0.02
"""Most growth of memory in use. What is kept on purpose is far less: a history row is 88 bytes in 100 MB."""

LOOK = """
import os
from rsmpm_ti import (
    Affine, Body, Box, Domain, Hooke, Linear, Loading, MohrCoulomb, Output, Platen, Rock, Scene, Schedule, simulate,
)

PAGE = os.sysconf("SC_PAGE_SIZE")

def megabytes(pid="self"):
    with open(f"/proc/{pid}/statm") as file:
        return int(file.read().split()[1]) * PAGE / 1e6

def block(steps, output):
    size, dx, speed = 0.01, 1e-3, 0.5
    platens = tuple(
        Platen(axis=1, side=side, position=at, speed=v)
        for side, at, v in (("lower", 0.0, 0.5 * speed), ("upper", size, -0.5 * speed))
    )
    rock = Rock(
        density=2600.0, elasticity=Hooke(E=17e9, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
    )
    scene = Scene(
        title="block", domain=Domain(lower=(-5e-3, 0.0), upper=(size + 5e-3, size), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(size, size))),), rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), width=size), shape=Linear(),
        schedule=Schedule(t_end=1e-4), output=output,
    )
    # up to nine tenths of the strength, so that it stays one piece however many steps that takes
    strain = 0.9 * rock.criterion.strength(0.0) / rock.elasticity.E
    speed = strain * size / (steps * scene.dt)
    return scene, platens, speed, strain
"""


def run(script: str, folder: Path) -> list[list[float]]:
    """Lines of numbers that a script prints after the word MEMORY."""
    root = str(Path(__file__).resolve().parents[2])
    done = subprocess.run(
        [sys.executable, "-c", LOOK + script, str(folder)], capture_output=True, text=True, timeout=1500,
        env=os.environ | {"PYTHONPATH": root},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    lines = [line.split()[1:] for line in done.stdout.splitlines() if line.startswith("MEMORY")]
    return [[float(word) for word in line] for line in lines]


def test_memory_stays_flat_over_100_000_steps_and_500_frames(tmp_path):
    seen = run(
        """
import sys
from dataclasses import replace
import rsmpm_ti.run.run as module
import rsmpm_ti.output.writer as writer

writer.WAITING_BYTES = 4 * 2**20  # steps so small leave the painter behind at once: the queue is full from the start
scene, platens, speed, strain = block(100_000, Output(frames=500, movie=True, vtu=10))
slow = tuple(replace(p, speed=p.speed * speed / 0.5) for p in platens)
schedule = replace(scene.schedule, t_end=None, strain_end=strain)
scene = replace(scene, loading=replace(scene.loading, boundaries=slow), schedule=schedule)
def look(progress):
    if round(1000 * progress.fraction) % 50 == 0:
        print("MEMORY", progress.fraction, megabytes(), megabytes(look.run.writer._child.pid), scene.steps)
settings = module.Settings(progress=look, checkpoint_every=5.0)
from pathlib import Path
look.run = module.Run(scene, scene.particles(), module.prepare(scene, Path(sys.argv[1])), settings)
look.run.go()
""",
        tmp_path,
    )
    assert seen[0][3] >= 99_999 and seen[-1][0] == 1.0
    assert len(list((tmp_path / "frames").glob("stress_*.png"))) >= 500
    early = [row for row in seen if 0.2 <= row[0] <= 0.4]
    late = [row for row in seen if row[0] >= 0.8]
    for column, who in ((1, "solver"), (2, "painter")):
        before, after = max(row[column] for row in early), max(row[column] for row in late)
        assert after <= (1.0 + GROWTH) * before, f"{who}: {before:.1f} -> {after:.1f} MB"


def test_fifty_runs_in_one_process_neither_leak_nor_crash(tmp_path):
    seen = run(
        """
from dataclasses import replace
scene, *_ = block(100, Output())
scene = replace(scene, schedule=replace(scene.schedule, t_end=100 * scene.dt, rows=10))
for k in range(50):
    result = simulate(scene, threads=2)
    assert len(result.history) >= 10
    print("MEMORY", k, megabytes())
""",
        tmp_path,
    )
    assert len(seen) == 50
    first, last = seen[9][1], seen[-1][1]
    assert last <= (1.0 + GROWTH) * first, f"{first:.1f} MB after ten runs, {last:.1f} after fifty"
