"""The only kernels that see particles and nodes together. They know no dimension, law or scheme by name.

Indices: p particle, i node, ip pair. Every pass goes over spans of particles in cell order (see parallel.py), and a
span in blocks that stay in the processor's nearest memory, a loop for each thing done to a block: over particles of a
run where node values are needed (see stencil.py), else over all of the block. Such a loop without branches, whose node
values are locals, is what LLVM turns into vector instructions; a branch or an atomic in it is what stops that, and so
is a loop that is the first in its scope to touch a field. That is why `traversal.span` is called in the scope of the
pass.
"""

import taichi as ti

from rsmpm_ti.failure.stress_update import check_failure, must_check, update_stress
from rsmpm_ti.fields.stencil import (
    MOST_RUN,
    coordinates,
    find_bases,
    gather,
    interpolate,
    run_stop,
    scatter,
    scatter_mass,
    velocity_gradient,
    weights_and_gradients,
)
from rsmpm_ti.method.tensor_product import row_gradient, row_weight, tensor_weight
from rsmpm_ti.mpm.nodes import new_velocity, velocity_after_remap
from rsmpm_ti.rock.tensors import isotropic, unpack

BLOCK = 256
"""Particles of a block: some 40 kB."""


@ti.func
def spread(sim: ti.template(), w, r):
    """Diagonal of the APIC inertia D/dx^2 from the weights themselves: exact for every shape, beside walls too."""
    D = ti.Vector.zero(float, sim.dim)
    for k in ti.static(range(sim.shape.width)):
        for d in ti.static(range(sim.dim)):
            D[d] += w[k, d] * (k - r[d]) ** 2
    # D is negative for a particle pressed beyond a wall, and only then; it vanishes on the wall itself
    return ti.select(ti.abs(D) > 1e-6, D, 1e-6)


@ti.func
def stress_on_nodes(sim: ti.template(), p):
    """V_p (sigma_p - q + p), packed; p is the confining pressure, which acts on every surface: confinement.py."""
    particles = sim.particles
    sigma = particles.sigma[p]
    if ti.static(particles.viscous):
        sigma -= isotropic(particles.q[p], sigma.n)
    if ti.static(sim.confined):
        sigma += isotropic(sim.confinement, sigma.n)
    return particles.volume[p] * particles.J[p] * sigma


@ti.func
def field_acceleration(sim: ti.template(), p, time):
    """b(X_p, t) of the scene's force field [m/s^2]; mass scaling leaves its force unchanged."""
    return sim.lightness * sim.force_field.acceleration(sim.particles.reference[p], ti.cast(time, float))


@ti.func
def add_to_nodes(
    sim: ti.template(), p, xi, base, what: ti.template(), time, m: ti.template(), mv: ti.template(), f: ti.template()
):
    """Add one particle to node sums m [stencil], mv and f [stencil, dim]: those asked for by what = (m, mv, f).

    m_i = sum w_ip m_p, (mv)_i = sum w_ip m_p v_p, with an affine matrix v_p + C (x_i - x_p), and f_i = sum w_ip m_p
    b(X_p, time) - sum V_p (sigma_p - q + p) grad w_ip (paper eq. 7-9). Eq. 9 of the paper says deviatoric stress; the
    total stress is meant. What nodes of a row share is computed once.
    """
    particles, last = sim.particles, ti.static(sim.dim - 1)
    w, dw = weights_and_gradients(sim, xi, base)
    m_p = sim.density * particles.volume[p]
    momentum, sigma = m_p * particles.v[p], unpack(stress_on_nodes(sim, p))
    weight = ti.Vector.zero(float, sim.dim)
    if ti.static(sim.driven and what[2]):
        weight = m_p * field_acceleration(sim, p, time)
    for row, stencil in ti.static(sim.rows):
        w_row, dw_row = row_weight(w, row), row_gradient(w, dw, row)
        m_row, mv_row = w_row * m_p, w_row * momentum
        across, along = -w_row * weight, ti.Vector.zero(float, sim.dim)
        for e in ti.static(range(sim.dim)):
            along[e] = sigma[e, last] * w_row
            for d in ti.static(range(sim.dim - 1)):
                across[e] += sigma[e, d] * dw_row[d]
        for k, offset, i in ti.static(stencil):
            if ti.static(what[0]):
                m[i] += m_row * w[k, last]
            if ti.static(what[1]):
                mv_ip = mv_row
                if ti.static(particles.affine):
                    mv_ip += m_row * (particles.C[p] @ ((base + ti.Vector(offset) - xi) * sim.grid.dx))
                for e in ti.static(range(sim.dim)):
                    mv[i, e] += mv_ip[e] * w[k, last]
            if ti.static(what[2]):
                for e in ti.static(range(sim.dim)):
                    f[i, e] -= across[e] * w[k, last] + along[e] * dw[k, last]


