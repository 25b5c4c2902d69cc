"""`bench scaling`: cost per particle-step against the number of particles, and memory per particle."""

import statistics

import numpy as np

from rsmpm_ti.bench.workers import Runner, workers

SIZES = (1e-3, 0.5e-3, 0.25e-3, 0.125e-3, 0.0625e-3)
"""Cell sizes [m] of 20 000 to 5.12 million particles."""


def scaling(rounds: int, threads: int, shape: str = "bspline") -> str:
    """Median nanoseconds per particle-step over rounds, for one thread and all, and over that of 80 000 particles."""
    lines = [f"{shape}, musl, f64, {rounds} rounds in turn", f"{'particles':>10}" + "".join(
        f"{f'{t} thread(s) [ns]':>20}{'over 80 000':>14}" for t in dict.fromkeys((1, threads)))]  # fmt: skip
    plan = [Runner("solver", shape, threads=t, dx=dx) for dx in SIZES for t in dict.fromkeys((1, threads))]
    cost: dict[Runner, list[float]] = {runner: [] for runner in plan}
    with workers() as (pool, _):
        for runner in plan:
            pool.rate(runner, 2)
        for _ in range(rounds):
            for runner in plan:
                cost[runner].append(1e3 / pool.rate(runner, steps_for(runner.dx)))
    for dx in SIZES:
        line = f"{particles(dx):>10}"
        for t in dict.fromkeys((1, threads)):
            this, base = (statistics.median(cost[Runner("solver", shape, threads=t, dx=h)]) for h in (dx, 0.5e-3))
            line += f"{this:>20.1f}{this / base:>14.2f}"
        lines.append(line)
    return "\n".join(lines)


def particles(dx: float) -> int:
    """Of the intact cube of 50 x 100 mm with four to a cell."""
    return round(4 * 0.05 * 0.1 / dx**2)


def steps_for(dx: float) -> int:
    """Steps of some 10 million particle-steps in all, and never fewer than 6."""
    return max(6, round(1e7 / particles(dx)))


def memory(names: tuple[str, ...]) -> str:
    """Bytes per particle of what the solver holds for a scene, by name: particle fields, events, nodes.

    Computed from the fields themselves; nodes per particle with four particles to a cell of the scene's body.
    """
    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.fields.state import Simulation
    from rsmpm_ti.spec.loader import load_scene

    lines = [
        f"{'scene':<10}{'particles':>10}{'particle fields':>18}{'events':>10}{'nodes':>10}  bytes per particle, f64"
    ]
    for name in names:
        start_taichi("f64", "cpu", 1)
        scene = load_scene(name)
        sim = Simulation(scene, scene.particles())
        count = sim.particles.count
        parts = [bytes_of(part) / count for part in (sim.particles, sim.events, sim.nodes)]
        lines.append(
            f"{name:<10}{count:>10}" + "".join(f"{b:>{w}.0f}" for b, w in zip(parts, (18, 10, 10), strict=True))
        )
    return "\n".join(lines)


def bytes_of(owner) -> int:
    """Of all distinct Taichi fields that an object holds."""
    import taichi as ti

    found = {}
    for value in vars(owner).values():
        for field in value if isinstance(value, tuple) else (value,):
            if isinstance(field, ti.Field):
                for part in field._get_field_members():
                    size = 4 if field.dtype in (ti.i32, ti.f32) else 8
                    found[part.ptr] = size * int(np.prod(field.shape))
    return sum(found.values())
