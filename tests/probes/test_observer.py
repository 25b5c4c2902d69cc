"""A probe of observers: one of a user's own, in this file alone, that writes a file and survives `--resume`."""

import os
import signal
from pathlib import Path

import numpy as np
import pytest

from rsmpm_ti import Observer, load_scene, simulate

QUICK = {"shape": "Linear", "schedule.rows": "60", "output.frames": "0", "output.vtu": "0", "output.movie": "false"}
"""Linear compiles fastest."""


class Depths(Observer):
    """Writes the mean axial stress in layers of the specimen at five times, and sums of what it has seen."""

    every = 0.25

    def __init__(self):
        self.looks, self.sum = 0, np.zeros(4)

    def see(self, view) -> None:
        layer = np.clip((view.snapshot.x[:, 1] / 0.1 * 4).astype(int), 0, 3)
        stress = np.array([view.snapshot.sigma[layer == k, 1, 1].mean() for k in range(4)])
        self.sum = self.sum + stress
        lines = [f"t = {view.time:.9g} s, strain {view.strain:.9g}", *(f"{s:.9g}" for s in (*stress, *self.sum))]
        (view.out / f"depths_{self.looks}.txt").write_text("\n".join(lines) + "\n")
        self.looks += 1

    def state(self) -> dict:
        return {"looks": self.looks, "sum": self.sum}

    def resume(self, state: dict) -> None:
        self.looks, self.sum = state["looks"], state["sum"]


def written(out: Path) -> dict[str, str]:
    return {path.name: path.read_text() for path in sorted(out.glob("depths_*.txt"))}


def run(out: Path, stop_at: float = 2.0, resume: bool = False) -> Depths:
    scene = load_scene("intact", dx=5e-3, strain_end=2e-4, settings=QUICK)
    observer = Depths()

    def stop(progress) -> None:
        if progress.fraction > stop_at:
            os.kill(os.getpid(), signal.SIGINT)

    simulate(scene, out=out, threads=1, resume=resume, observers=(observer,), progress=stop)
    return observer


@pytest.mark.thorough
def test_an_observer_of_ones_own_writes_at_its_own_interval_and_survives_resume(tmp_path):
    whole = run(tmp_path / "whole")
    files = written(tmp_path / "whole")
    assert len(files) == 5, "at the start, after each quarter, at the end"
    times = [float(text.split()[2]) for text in files.values()]
    np.testing.assert_allclose(np.array(times) / times[-1], [0.0, 0.25, 0.5, 0.75, 1.0], atol=1.5 / 60)  # rows
    halted = run(tmp_path / "halted", stop_at=0.6)
    assert halted.looks == 3
    resumed = run(tmp_path / "halted", resume=True)
    assert resumed.looks == whole.looks and written(tmp_path / "halted") == files  # sums too: one thread, same bits
