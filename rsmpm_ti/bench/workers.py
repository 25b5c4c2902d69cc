"""Processes that step on request, so that codes which cannot share one process are timed in turn, in one run."""

import contextlib
import multiprocessing
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from rsmpm_ti.bench.sweep import SHAPES
from rsmpm_ti.process import end_with_parent, no_current_folder, without_ctrl_c

WIDTHS = {"linear": 2, "bspline": 3}
"""Shape functions that the twins know, and their nodes per axis."""

FLAGS = ("-O3", "-march=native", "-ffast-math")


@dataclass(frozen=True)
class Runner:
    """One thing to time. `code`: 'solver', 'naive' or 'c++'; `dx` [m] sets the number of particles of the solver."""

    code: str
    shape: str
    order: str = "musl"
    precision: str = "f64"
    threads: int = 1
    dx: float = 0.5e-3

    @property
    def label(self) -> str:
        if self.code != "solver":
            return f"{self.code}, {self.shape}"
        threads = "1 thread" if self.threads == 1 else f"{self.threads} threads"
        size = "" if self.dx == 0.5e-3 else f", {1e-3 * 4 * 0.005 / self.dx**2:.0f} k"
        return f"{self.shape}, {self.order}, {self.precision}, {threads}{size}"


def simulation(runner: Runner, real):
    """The intact cube in its elastic phase, failure check on, lattice: a Drive that has been sorted."""
    from rsmpm_ti.solver.advance import Drive
    from rsmpm_ti.spec.loader import load_scene
    from rsmpm_ti.spec.seeding import Lattice

    scene = load_scene("intact", time_scale=1.0, strain_end=1.5e-3, dx=runner.dx)
    bodies = (replace(scene.bodies[0], seeding=Lattice()),)
    scene = replace(scene, shape=SHAPES[runner.shape](2), order=runner.order, bodies=bodies)
    return Drive(scene, scene.particles(), real)


def _serve(pipe, precision: str, threads: int) -> None:
    end_with_parent()
    import taichi as ti

    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.bench.naive import Naive

    real, _ = start_taichi(precision, "cpu", threads)
    ready = {}
    while True:
        runner, steps = pipe.recv()
        if runner not in ready:
            if runner.code == "naive":
                ready[runner] = Naive(WIDTHS[runner.shape], real)
            else:
                ready[runner] = simulation(runner, real)
        start, target = time.perf_counter(), ready[runner]
        if runner.code == "naive":
            for _ in range(steps):
                target.step()
            count = target.count
        else:
            target.advance(steps)
            count = target.sim.particles.count
        ti.sync()
        pipe.send(1e-6 * count * steps / (time.perf_counter() - start))


def compile_twins(folder: Path) -> dict[str, Path]:
    """The C++ twin for each shape function; none where there is no g++."""
    if shutil.which("g++") is None:
        return {}
    made = {}
    for shape, width in WIDTHS.items():
        made[shape] = folder / f"twin_{shape}"
        source = Path(__file__).with_name("twin.cpp")
        subprocess.run(["g++", *FLAGS, f"-DWIDTH={width}", str(source), "-o", str(made[shape])], check=True)
    return made


class Workers:
    """`rate(runner, steps)`: M particle-steps/s of so many steps, M being millions. One process runs at a time."""

    def __init__(self, twins: dict[str, Path]):
        self._twins, self._processes, self._pipes = twins, [], {}

    def rate(self, runner: Runner, steps: int) -> float:
        key = ("c++", runner.shape) if runner.code == "c++" else (runner.precision, runner.threads)
        if key not in self._pipes:
            self._pipes[key] = self._start(runner)
        pipe = self._pipes[key]
        if runner.code == "c++":
            pipe.stdin.write(f"{steps}\n")
            pipe.stdin.flush()
            return float(pipe.stdout.readline().split()[0])
        pipe.send((runner, steps))
        return pipe.recv()

    def _start(self, runner: Runner):
        if runner.code == "c++":
            command = [str(self._twins[runner.shape])]
            self._processes.append(subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True))
            return self._processes[-1]
        context = multiprocessing.get_context("spawn")
        here, there = context.Pipe()
        process = context.Process(target=_serve, args=(there, runner.precision, runner.threads), daemon=True)
        with no_current_folder(), without_ctrl_c():
            process.start()
        self._processes.append(process)
        return here

    def stop(self) -> None:
        for process in self._processes:
            process.terminate()


@contextlib.contextmanager
def workers() -> Iterator[tuple[Workers, bool]]:
    """Workers, and whether there are C++ twins among them."""
    with tempfile.TemporaryDirectory() as folder:
        twins = compile_twins(Path(folder))
        pool = Workers(twins)
        try:
            yield pool, bool(twins)
        finally:
            pool.stop()
