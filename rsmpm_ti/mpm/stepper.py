"""Time stepping: musl, usf and usl as lists of passes, and the clock that counts them."""

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.holes.press import press
from rsmpm_ti.mpm.nodes import clear_nodes, momentum_to_velocity, move_grid, update_moving_nodes, update_nodes
from rsmpm_ti.mpm.passes import Pass, g2p, musl_step, p2g

LOAD = Pass(momentum=True, force=True)
MOVE = Pass(position=True, stress=True)
MOVE_AND_LOAD = Pass(position=True, stress=True, momentum=True, force=True)
MOMENTUM = Pass(momentum=True)
STRESS_AND_FORCE = Pass(stress=True, force=True)
VELOCITY_AND_MOVE = Pass(velocity=True, position=True)
EVERYTHING = Pass(velocity=True, position=True, stress=True)


def scatter_all(sim: Simulation, what: Pass, time: float) -> None:
    p2g(sim, what, time, sim.traversal.ticket())


def gather_all(sim: Simulation, what: Pass, dt: float, time: float) -> None:
    g2p(sim, what, dt, time, sim.traversal.ticket())


def follow(sim: Simulation, dt: float, factor: float) -> None:
    """The grid goes to where platens are at a step's end."""
    if sim.grid.followed:
        move_grid(sim, dt, factor)


def musl(sim: Simulation, dt: float, start: float, factors: list[float]) -> None:
    """Stress last, from velocities mapped back from moved particles.  Sulsky, Zhou & Schreyer (1995).

    The pass that ends a step begins the next: particles go to the nodes while they are at hand.
    """
    clear_nodes(sim)
    scatter_all(sim, LOAD, start)
    for step, factor in enumerate(factors, 1):
        # after the last step it is for nothing, and cheaper than compiling a pass that does not; but with a nonlocal
        # mean, where every other step may be the last, that is what is compiled
        press(sim, start + (step - 1) * dt)
        what = MOVE_AND_LOAD if step < len(factors) or not sim.is_nonlocal else MOVE
        musl_step(sim, what, dt, factor, start + step * dt, sim.traversal.ticket(2))


def usf(sim: Simulation, dt: float, start: float, factors: list[float]) -> None:
    """Stress first.  Bardenhagen (2002), J. Comput. Phys. 180:383."""
    for step, factor in enumerate(factors, 1):
        time = start + step * dt
        clear_nodes(sim)
        scatter_all(sim, MOMENTUM, time - dt)
        momentum_to_velocity(sim, factor)
        gather_all(sim, STRESS_AND_FORCE, dt, time)
        press(sim, time - dt)
        update_moving_nodes(sim, dt, factor)
        gather_all(sim, VELOCITY_AND_MOVE, dt, time)
        follow(sim, dt, factor)


def usl(sim: Simulation, dt: float, start: float, factors: list[float]) -> None:
    """Stress last, from the updated node velocities; dissipates.  Sulsky, Chen & Schreyer (1994)."""
    for step, factor in enumerate(factors, 1):
        clear_nodes(sim)
        scatter_all(sim, LOAD, start + (step - 1) * dt)
        press(sim, start + (step - 1) * dt)
        update_nodes(sim, dt, factor)
        gather_all(sim, EVERYTHING, dt, start + step * dt)
        follow(sim, dt, factor)


ORDERS = {"musl": musl, "usf": usf, "usl": usl}
"""Each takes steps of dt from a time [s], one for every factor on the platens' speed."""
