"""The only kernels that see particles and nodes together. They know no dimension, law or scheme by name.

Indices: p particle, i node, ip pair. Every pass over particles goes by spans (see traversal.py): within one, a run of
particles with the same base node keeps its node values in locals, loaded or added to the grid once per run.
"""

import taichi as ti

from rsmpm_ti.material import check_and_release, check_failure, update_stress
from rsmpm_ti.shape import fold_at_walls, tensor_gradient, tensor_weight
from rsmpm_ti.tensors import in_plane_times, isotropic


@ti.func
def weights_at(sim: ti.template(), xi, base):
    """Weights and gradients [width, dim] of a particle at grid coordinates xi, corrected at walls."""
    grid = sim.grid
    r = xi - base
    w = fold_at_walls(sim.shape.weights(r), base, grid.wall_lower, grid.wall_upper)
    dw = fold_at_walls(sim.shape.gradients(r), base, grid.wall_lower, grid.wall_upper)
    return w, dw


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
def gather(sim: ti.template(), field: ti.template(), base):
    """Node vectors of one stencil, [stencil, dim]."""
    local = ti.Matrix.zero(float, sim.size, sim.dim)
    for k, offset in ti.static(enumerate(sim.stencil)):
        value = field[base + ti.Vector(offset)]
        for d in ti.static(range(sim.dim)):
            local[k, d] = value[d]
    return local


@ti.func
def scatter(sim: ti.template(), field: ti.template(), base, local: ti.template()):
    """Add locals [stencil, dim] to the nodes of one stencil."""
    for k, offset in ti.static(enumerate(sim.stencil)):
        value = ti.Vector.zero(float, sim.dim)
        for d in ti.static(range(sim.dim)):
            value[d] = local[k, d]
        sim.traversal.add(field, base + ti.Vector(offset), value)


@ti.func
def scatter_mass(sim: ti.template(), base, local: ti.template()):
    for k, offset in ti.static(enumerate(sim.stencil)):
        sim.traversal.add(sim.nodes.mass, base + ti.Vector(offset), local[k])


@ti.func
def coordinates(sim: ti.template(), p):
    """Grid coordinates x/dx of a particle."""
    return sim.grid.local(sim.particles.reference[p] + sim.particles.u[p])


@ti.func
def same_run(sim: ti.template(), xi, base):
    """Whether a particle at grid coordinates xi shares the base node of the current run."""
    return (sim.grid.base(xi, sim.shape) == base).all()


@ti.func
def p2g_span(sim: ti.template(), start, stop, momentum: ti.template(), force: ti.template(), time):
    """m_i = sum w_ip m_p, (mv)_i = sum w_ip m_p v_p, f_i = -sum V_p (sigma_p - q + p) grad w_ip (paper eq. 7-9).

    Eq. 9 of the paper says deviatoric stress; the total stress is meant, and p is the confining pressure. A force field
    adds w_ip m_p b(X_p, time); a uniform body force is added at the nodes, where it costs less.
    """
    particles, nodes, grid = sim.particles, sim.nodes, sim.grid
    p = start
    xi = coordinates(sim, p)
    while p < stop:
        base = grid.base(xi, sim.shape)
        m = ti.Vector.zero(float, sim.size)
        mv, f = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        running = True
        while running:
            w, dw = weights_at(sim, xi, base)
            m_p = sim.density * particles.volume[p]
            V_p = particles.volume[p] * particles.J[p]
            sigma = particles.sigma[p]
            if ti.static(particles.viscous):
                sigma -= isotropic(particles.q[p], sigma.n)
            if ti.static(sim.confined):
                sigma += isotropic(sim.confinement, sigma.n)  # the pressure on every surface: confinement.py
            b_p = ti.Vector.zero(float, sim.dim)
            if ti.static(sim.driven and force):
                b_p = field_acceleration(sim, p, time)
            for k, offset in ti.static(enumerate(sim.stencil)):
                if ti.static(momentum):
                    m_ip = tensor_weight(w, offset) * m_p
                    v_ip = carried_velocity(sim, p, base + ti.Vector(offset) - xi)
                    m[k] += m_ip
                    for d in ti.static(range(sim.dim)):
                        mv[k, d] += m_ip * v_ip[d]
                if ti.static(force):
                    push = V_p * in_plane_times(sigma, tensor_gradient(w, dw, offset, grid.inv_dx))
                    if ti.static(sim.driven):
                        push -= tensor_weight(w, offset) * m_p * b_p
                    for d in ti.static(range(sim.dim)):
                        f[k, d] -= push[d]
            p += 1
            running = False
            if p < stop:
                xi = coordinates(sim, p)
                running = same_run(sim, xi, base)
        if ti.static(momentum):
            scatter_mass(sim, base, m)
            scatter(sim, nodes.v, base, mv)
        if ti.static(force):
            scatter(sim, nodes.f, base, f)


