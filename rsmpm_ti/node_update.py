"""Kernels that see nodes only: clear them, turn momentum into velocity, add forces, apply boundaries."""

import taichi as ti

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


@ti.kernel
def momentum_to_velocity(sim: ti.template(), field: ti.template(), factor: float):
    """v_i = (mv)_i / m_i and boundaries, for momentum that is mapped apart from force (usf, and musl's second map)."""
    for i in ti.grouped(sim.nodes.mass):
        m = sim.nodes.mass[i]
        v = ti.Vector.zero(float, sim.dim)
        if m > SMALL_MASS * sim.density * sim.grid.dx**sim.dim:
            v = hold(sim, i, field[i] / m, factor)
        field[i] = v


@ti.kernel
def update_nodes(sim: ti.template(), divide: ti.template(), dt: float, factor: float):
    """v_i <- v_i + dt (f_i/m_i + b), then boundaries, whose impulses and work go to the ledger.

    `divide`: v still holds momentum. Afterwards f holds the velocity change of the step.
    """
    nodes, ledger = sim.nodes, sim.ledger
    for i in ti.grouped(nodes.mass):
        m = nodes.mass[i]
        v, dv = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
        if m > SMALL_MASS * sim.density * sim.grid.dx**sim.dim:
            v_old = nodes.v[i]
            if ti.static(divide):
                v_old /= m
            v = v_old + dt * nodes.f[i] / m
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
