"""`bench passes`: where the time of a step goes, kernel by kernel."""

import time

KERNELS = ("p2g", "g2p", "g2p_remap", "clear_nodes", "update_nodes", "remap_velocity", "momentum_to_velocity")


def passes(shape: str, order: str, rounds: int, steps: int) -> str:
    """Nanoseconds per particle-step of each kernel, the fastest of the rounds, one thread."""
    import taichi as ti

    from rsmpm_ti import stepper
    from rsmpm_ti.bench.workers import Runner, simulation
    from rsmpm_ti.run import start_taichi

    real, _ = start_taichi("f64", "cpu", 1)
    drive = simulation(Runner("solver", shape, order=order), real)
    drive.advance(3)
    spent: dict[str, float] = {}

    def timed(name: str, kernel):
        def run(*arguments):
            ti.sync()
            start = time.perf_counter()
            kernel(*arguments)
            ti.sync()
            spent[name] = spent.get(name, 0.0) + time.perf_counter() - start

        return run

    originals = {name: getattr(stepper, name) for name in KERNELS}
    best: dict[str, float] = {}
    try:
        for name, kernel in originals.items():
            setattr(stepper, name, timed(name, kernel))
        for _ in range(rounds):
            spent.clear()
            drive.clock.advance(steps)
            if not best or sum(spent.values()) < sum(best.values()):
                best = dict(spent)
    finally:
        for name, kernel in originals.items():
            setattr(stepper, name, kernel)
    scale = 1e9 / (steps * drive.sim.particles.count)
    lines = [f"{shape}, {order}, f64, 1 thread, {steps} steps, the fastest of {rounds} rounds"]
    lines += [
        f"{name:<24}{scale * t:>8.1f} ns per particle-step" for name, t in sorted(best.items(), key=lambda b: -b[1])
    ]
    return "\n".join([*lines, f"{'together':<24}{scale * sum(best.values()):>8.1f}"])