@ti.func
def field_acceleration(sim: ti.template(), p, time):
    """b(X_p, t) of the scene's force field [m/s^2]; mass scaling leaves its force unchanged."""
    return sim.lightness * sim.force_field.acceleration(sim.particles.reference[p], time)


@ti.func
def carried_velocity(sim: ti.template(), p, to_node):
    """Velocity that a particle carries to a node `to_node` cells away: with an affine matrix, v_p + C (x_i - x_p)."""
    v = sim.particles.v[p]
    if ti.static(sim.particles.affine):
        v += sim.particles.C[p] @ (to_node * sim.grid.dx)
    return v


@ti.kernel
def p2g(sim: ti.template(), momentum: ti.template(), force: ti.template(), colour: int, time: float):
    """Particles of one colour to nodes: mass and momentum, force, or both in one pass."""
    for t in range(sim.traversal.items):
        start, stop = sim.traversal.span_of_colour(t, colour)
        if stop > start:
            p2g_span(sim, start, stop, momentum, force, time)


@ti.func
def velocity_to_particle(sim: ti.template(), p, w, xi, base, v_i: ti.template(), dv_i: ti.template()):
    """New particle velocity, and affine matrix if carried, from node velocities [stencil, dim]."""
    particles = sim.particles
    v_pic, dv = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
    B = ti.Matrix.zero(float, sim.dim, sim.dim)
    for k, offset in ti.static(enumerate(sim.stencil)):
        w_ip = tensor_weight(w, offset)
        for d in ti.static(range(sim.dim)):
            v_pic[d] += w_ip * v_i[k, d]
            dv[d] += w_ip * dv_i[k, d]
            if ti.static(particles.affine):
                for e in ti.static(range(sim.dim)):
                    B[d, e] += w_ip * v_i[k, d] * (offset[e] - (xi[e] - base[e]))
    particles.v[p] = sim.transfer.to_particle(particles.v[p], v_pic, dv)
    if ti.static(particles.affine):
        D = spread(sim, w, xi - base)
        for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
            B[d, e] *= sim.grid.inv_dx / D[e]
        particles.C[p] = B


@ti.func
def move(sim: ti.template(), p, v_pic, dt, time, slot):
    """x_p <- x_p + dt v_pic, and the work of the body force."""
    particles, ledger = sim.particles, sim.ledger
    # not +=, which is an atomic add on a field: a locked exchange that also stops the next particle from starting
    particles.u[p] = particles.u[p] + dt * v_pic
    if ti.static(sim.heavy or sim.driven):
        # the velocity at the middle of the step: then a free fall's work is its kinetic energy to round-off
        b = ti.Vector(sim.acceleration)
        if ti.static(sim.driven):
            b += field_acceleration(sim, p, ti.cast(time, float) - dt)
        power = (v_pic - 0.5 * dt * b).dot(b) * sim.density * particles.volume[p]
        ledger.body_work[slot] += ti.cast(dt * power, ti.f64)


