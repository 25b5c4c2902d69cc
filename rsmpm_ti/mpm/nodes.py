"""What is done to nodes alone: clear them, turn momentum into velocity, add forces, apply boundaries."""

import taichi as ti

from rsmpm_ti.mpm.wall_nodes import extend, fold

SMALL_MASS = 1e-24
"""Nodes lighter than this share of a full cell hold nothing: what they are made of is round-off.

A particle that reaches a share r of a cell into a node's support gives it r^2/2 by B-splines and GIMP, and has a
gradient of r there: a node that was dropped at 1e-12 took 1e-6 of the speed from its velocity gradient.
"""

PUSHED_MASS = 1e-12
"""With `usl`, nodes lighter than this share of a full cell take no force. What a force of r does to r^2/2 is 1/r, and
`usl` takes it into the gradient, times r: a node just reached would strain its particle as much as any other.
"""


@ti.func
def clear_node(sim: ti.template(), i):
    sim.nodes.mass[i] = 0.0
    sim.nodes.v[i] = ti.Vector.zero(float, sim.dim)
    sim.nodes.f[i] = ti.Vector.zero(float, sim.dim)


@ti.kernel
def clear_nodes(sim: ti.template()):
    # a loop over a field always wakes the threads, one over numbers need not; but a sparse grid must be asked for its
    # nodes. So here and below.
    if ti.static(not sim.nodes.sparse):
        ti.loop_config(serialize=sim.nodes.serial)
        for i in ti.grouped(ti.ndrange(*sim.grid.nodes)):
            clear_node(sim, i)
    else:
        for i in ti.grouped(sim.nodes.mass):
            clear_node(sim, i)


@ti.func
def hold(sim: ti.template(), i, v, factor):
    """Node velocity after every boundary that holds the node."""
    held = v
    for boundary in ti.static(sim.boundaries):
        if boundary.holds(sim.grid.position(i), sim.grid.dx):
            held = boundary.project(held, factor)
    return held


@ti.func
def velocity_of(sim: ti.template(), i, momentum, factor):
    """v_i = (mv)_i / m_i and boundaries, for momentum that is mapped apart from force."""
    m = sim.nodes.mass[i]
    v = ti.Vector.zero(float, sim.dim)
    if m > SMALL_MASS * sim.density * sim.grid.dx**sim.dim:
        v = hold(sim, i, 1.0 / m * momentum, factor)
    return v


@ti.kernel
def momentum_to_velocity(sim: ti.template(), factor: float):
    """usf: velocity where momentum was."""
    fold(sim.nodes.momentum_columns, sim.grid.walls)
    if ti.static(not sim.nodes.sparse):
        ti.loop_config(serialize=sim.nodes.serial)
        for i in ti.grouped(ti.ndrange(*sim.grid.nodes)):
            sim.nodes.v[i] = velocity_of(sim, i, sim.nodes.v[i], factor)
    else:
        for i in ti.grouped(sim.nodes.mass):
            sim.nodes.v[i] = velocity_of(sim, i, sim.nodes.v[i], factor)
    extend(sim.nodes.v_columns, sim.grid.walls)


@ti.func
def remap_node(sim: ti.template(), i, factor):
    sim.nodes.w[i] = velocity_of(sim, i, sim.nodes.w[i], factor)
    sim.nodes.u[i] = sim.nodes.v[i]
    clear_node(sim, i)


@ti.func
def velocity_after_remap(sim: ti.template(), factor):
    """musl: w becomes velocity, u takes the step's, and mass, v and f are cleared for what the next step maps."""
    fold(sim.nodes.w_columns, sim.grid.walls)
    if ti.static(not sim.nodes.sparse):
        ti.loop_config(serialize=sim.nodes.serial)
        for i in ti.grouped(ti.ndrange(*sim.grid.nodes)):
            remap_node(sim, i, factor)
    else:
        for i in ti.grouped(sim.nodes.mass):
            remap_node(sim, i, factor)
    extend(sim.nodes.w_columns, sim.grid.walls)


@ti.func
def update_node(sim: ti.template(), i, divide: ti.template(), dt, factor):
    """v_i <- v_i + dt (f_i/m_i + b), then boundaries, whose impulses and work go to the ledger."""
    nodes, ledger = sim.nodes, sim.ledger
    m = nodes.mass[i]
    v, dv = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
    if m > SMALL_MASS * sim.density * sim.grid.dx**sim.dim:
        inverse, v_old = 1.0 / m, nodes.v[i]
        if ti.static(divide):
            v_old *= inverse
        v = v_old
        if ti.static(sim.scene.order != "usl") or m > PUSHED_MASS * sim.density * sim.grid.dx**sim.dim:
            v += dt * inverse * nodes.f[i]
        if ti.static(sim.heavy):
            v += dt * ti.Vector(sim.acceleration)
        for b, boundary in ti.static(enumerate(sim.boundaries)):
            if boundary.holds(sim.grid.position(i), sim.grid.dx):
                held = boundary.project(v, factor)
                impulse = ti.cast(m * (held - v), ti.f64)
                work = impulse.dot(ti.cast(held, ti.f64))
                ledger.impulse[b] += impulse
                ledger.work[b] += work
                ledger.latest[b] += work
                v = held
        dv = v - v_old
    nodes.v[i] = v
    nodes.f[i] = dv
    if ti.static(nodes.remap):
        nodes.w[i] = ti.Vector.zero(float, sim.dim)


@ti.func
def new_velocity(sim: ti.template(), divide: ti.template(), dt, factor):
    """`divide`: v still holds momentum. Afterwards f holds the velocity change of the step."""
    nodes = sim.nodes
    for b in ti.static(range(len(sim.boundaries))):
        sim.ledger.latest[b] = 0.0
    if ti.static(divide):
        fold(nodes.momentum_columns, sim.grid.walls)
    fold(nodes.f_columns, sim.grid.walls)
    if ti.static(not nodes.sparse):
        ti.loop_config(serialize=sim.nodes.serial)
        for i in ti.grouped(ti.ndrange(*sim.grid.nodes)):
            update_node(sim, i, divide, dt, factor)
    else:
        for i in ti.grouped(nodes.mass):
            update_node(sim, i, divide, dt, factor)
    extend(nodes.v_columns, sim.grid.walls)
    extend(nodes.f_columns, sim.grid.walls)


@ti.kernel
def update_nodes(sim: ti.template(), divide: ti.template(), dt: float, factor: float):
    new_velocity(sim, divide, dt, factor)
