"""`bench lab`: a particle-step of the rock of `cube_lab` over one of the paper's rule, whole and at the peak load."""

import statistics
import time
from dataclasses import replace

STEPS = 40

PEAK = 6e-4
"""Platen strain at which `cube_lab` bears the most, about."""


def lab_rock(dx: float, threads: int, rounds: int) -> str:
    """Table of nanoseconds per particle-step, all in turn in one run. dx: cell size [m]."""
    from rsmpm_ti import CompressionOnly, Local, load_scene
    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.solver.advance import Drive

    real, _ = start_taichi("f64", "cpu", threads)
    scene = load_scene("cube_lab", dx=dx)
    papers = replace(scene, rock=replace(scene.rock, after_failure=CompressionOnly(), nonlocal_mean=Local()))
    drives = {"the paper's rule": Drive(papers, scene.particles(), real)}
    drives |= {name: Drive(scene, scene.particles(), real) for name in ("cube_lab, whole", "cube_lab, at its peak")}
    for drive in drives.values():
        drive.advance(2)
    last = drives["cube_lab, at its peak"]
    while last.clock.strain < PEAK:
        last.advance(STEPS)
    taken: dict[str, list[float]] = {name: [] for name in drives}
    for _ in range(rounds):
        for name, drive in drives.items():
            taken[name].append(_seconds(drive))
    median = {name: statistics.median(seconds) / (STEPS * last.sim.particles.count) for name, seconds in taken.items()}
    first = median["the paper's rule"]
    lines = [f"dx {1e3 * dx:g} mm, f64, {threads} thread(s), median of {rounds} rounds of {STEPS} steps in turn"]
    lines.append(f"{'':<24}{'ns':>8}{'ratio':>8}")
    return "\n".join(lines + [f"{name:<24}{1e9 * value:>8.1f}{value / first:>8.2f}" for name, value in median.items()])


def _seconds(drive) -> float:
    import taichi as ti

    ti.sync()
    start = time.perf_counter()
    drive.clock.advance(STEPS)
    ti.sync()
    return time.perf_counter() - start
