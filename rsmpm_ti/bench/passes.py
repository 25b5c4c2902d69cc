"""`bench passes`: where the time of a step goes. Parts of the one kernel that a step is, each compiled by itself; and
the look at all particles that every row of the history needs."""

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
    from rsmpm_ti.solver.survey import survey

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
        "look at all particles": lambda: survey(sim),
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
    return "\n".join(lines)
