"""Kernels that see nodes only: clear them, turn momentum into velocity, add forces, apply boundaries."""

import taichi as ti

from rsmpm_ti.wall_nodes import extend, fold

SMALL_MASS = 1e-12
"""Nodes lighter than this share of a full cell hold nothing: their velocity would be round-off."""


@ti.kernel
def clear_nodes(sim: ti.template()):
    for i in ti.grouped(sim.nodes.mass):
        sim.nodes.mass[i] = 0.0
        sim.nodes.v[i] = ti.Vector.zero(float, sim.dim)
        sim.nodes.f[i] = ti.Vector.zero(float, sim.dim)


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
    for i in ti.grouped(sim.nodes.mass):
        sim.nodes.v[i] = velocity_of(sim, i, sim.nodes.v[i], factor)
    extend(sim.nodes.v_columns, sim.grid.walls)


@ti.kernel
def remap_velocity(sim: ti.template(), factor: float):
    """musl: w becomes velocity, u takes the step's, and mass, v and f are cleared for what the next step maps."""
    nodes = sim.nodes
    fold(nodes.w_columns, sim.grid.walls)
    for i in ti.grouped(nodes.mass):
        nodes.w[i] = velocity_of(sim, i, nodes.w[i], factor)
        nodes.u[i] = nodes.v[i]
        nodes.mass[i] = 0.0
        nodes.v[i] = ti.Vector.zero(float, sim.dim)
        nodes.f[i] = ti.Vector.zero(float, sim.dim)
    extend(nodes.w_columns, sim.grid.walls)


@ti.kernel
def update_nodes(sim: ti.template(), divide: ti.template(), dt: float, factor: float):
    """v_i <- v_i + dt (f_i/m_i + b), then boundaries, whose impulses and work go to the ledger.

    `divide`: v still holds momentum. Afterwards f holds the velocity change of the step.
    """
    nodes, ledger = sim.nodes, sim.ledger
    if ti.static(divide):
        fold(nodes.momentum_columns, sim.grid.walls)
    fold(nodes.f_columns, sim.grid.walls)
    for i in ti.grouped(nodes.mass):
        m = nodes.mass[i]
        v, dv = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
        if m > SMALL_MASS * sim.density * sim.grid.dx**sim.dim:
            inverse, v_old = 1.0 / m, nodes.v[i]
            if ti.static(divide):
                v_old *= inverse
            v = v_old + dt * inverse * nodes.f[i]
            if ti.static(sim.heavy):
                v += dt * ti.Vector(sim.acceleration)
            for b, boundary in ti.static(enumerate(sim.boundaries)):
                if boundary.holds(sim.grid.position(i), sim.grid.dx):
                    held = boundary.project(v, factor)
                    impulse = ti.cast(m * (held - v), ti.f64)
                    ledger.impulse[b] += impulse
                    ledger.work[b] += impulse.dot(ti.cast(held, ti.f64))
                    v = held
            dv = v - v_old
        nodes.v[i] = v
        nodes.f[i] = dv
        if ti.static(nodes.remap):
            nodes.w[i] = ti.Vector.zero(float, sim.dim)
    extend(nodes.v_columns, sim.grid.walls)
    extend(nodes.f_columns, sim.grid.walls)
