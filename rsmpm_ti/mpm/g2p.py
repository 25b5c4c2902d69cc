"""Nodes to particles: velocity, position and velocity gradient from the nodes, then stress and the failure check.

Indices: p particle, i node, ip pair. Eq. 6 of the paper gives a particle the nodes' displacement; velocity goes the
same way: v_pic = sum_i w_ip v_i, and its gradient is L = sum_i v_i (x) grad w_ip.
"""

import taichi as ti

from rsmpm_ti.failure.of_rock import check, density_at, needs_check, strain_step
from rsmpm_ti.fields.stencil import (
    MAX_RUN,
    coordinates,
    gather,
    interpolate,
    run_stop,
    velocity_gradient,
    weights_and_gradients,
)
from rsmpm_ti.method.tensor_product import tensor_weight
from rsmpm_ti.mpm.local_damping import damped
from rsmpm_ti.mpm.p2g import field_acceleration


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
def velocity_to_particle(sim: ti.template(), p, w, xi, base, frame, v_i: ti.template(), dv_i: ti.template(), slot):
    """New particle velocity, and affine matrix if carried, from node velocities [stencil, dim].

    Returns v_pic - (v_new - v_old)/2, by which `body_work` counts, and the energy per mass that a flip below 1 takes:
    (v_flip - v).(v_old + v_new)/2, v being the mixed and v_flip the unmixed velocity.
    """
    particles = sim.particles
    v_pic, dv = interpolate(sim, w, v_i), interpolate(sim, w, dv_i)
    v_old = particles.v[p]
    mixed = sim.transfer.to_particle(v_old, v_pic, dv)
    v_new = damped(sim, p, v_old, mixed, dv, slot)
    particles.v[p] = v_new
    if ti.static(particles.affine):
        B, D = ti.Matrix.zero(float, sim.dim, sim.dim), spread(sim, w, xi - base)
        for k, offset in ti.static(enumerate(sim.stencil)):
            for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
                B[d, e] += tensor_weight(w, offset) * v_i[k, d] * (offset[e] - (xi[e] - base[e]))
        for d, e in ti.static(ti.ndrange(sim.dim, sim.dim)):
            B[d, e] *= frame[e, 1] / D[e]
        particles.C[p] = B
    return v_pic - 0.5 * (v_new - v_old), 0.5 * (v_old + dv - mixed).dot(v_old + v_new)


@ti.func
def body_work(sim: ti.template(), p, v_middle, dt, time):
    """Work of the body force on a particle in the step that ends at `time` [J]:

        dW = m b . (dx - dt (v_new - v_old)/2),    dx = dt v_pic,    b at the step's beginning.

    The step takes positions along by its new velocity, so that dx is half a step ahead of the kinetic energy. Where b
    is constant the second term sums to -dt m b . (v_end - v_start)/2: between two states of rest W = m b . u, force
    times displacement, whatever the transfer does on the way, and at rest nothing is booked. Where the particle moves
    with its nodes, v_pic = v_new, dW = dt m b . (v_old + v_new)/2 is what b adds to the kinetic energy: free fall is
    exact. Where b changes, the sum by parts is that of (b_old + b_new)/2 . dx: the trapezoidal rule, as at platens.
    With mass scaling m grows and b shrinks by the same factor, and W is that of the true weight.
    """
    b = ti.Vector(sim.acceleration) + field_acceleration(sim, p, time - dt)
    return ti.cast(dt * v_middle.dot(b) * density_at(sim, p) * sim.particles.volume[p], ti.f64)


@ti.func
def book_body_work(sim: ti.template(), slot, work):
    if ti.static(sim.loaded):
        sim.ledger.body_work[slot] = sim.ledger.body_work[slot] + work


@ti.func
def book_mixing(sim: ti.template(), slot, lost):
    if ti.static(sim.mixes):
        sim.ledger.mixed[slot] = sim.ledger.mixed[slot] + lost


@ti.func
def nodes_to_particles(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """v_p, x_p <- x_p + dt v_pic, and L = grad v, each if asked, at the weights of the step's start."""
    particles, nodes = sim.particles, sim.nodes
    work, lost = ti.cast(0.0, ti.f64), ti.cast(0.0, ti.f64)
    frame = sim.grid.start_frame()
    first = start
    while first < stop:
        last = run_stop(sim, first, stop)
        base = sim.grid.base_of(particles.base[first])
        v_i, dv_i = gather(sim, nodes.v_moving, base), gather(sim, nodes.f, base)
        w_i = gather(sim, nodes.v_remapped, base)
        for k in range((last - first) & MAX_RUN):
            p = first + k
            xi = coordinates(sim, p, frame)
            w, dw = weights_and_gradients(sim, xi, base, frame)
            if ti.static(what.stress):
                particles.L[p] = sim.grid.space_gradient(velocity_gradient(sim, w, dw, w_i))
            if ti.static(what.velocity):
                v_middle, taken = velocity_to_particle(sim, p, w, xi, base, frame, v_i, dv_i, slot)
                work += body_work(sim, p, v_middle, dt, time)
                lost += ti.cast(taken * density_at(sim, p) * particles.volume[p], ti.f64)
            if ti.static(what.position):
                v_pic = interpolate(sim, w, v_i)
                # not +=, which is an atomic add on a field
                particles.u[p] = particles.u[p] + dt * v_pic
        first = last
    if ti.static(what.velocity):
        book_body_work(sim, slot, work)
        book_mixing(sim, slot, lost)


@ti.func
def new_stress(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """Stress, J and the failure check of every particle, from L."""
    viscous = ti.cast(0.0, ti.f64)
    found = 0
    for p in range(start, stop):
        viscous += ti.cast(strain_step(sim, p, sim.particles.L[p], dt), ti.f64)
        if ti.static(sim.particles.breaks):
            found += needs_check(sim, p)
    sim.ledger.viscous[slot] = sim.ledger.viscous[slot] + viscous
    if ti.static(sim.particles.breaks):
        if ti.static(sim.grid.settles):
            found *= sim.particles.breaking[None]
        if found > 0:  # else no particle here has failed or is about to
            for p in range(start, stop):
                check(sim, p, dt, time, slot)
