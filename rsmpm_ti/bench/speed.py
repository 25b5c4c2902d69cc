"""`bench speed`: this code against the yardstick, interleaved in one run, as ratios."""

import statistics
import time
from dataclasses import replace

from rsmpm_ti.bench.settings import SHAPES
from rsmpm_ti.library import load_scene
from rsmpm_ti.run import start_taichi
from rsmpm_ti.seeding import Lattice


def solver(shape: str, order: str):
    """The intact cube in its elastic phase as (particles, step function): 80 000 particles, failure check on."""
    from rsmpm_ti.sorting import sort_particles
    from rsmpm_ti.state import Simulation
    from rsmpm_ti.stepper import Clock

    scene = load_scene("intact", time_scale=1.0, strain_end=1.5e-3)
    bodies = (replace(scene.bodies[0], seeding=Lattice()),)
    scene = replace(scene, shape=SHAPES[shape](2), order=order, bodies=bodies)
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    clock = Clock(sim)
    return sim.particles.count, clock.advance


def yardstick():
    from rsmpm_ti.bench.yardstick import Naive

    naive = Naive()

    def advance(steps: int) -> None:
        for _ in range(steps):
            naive.step()

    return naive.count, advance


def speed(threads: int, rounds: int, steps: int, order: str) -> str:
    """Table of M particle-steps/s (min, median, max over rounds) and the ratio to the yardstick, round by round."""
    import taichi as ti

    start_taichi("f64", "cpu", threads)
    runners = {"yardstick, linear, usl": yardstick()}
    runners |= {f"rsmpm_ti, {shape}, {order}": solver(shape, order) for shape in SHAPES}
    for _, advance in runners.values():
        advance(3)
    ti.sync()
    rates: dict[str, list[float]] = {name: [] for name in runners}
    for _ in range(rounds):
        for name, (count, advance) in runners.items():
            start = time.perf_counter()
            advance(steps)
            ti.sync()
            rates[name].append(count * steps / (time.perf_counter() - start) / 1e6)
    base = rates["yardstick, linear, usl"]
    lines = [f"{threads} thread(s), f64, {rounds} rounds of {steps} steps, 80 000 particles, failure check on"]
    lines.append(f"{'':<28}{'M particle-steps/s':>24}{'ratio to yardstick':>24}")
    for name, values in rates.items():
        ratios = [a / b for a, b in zip(values, base, strict=True)]
        lines.append(f"{name:<28}{_spread(values):>24}{_spread(ratios):>24}")
    return "\n".join(lines)


def _spread(values: list[float]) -> str:
    return f"{min(values):.2f} / {statistics.median(values):.2f} / {max(values):.2f}"
