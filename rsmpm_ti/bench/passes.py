"""`bench passes`: where the time of a step goes. Parts of the one kernel that a step is, each compiled by itself; and
what the rows of a history cost."""

import statistics
import time


def passes(shape: str, threads: int, rounds: int) -> str:
    """Median nanoseconds per particle of each part, over rounds in turn; steps of no length, so that nothing moves."""
    import taichi as ti

    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.bench.workers import Runner, simulation
    from rsmpm_ti.mpm.nodes import update_nodes
    from rsmpm_ti.mpm.passes import Pass, g2p, musl_step, p2g
    from rsmpm_ti.mpm.stepper import LOAD, MOVE, MOVE_AND_LOAD

    real, _ = start_taichi("f64", "cpu", threads)
    drive = simulation(Runner("solver", shape), real)
    drive.advance(3)
    sim, ticket = drive.sim, drive.sim.traversal.ticket
    parts = {
        "particles to nodes": lambda: p2g(sim, LOAD, 0.0, ticket()),
        "node update": lambda: update_nodes(sim, 0.0, 0.0),
        "positions": lambda: g2p(sim, Pass(position=True), 0.0, 0.0, ticket()),
        "gradient, stress, check": lambda: g2p(sim, Pass(stress=True), 0.0, 0.0, ticket()),
        "positions, gradient, stress, check": lambda: g2p(sim, MOVE, 0.0, 0.0, ticket()),
        "these and particles to nodes": lambda: g2p(sim, MOVE_AND_LOAD, 0.0, 0.0, ticket()),
        "whole step": lambda: musl_step(sim, MOVE_AND_LOAD, 0.0, 0.0, 0.0, ticket(2)),
    }
    seconds: dict[str, list[float]] = {name: [] for name in parts}
    for part in parts.values():
        part()
    for _ in range(rounds):
        for name, part in parts.items():
            start = time.perf_counter()
            part()
            ti.sync()
            seconds[name].append(time.perf_counter() - start)
    scale = 1e9 / sim.particles.count
    lines = [f"{shape}, musl, f64, {threads} thread(s), 80 000 particles, median of {rounds} rounds [ns per particle]"]
    lines += [f"{name:<36}{scale * statistics.median(times):>8.1f}" for name, times in seconds.items()]
    lines += [f"{f'steps, a row every {n}':<36}{scale * s:>8.1f}" for n, s in _rows(shape, real, rounds)]
    return "\n".join(lines)


ROW_EVERY, ROW_SPAN = (1, 5, 10, 20, 50), 50
"""Steps between two rows, and steps of one measurement."""


def _rows(shape: str, real, rounds: int) -> list[tuple[int, float]]:
    """(steps between two rows, median seconds of a step with its part of a row), by the processor's clock: a row is a
    millisecond, and other processes take as long."""
    import taichi as ti

    from rsmpm_ti.bench.workers import Runner, simulation
    from rsmpm_ti.solver.history import History

    drive = simulation(Runner("solver", shape), real)
    history = History(drive.sim, drive.clock, drive.survey)
    seconds: dict[int, list[float]] = {n: [] for n in ROW_EVERY}
    drive.advance(1)
    for _ in range(max(1, rounds // 5)):
        for n in ROW_EVERY:
            start = time.process_time()
            for _ in range(ROW_SPAN // n):
                drive.advance(n)
                history.record(drive.survey)
            ti.sync()
            seconds[n].append((time.process_time() - start) / ROW_SPAN)
    return [(n, statistics.median(times)) for n, times in seconds.items()]
