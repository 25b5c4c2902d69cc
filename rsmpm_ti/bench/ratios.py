"""One step over another: `bench fill`, the sparse grid over the dense one, against how much of it holds material;
`bench lab`, the rock of `cube_lab` over one of the paper's rule, whole and at the peak load."""

import statistics
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import product

RADIUS = {2: 40, 3: 12}
"""Of the moving ball, in cells."""

EDGES = {2: (120, 200, 260, 340, 450, 600), 3: (30, 40, 52, 68, 88, 115)}
"""Of the box around it, in cells."""

STEPS = 10

LAB_STEPS = 40

PEAK = 6e-4
"""Platen strain at which `cube_lab` bears the most, about."""


def fill(threads: int, rounds: int) -> str:
    lines = [f"f64, {threads} thread(s), median of {rounds} rounds of {STEPS} steps"]
    lines.append(f"{'shape':<9}{'dim':>3}{'filled [%]':>12}{'sparse / dense':>16}")
    for shape, dim in product(("linear", "bspline"), (2, 3)):
        dense, sparse = _times(shape, dim, "dense", threads, rounds), _times(shape, dim, "sparse", threads, rounds)
        for (filled, a), (_, b) in zip(dense, sparse, strict=True):
            lines.append(f"{shape:<9}{dim:>3}{100.0 * filled:>12.2f}{b / a:>16.2f}")
    return "\n".join(lines)


def _times(shape: str, dim: int, grid: str, threads: int, rounds: int) -> Iterator[tuple[float, float]]:
    """Filled fraction of the grid, and the median seconds of a few steps, of wider and wider boxes."""
    import taichi as ti

    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.solver.advance import Drive
    from rsmpm_ti.spec.review.memory import filled_fraction

    for edge in EDGES[dim]:
        real, _ = start_taichi("f64", "cpu", threads)
        scene = ball_in_a_box(shape, dim, grid, edge)
        drive = Drive(scene, scene.particles(), real)
        drive.advance(STEPS)
        seconds = []
        for _ in range(rounds):
            start = time.perf_counter()
            drive.advance(STEPS)
            ti.sync()
            seconds.append(time.perf_counter() - start)
        yield filled_fraction(scene, drive.sim.particles.count), statistics.median(seconds)


def ball_in_a_box(shape: str, dim: int, grid: str, edge: int):
    """An elastic ball that flies at 1 m/s in the middle of a box of `edge` cells."""
    from rsmpm_ti import Body, Disc, Domain, Hooke, Loading, Rock, Scene, Schedule, Unbreakable
    from rsmpm_ti.bench.sweep import SHAPES

    dx = 1e-3
    return Scene(
        title="ball in a box",
        domain=Domain(lower=(0.0,) * dim, upper=(edge * dx,) * dim, dx=dx, grid=grid),
        bodies=(Body(region=Disc(centre=(0.5 * edge * dx,) * dim, radius=RADIUS[dim] * dx), velocity=(1.0,) * dim),),
        rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable()),
        loading=Loading(),
        shape=SHAPES[shape](dim),
        schedule=Schedule(t_end=1e-4),
    )


def lab_rock(dx: float, threads: int, rounds: int) -> str:
    """Table of nanoseconds per particle-step, all in turn in one run. dx: cell size [m]."""
    from rsmpm_ti import CompressionOnly, Local, load_scene
    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.solver.advance import Drive

    real, _ = start_taichi("f64", "cpu", threads)
    scene = load_scene("cube_lab", dx=dx, length=max(1e-3, 2.0 * dx))
    papers = replace(scene, rock=replace(scene.rock, after_failure=CompressionOnly(), nonlocal_mean=Local()))
    drives = {"the paper's rule": Drive(papers, scene.particles(), real)}
    drives |= {name: Drive(scene, scene.particles(), real) for name in ("cube_lab, whole", "cube_lab, at its peak")}
    for drive in drives.values():
        drive.advance(2)
    last = drives["cube_lab, at its peak"]
    while last.clock.strain < PEAK:
        last.advance(LAB_STEPS)
    taken: dict[str, list[float]] = {name: [] for name in drives}
    for _ in range(rounds):
        for name, drive in drives.items():
            taken[name].append(_seconds(drive))
    median = {
        name: statistics.median(seconds) / (LAB_STEPS * last.sim.particles.count) for name, seconds in taken.items()
    }
    first = median["the paper's rule"]
    lines = [f"dx {1e3 * dx:g} mm, f64, {threads} thread(s), median of {rounds} rounds of {LAB_STEPS} steps in turn"]
    lines.append(f"{'':<24}{'ns':>8}{'ratio':>8}")
    return "\n".join(lines + [f"{name:<24}{1e9 * value:>8.1f}{value / first:>8.2f}" for name, value in median.items()])


def _seconds(drive) -> float:
    import taichi as ti

    ti.sync()
    start = time.perf_counter()
    drive.clock.advance(LAB_STEPS)
    ti.sync()
    return time.perf_counter() - start
