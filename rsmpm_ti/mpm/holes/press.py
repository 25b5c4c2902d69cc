"""Loads on the walls of holes: force to nodes, and their work. Without a hole nothing of it is compiled."""

import taichi as ti

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.p2g import stress_on_nodes
from rsmpm_ti.rock.tensors import unpack


@ti.kernel
def _press(sim: ti.template(), time: ti.f64):
    """Add the force at a time [s] to the nodes."""
    walls = sim.walls
    for _ in range(1):
        now = time
        if ti.static(sim.grid.settles):
            now *= sim.grid.pace[None]
        for hole in ti.static(range(walls.holes)):
            walls.load[hole] = walls.look_up(hole, now)
    ti.loop_config(serialize=True)  # some hundred nodes
    for k in range(walls.size):
        i = walls.node[k]
        frame = sim.grid.frame()
        volume = ti.cast(1.0, ti.f64)
        for d in ti.static(range(sim.dim)):
            volume *= frame[d, 2] / sim.grid.dx
        force = ti.Vector.zero(ti.f64, sim.dim)
        if sim.nodes.mass[i] > 0.0:
            for d in ti.static(range(sim.dim)):
                force[d] = walls.load[walls.hole[k]] * walls.q[k][d] * volume * sim.grid.dx * frame[d, 1]
            sim.nodes.f[i] += ti.cast(force, float)
        walls.force[k] = force


def press(sim: Simulation, time: float) -> None:
    """Whatever presses in the holes of a scene, at a step's beginning [s], after the forces of the particles."""
    if sim.walls.holes:
        _press(sim, time)


@ti.func
def book_walls(sim: ti.template(), dt: ti.template()):
    """Work of that force in a step whose nodes have their new velocity, and in f its change:

        dW = dt f . (v - dv/2),

    which is booked as `body_work` of mpm/g2p.py books that of a body force, for the reason given there.
    """
    if ti.static(sim.walls.holes > 0):
        for _ in range(1):
            work = ti.cast(0.0, ti.f64)
            for k in range(sim.walls.size):
                i = sim.walls.node[k]
                middle = ti.cast(sim.nodes.v[i], ti.f64) - 0.5 * ti.cast(sim.nodes.f[i], ti.f64)
                work += sim.walls.force[k].dot(middle)
            sim.ledger.body_work[0] = sim.ledger.body_work[0] + ti.cast(dt, ti.f64) * work
            sim.walls.dt[None] = dt


@ti.func
def book_remap(sim: ti.template(), dt: ti.template()):
    """musl: particles take less than a node's own dv, its mean over them, which the velocity mapped back has:

        dW = dt f . (v_old + v_remapped)/2,

    of which `book_walls` has booked v for v_remapped. It matters for nodes that hold little rock, as many of a wall do.
    """
    if ti.static(sim.walls.holes > 0):
        for _ in range(1):
            work = ti.cast(0.0, ti.f64)
            for k in range(sim.walls.size):
                i = sim.walls.node[k]
                work += 0.5 * sim.walls.force[k].dot(ti.cast(sim.nodes.v_remapped[i] - sim.nodes.v_moving[i], ti.f64))
            sim.ledger.body_work[0] = sim.ledger.body_work[0] + ti.cast(dt, ti.f64) * work


@ti.func
def latest_internal_work(sim: ti.template(), p):
    """Work of the stress of a particle in the latest step, dt V sigma : grad v [J].

    Velocities are half a step behind the positions. The work of forces and what it adds to the kinetic energy are both
    of that time, the elastic energy is half of this ahead: to count it as done closes the books to second order. It
    stands in place of half of the boundaries' latest work, which is right for platens that go slowly, and not for a
    blast.
    """
    L = sim.particles.L[p]
    carried = unpack(stress_on_nodes(sim, p))
    power = 0.0
    for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
        power += carried[d, e] * L[d, e]
    return ti.cast(sim.walls.dt[None], ti.f64) * ti.cast(power, ti.f64)
