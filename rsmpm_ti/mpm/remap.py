"""musl: the momentum of particles with their new velocities, back to the nodes with the same weights.

Velocity gradients then come from velocities that the particles have, not from those that the nodes had: Sulsky, Zhou &
Schreyer (1995), sec. 3.
"""

import taichi as ti

from rsmpm_ti.fields.stencil import MAX_RUN, coordinates, gather, run_stop, scatter, weights_and_gradients
from rsmpm_ti.mpm.contact import clear_gaps
from rsmpm_ti.mpm.g2p import body_work, book_body_work, book_mixing, velocity_to_particle
from rsmpm_ti.mpm.nodes import book_stopping, clear_node, may_be_held, over_nodes, velocity_of
from rsmpm_ti.mpm.p2g import add_particle
from rsmpm_ti.mpm.wall_nodes import extend, fold


@ti.func
def remap_span(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """New velocities for particles, and their momentum to v_remapped, in one go over each run."""
    nodes = sim.nodes
    frame = sim.grid.start_frame()
    work, lost = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    first = start
    while first < stop:
        last = run_stop(sim, first, stop)
        base = sim.grid.base_of(sim.particles.base[first])
        v_i, dv_i = gather(sim, nodes.v, base), gather(sim, nodes.f, base)
        m = ti.Vector.zero(float, sim.size)
        mv, f = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        for k in range((last - first) & MAX_RUN):
            p = first + k
            xi = coordinates(sim, p, frame)
            w, dw = weights_and_gradients(sim, xi, base, frame)
            v_middle, taken = velocity_to_particle(sim, p, w, xi, base, frame, v_i, dv_i, slot)
            work += body_work(sim, p, v_middle, dt, time)
            lost += ti.cast(taken * sim.density * sim.particles.volume[p], ti.f64)
            add_particle(sim, p, xi, base, frame, w, dw, 0.0, m, mv, f)
        # mass is the same, and force comes from the new stress: the compiler leaves their sums out
        scatter(sim, nodes.v_remapped, base, mv)
        first = last
    book_body_work(sim, slot, work)
    book_mixing(sim, slot, lost)


@ti.func
def remapped_velocity(sim: ti.template(), i, dt, factor):
    nodes = sim.nodes
    brought = nodes.v_remapped[i]
    held = velocity_of(sim, i, brought, factor)
    nodes.v_remapped[i] = held
    if ti.static(nodes.books_stopping):
        if may_be_held(sim, i):
            book_stopping(sim, i, nodes.v[i], nodes.f[i], brought, held, dt, factor)
    nodes.v_moving[i] = nodes.v[i]
    clear_node(sim, i, dt, factor)


@ti.func
def velocity_after_remap(sim: ti.template(), dt: ti.template(), factor: ti.template()):
    """v_remapped becomes velocity, v_moving takes the step's; mass, v and f are cleared for the next step's sums."""
    clear_gaps(sim)
    fold(sim.nodes.v_remapped_columns, sim.grid.walls)
    over_nodes(sim, remapped_velocity, dt, factor)
    extend(sim.nodes.v_remapped_columns, sim.grid.walls)