@ti.func
def particles_to_nodes(sim: ti.template(), start, stop, what: ti.template(), time):
    """what = (mass, momentum, force). A uniform body force is added at the nodes, where it costs less."""
    first = start
    while first < stop:
        end = run_stop(sim, first, stop)
        base = sim.grid.base_of(sim.particles.base[first])
        m = ti.Vector.zero(float, sim.size)
        mv, f = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        for k in range((end - first) & MOST_RUN):
            p = first + k
            add_to_nodes(sim, p, coordinates(sim, p), base, what, time, m, mv, f)
        if ti.static(what[0]):
            scatter_mass(sim, base, m)
        if ti.static(what[1]):
            scatter(sim, sim.nodes.v, base, mv)
        if ti.static(what[2]):
            scatter(sim, sim.nodes.f, base, f)
        first = end


@ti.kernel
def p2g(sim: ti.template(), momentum: ti.template(), force: ti.template(), time: ti.f64, ticket: int):
    """Particles to nodes: mass and momentum, force, or both in one pass."""
    ti.loop_config(serialize=sim.traversal.serial, block_dim=sim.traversal.block)
    for t in range(sim.traversal.items):
        if t % sim.traversal.stride == 0:
            for part in range(sim.traversal.parts):
                first, stop, _ = sim.traversal.span(t, part, ticket)
                while first < stop:
                    last = ti.min(first + BLOCK, stop)
                    find_bases(sim, first, last)
                    particles_to_nodes(sim, first, last, (momentum, momentum, force), time)
                    first = last
                sim.traversal.done(t, part, ticket)


@ti.func
def velocity_to_particle(sim: ti.template(), p, w, xi, base, v_i: ti.template(), dv_i: ti.template()):
    """New particle velocity, and affine matrix if carried, from node velocities [stencil, dim]."""
    particles = sim.particles
    v_pic, dv = interpolate(sim, w, v_i), interpolate(sim, w, dv_i)
    particles.v[p] = sim.transfer.to_particle(particles.v[p], v_pic, dv)
    if ti.static(particles.affine):
        B, D = ti.Matrix.zero(float, sim.dim, sim.dim), spread(sim, w, xi - base)
        for k, offset in ti.static(enumerate(sim.stencil)):
            for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
                B[d, e] += tensor_weight(w, offset) * v_i[k, d] * (offset[e] - (xi[e] - base[e]))
        for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
            B[d, e] *= sim.grid.inv_dx / D[e]
        particles.C[p] = B


@ti.func
def remap_pass(sim: ti.template(), ticket):
    """musl: new velocities for particles, and their momentum back to the nodes with the same weights, in one pass."""
    particles, nodes = sim.particles, sim.nodes
    ti.loop_config(serialize=sim.traversal.serial, block_dim=sim.traversal.block)
    for t in range(sim.traversal.items):
        if t % sim.traversal.stride == 0:
            for part in range(sim.traversal.parts):
                first, stop, _ = sim.traversal.span(t, part, ticket)
                while first < stop:
                    last = run_stop(sim, first, stop)
                    base = sim.grid.base_of(particles.base[first])
                    v_i, dv_i = gather(sim, nodes.v, base), gather(sim, nodes.f, base)
                    m = ti.Vector.zero(float, sim.size)
                    mv, f = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
                    for k in range((last - first) & MOST_RUN):
                        p = first + k
                        xi = coordinates(sim, p)
                        w, dw = weights_and_gradients(sim, xi, base)
                        velocity_to_particle(sim, p, w, xi, base, v_i, dv_i)
                        add_to_nodes(sim, p, xi, base, (False, True, False), 0.0, m, mv, f)
                    scatter(sim, nodes.w, base, mv)
                    first = last
                sim.traversal.done(t, part, ticket)


@ti.func
def body_work(sim: ti.template(), p, v_pic, dt, time):
    """Work of the body force in a step [J]: the velocity at the middle of the step makes that of a free fall its
    kinetic energy to round-off."""
    b = ti.Vector(sim.acceleration)
    if ti.static(sim.driven):
        b += field_acceleration(sim, p, time - dt)
    return ti.cast(dt * (v_pic - 0.5 * dt * b).dot(b) * sim.density * sim.particles.volume[p], ti.f64)


