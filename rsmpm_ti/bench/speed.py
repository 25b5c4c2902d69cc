"""`bench speed`: this code against a naive twin and a hand-written one, interleaved in one run, as ratios."""

import statistics
from dataclasses import replace

from rsmpm_ti.bench.sweep import SHAPES
from rsmpm_ti.bench.workers import WIDTHS, Runner, workers

FINE = 0.25e-3
"""Cell size [m] at which there are 320 000 particles."""


def runners(threads: int, twins: bool) -> list[Runner]:
    """What is timed in each round: the twins, every shape function, and one change at a time."""
    out = [Runner("naive", shape) for shape in WIDTHS]
    out += [Runner("c++", shape) for shape in WIDTHS if twins]
    out += [Runner("solver", shape) for shape in SHAPES]
    out += [Runner("solver", shape, order="usf") for shape in WIDTHS]
    out += [Runner("solver", shape, precision="f32") for shape in SHAPES]
    out += [Runner("solver", shape, dx=FINE) for shape in WIDTHS]
    if threads > 1:
        out += [Runner("solver", shape, threads=threads) for shape in SHAPES]
        out += [Runner("solver", shape, threads=threads, dx=FINE) for shape in WIDTHS]
    return out


def timed(plan: list[Runner], pool, rounds: int, steps: int) -> dict[Runner, list[float]]:
    """M particle-steps/s of each in each round; a few steps before, which compile, are not counted."""
    for runner in plan:
        pool.rate(runner, 3)
    rates: dict[Runner, list[float]] = {runner: [] for runner in plan}
    for _ in range(rounds):
        for runner in plan:
            rates[runner].append(pool.rate(runner, steps))
    return rates


def speed(threads: int, rounds: int, steps: int) -> str:
    """Table of M particle-steps/s and of ratios, round by round: min / median / max."""
    with workers() as (pool, twins):
        rates = timed(runners(threads, twins), pool, rounds, steps)
    lines = [
        f"{rounds} rounds of {steps} steps in turn, 80 000 particles unless named, failure check on, f64 unless named"
    ]
    lines.append(f"{'':<36}{'M particle-steps/s':>22}{'ratio to naive':>22}{'ratio to C++':>22}")
    for runner, values in rates.items():
        shape = runner.shape if runner.shape in WIDTHS else "bspline"  # uGIMP has as many nodes
        columns = [_spread(values)]
        for code in ("naive", "c++"):
            base = rates.get(Runner(code, shape))
            columns.append(_ratios(values, base) if base else "no g++")
        lines.append(f"{runner.label:<36}" + "".join(f"{column:>22}" for column in columns))
    for runner, values in rates.items():
        if runner.threads > 1:
            single = rates[replace(runner, threads=1)]
            lines.append(f"{runner.label:<38}over 1 thread: {_ratios(values, single)}")
    return "\n".join(lines)


def _ratios(values: list[float], base: list[float]) -> str:
    return _spread([a / b for a, b in zip(values, base, strict=True)])


def _spread(values: list[float]) -> str:
    return f"{min(values):.2f} / {statistics.median(values):.2f} / {max(values):.2f}"