@ti.func
def remap_span(sim: ti.template(), start, stop):
    """musl: move velocity to particles and map their new momentum back with the same weights, in one pass."""
    particles, nodes, grid = sim.particles, sim.nodes, sim.grid
    p = start
    xi = coordinates(sim, p)
    while p < stop:
        base = grid.base(xi, sim.shape)
        v_i, dv_i = gather(sim, nodes.v, base), gather(sim, nodes.f, base)
        mv = ti.Matrix.zero(float, sim.size, sim.dim)
        running = True
        while running:
            w = fold_at_walls(sim.shape.weights(xi - base), base, grid.wall_lower, grid.wall_upper)
            velocity_to_particle(sim, p, w, xi, base, v_i, dv_i)
            m_p = sim.density * particles.volume[p]
            for k, offset in ti.static(enumerate(sim.stencil)):
                v_ip = carried_velocity(sim, p, base + ti.Vector(offset) - xi)
                m_ip = tensor_weight(w, offset) * m_p
                for d in ti.static(range(sim.dim)):
                    mv[k, d] += m_ip * v_ip[d]
            p += 1
            running = False
            if p < stop:
                xi = coordinates(sim, p)
                running = same_run(sim, xi, base)
        scatter(sim, nodes.w, base, mv)


@ti.kernel
def g2p_remap(sim: ti.template(), colour: int):
    for t in range(sim.traversal.items):
        start, stop = sim.traversal.span_of_colour(t, colour)
        if stop > start:
            remap_span(sim, start, stop)


@ti.func
def interpolate(sim: ti.template(), w, v_i: ti.template()):
    """sum w_ip v_i."""
    v = ti.Vector.zero(float, sim.dim)
    for k, offset in ti.static(enumerate(sim.stencil)):
        w_ip = tensor_weight(w, offset)
        for d in ti.static(range(sim.dim)):
            v[d] += w_ip * v_i[k, d]
    return v


@ti.func
def velocity_gradient(sim: ti.template(), w, dw, v_i: ti.template()):
    """L = sum v_i (x) grad w_ip."""
    L = ti.Matrix.zero(float, sim.dim, sim.dim)
    for k, offset in ti.static(enumerate(sim.stencil)):
        dw_ip = tensor_gradient(w, dw, offset, sim.grid.inv_dx)
        for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
            L[d, e] += v_i[k, d] * dw_ip[e]
    return L


@ti.func
def g2p_span(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """Nodes to particles: what = (velocity, position, stress), each if asked, at the weights of the step's start.

    Gradients come from nodes.w (nodes.v unless musl), positions from nodes.v.
    """
    nodes, grid = sim.nodes, sim.grid
    p = start
    xi = coordinates(sim, p)
    while p < stop:
        base = grid.base(xi, sim.shape)
        v_i, dv_i = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        w_i = ti.Matrix.zero(float, sim.size, sim.dim)
        if ti.static(what[1]):
            v_i = gather(sim, nodes.v, base)
        if ti.static(what[0]):
            dv_i = gather(sim, nodes.f, base)
        if ti.static(what[2]):
            w_i = gather(sim, nodes.w, base)
        running = True
        while running:
            w, dw = weights_at(sim, xi, base)
            if ti.static(what[0]):
                velocity_to_particle(sim, p, w, xi, base, v_i, dv_i)
            if ti.static(what[1]):
                move(sim, p, interpolate(sim, w, v_i), dt, time, slot)
            if ti.static(what[2]):
                sim.particles.L[p] = velocity_gradient(sim, w, dw, w_i)
            p += 1
            running = False
            if p < stop:
                xi = coordinates(sim, p)
                running = same_run(sim, xi, base)
    # loops of their own: the processor then overlaps several short chains of arithmetic instead of one long one
    if ti.static(what[2]):
        viscous = ti.cast(0.0, ti.f64)
        for p_moved in range(start, stop):
            viscous += ti.cast(update_stress(sim, p_moved, sim.particles.L[p_moved], dt), ti.f64)
        if ti.static(sim.particles.viscous):
            sim.ledger.viscous[slot] += viscous
    if ti.static(what[2] and sim.particles.breaks):
        for p_check in range(start, stop):
            if ti.static(sim.particles.cracks):
                check_and_release(sim, p_check, dt, time, slot)
            else:
                check_failure(sim, p_check, time, slot)


@ti.kernel
def g2p(sim: ti.template(), what: ti.template(), dt: float, time: ti.f64):
    for t in range(sim.traversal.all_items):
        start, stop, slot = sim.traversal.span(t)
        if stop > start:
            g2p_span(sim, start, stop, slot, what, dt, time)