@ti.func
def nodes_to_particles(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """v_p, x_p <- x_p + dt v_pic, and L = grad v, each if asked, at the weights of the step's start.

    Gradients come from nodes.w, positions from nodes.u: both are nodes.v unless musl.
    """
    particles, nodes, grid = sim.particles, sim.nodes, sim.grid
    work = ti.cast(0.0, ti.f64)
    first = start
    while first < stop:
        last = run_stop(sim, first, stop)
        base = grid.base_of(particles.base[first])
        v_i, dv_i = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        w_i = ti.Matrix.zero(float, sim.size, sim.dim)
        if ti.static(what.velocity):
            dv_i = gather(sim, nodes.f, base)
        if ti.static(what.position):
            v_i = gather(sim, nodes.u, base)
        if ti.static(what.stress):
            w_i = gather(sim, nodes.w, base)
        for k in range((last - first) & MOST_RUN):
            p = first + k
            xi = coordinates(sim, p)
            w, dw = weights_and_gradients(sim, xi, base)
            if ti.static(what.stress):
                particles.L[p] = velocity_gradient(sim, w, dw, w_i)
            if ti.static(what.velocity):
                velocity_to_particle(sim, p, w, xi, base, v_i, dv_i)
            if ti.static(what.position):
                v_pic = interpolate(sim, w, v_i)
                # not +=, which is an atomic add on a field
                particles.u[p] = particles.u[p] + dt * v_pic
                if ti.static(sim.heavy or sim.driven):
                    work += body_work(sim, p, v_pic, dt, time)
        first = last
    if ti.static(what.position and (sim.heavy or sim.driven)):
        sim.ledger.body_work[slot] = sim.ledger.body_work[slot] + work


@ti.func
def new_stress(sim: ti.template(), start, stop, slot, dt, time):
    """Stress, J and the failure check of every particle, from L."""
    viscous = ti.cast(0.0, ti.f64)
    found = 0
    for p in range(start, stop):
        viscous += ti.cast(update_stress(sim, p, sim.particles.L[p], dt), ti.f64)
        if ti.static(sim.particles.breaks):
            found += must_check(sim, p)
    if ti.static(sim.particles.viscous):
        sim.ledger.viscous[slot] = sim.ledger.viscous[slot] + viscous
    if ti.static(sim.particles.breaks):
        if found > 0:  # else no particle here has failed or is about to
            for p in range(start, stop):
                check_failure(sim, p, dt, time, slot)


@ti.func
def particle_pass(sim: ti.template(), what: ti.template(), dt, time, ticket):
    """Nodes to particles, and back to nodes if asked while they are at hand; `time` at the step's end.

    `what.force` alone: the force of the new stress, at the weights of the step's start; with `what.momentum`, all that
    the next step needs, at the particles' new places.
    """
    ti.loop_config(serialize=sim.traversal.serial, block_dim=sim.traversal.block)
    for t in range(sim.traversal.items):
        if t % sim.traversal.stride == 0:
            for part in range(sim.traversal.parts):
                first, stop, slot = sim.traversal.span(t, part, ticket)
                while first < stop:
                    last = ti.min(first + BLOCK, stop)
                    nodes_to_particles(sim, first, last, slot, what, dt, time)
                    if ti.static(what.stress):
                        new_stress(sim, first, last, slot, dt, time)
                    if ti.static(what.momentum):
                        find_bases(sim, first, last)
                        particles_to_nodes(sim, first, last, (True, True, True), time)
                    elif ti.static(what.force):
                        particles_to_nodes(sim, first, last, (False, False, True), time - dt)
                    first = last
                sim.traversal.done(t, part, ticket)


@ti.kernel
def g2p(sim: ti.template(), what: ti.template(), dt: float, time: ti.f64, ticket: int):
    particle_pass(sim, what, dt, time, ticket)


@ti.kernel
def musl_step(sim: ti.template(), what: ti.template(), dt: float, factor: float, time: ti.f64, ticket: int):
    """A whole step: one launch instead of four, each of which costs 0.1 ms. Takes two tickets."""
    new_velocity(sim, True, dt, factor)
    remap_pass(sim, ticket)
    velocity_after_remap(sim, factor)
    particle_pass(sim, what, dt, time, ticket + 1)
