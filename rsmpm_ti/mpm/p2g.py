"""Particles to nodes: mass, momentum and force of the nodes, eq. 7 to 10 of the paper.

    m_i = sum_p w_ip m_p                                                        (8)
    (m v)_i = sum_p w_ip m_p v_p                                                (7)
    f_i = - sum_p V_p sigma_p . grad w_ip + sum_p w_ip m_p b_p                  (9) and (10)

Indices: p particle, i node, ip pair. The paper's N_Ip is w_ip here. Its eq. 9 says deviatoric stress; the total stress
is meant. Sums are taken run by run (see stencil.py) and row by row (see tensor_product.py).
"""

import taichi as ti

from rsmpm_ti.failure.of_rock import carried_stress, density_at
from rsmpm_ti.fields.stencil import MAX_RUN, coordinates, run_stop, scatter, scatter_mass, weights_and_gradients
from rsmpm_ti.method.tensor_product import row_gradient, row_weight
from rsmpm_ti.mpm.contact import find_gaps
from rsmpm_ti.rock.tensors import isotropic, unpack


@ti.func
def stress_on_nodes(sim: ti.template(), p):
    """V_p (sigma_p - q) + V p, packed; p is the confining pressure, which acts on every surface: confinement.py.

    V_p is the volume that carries stress, V all of it, with what cracks are open by.
    """
    particles = sim.particles
    carried = carried_stress(sim, p)
    if ti.static(sim.confined):
        carried += isotropic(sim.confinement * particles.volume[p] * particles.J[p], carried.n)
    return carried


@ti.func
def field_acceleration(sim: ti.template(), p, time):
    """b(X_p, t) of the scene's force field [m/s^2]; mass scaling leaves its force unchanged."""
    now = ti.cast(time, float)
    if ti.static(sim.grid.settles):
        now *= ti.cast(sim.grid.pace[None], float)
    return sim.lightness * sim.force_field.acceleration(sim.particles.reference[p], now)


@ti.func
def add_mass(sim: ti.template(), nodes: ti.template(), w: ti.template(), m_row, m: ti.template()):
    """m_i += w_ip m_p (paper eq. 8), for the nodes of one row; m_row = w_row m_p."""
    last = ti.static(sim.dim - 1)
    for k, _, i in ti.static(nodes):
        m[i] += m_row * w[k, last]


@ti.func
def spacing(sim: ti.template(), frame):
    """Of nodes along each axis [m]."""
    step = ti.Vector.zero(float, sim.dim)
    for d in ti.static(range(sim.dim)):
        step[d] = frame[d, 2]
    return step


@ti.func
def add_momentum(
    sim: ti.template(), nodes: ti.template(), w: ti.template(), p, xi, base, frame, m_row, mv_row, mv: ti.template()
):
    """(m v)_i += w_ip m_p v_p (paper eq. 7), for the nodes of one row; mv_row = w_row m_p v_p.

    A particle with an affine matrix C has the velocity v_p + C (x_i - x_p) at a node.
    """
    particles, last = sim.particles, ti.static(sim.dim - 1)
    for k, offset, i in ti.static(nodes):
        mv_node = mv_row
        if ti.static(particles.affine):
            mv_node += m_row * (particles.C[p] @ ((base + ti.Vector(offset) - xi) * spacing(sim, frame)))
        for e in ti.static(range(sim.dim)):
            mv[i, e] += mv_node[e] * w[k, last]


@ti.func
def add_force(
    sim: ti.template(), nodes: ti.template(), w: ti.template(), dw: ti.template(), t_row, t_last, f: ti.template()
):
    """f_i += w_ip m_p b_p - V_p sigma_p . grad w_ip (paper eq. 10 and 9) = -(t_row w_k + t_last w_k'), for one row."""
    last = ti.static(sim.dim - 1)
    for k, _, i in ti.static(nodes):
        for e in ti.static(range(sim.dim)):
            f[i, e] -= t_row[e] * w[k, last] + t_last[e] * dw[k, last]


@ti.func
def add_particle(
    sim: ti.template(),
    p,
    xi,
    base,
    frame,
    w: ti.template(),
    dw: ti.template(),
    time,
    m: ti.template(),
    mv: ti.template(),
    f: ti.template(),
):
    """Add one particle to node sums m [stencil], mv and f [stencil, dim].

    With w_ip = w_row w_k and grad w_ip = (w_k grad w_row, w_row w_k') (see tensor_product.py),

        V sigma . grad w_ip - w_ip m b = t_row w_k + t_last w_k',
        t_row = V sigma[:, :-1] . grad w_row - w_row m b,    t_last = w_row V sigma[:, -1].

    A uniform body force is added at the nodes, where it costs less.
    """
    last = ti.static(sim.dim - 1)
    m_p = density_at(sim, p) * sim.particles.volume[p]
    mv_p, sigma = m_p * sim.particles.v[p], sim.grid.along_grid(unpack(stress_on_nodes(sim, p)))
    body_force = m_p * field_acceleration(sim, p, time)
    for row, nodes in ti.static(sim.rows):
        w_row, dw_row = row_weight(w, row), row_gradient(w, dw, row)
        m_row, mv_row = w_row * m_p, w_row * mv_p
        t_row, t_last = -w_row * body_force, ti.Vector.zero(float, sim.dim)
        for e in ti.static(range(sim.dim)):
            t_last[e] = sigma[e, last] * w_row
            for d in ti.static(range(sim.dim - 1)):
                t_row[e] += sigma[e, d] * dw_row[d]
        add_mass(sim, nodes, w, m_row, m)
        add_momentum(sim, nodes, w, p, xi, base, frame, m_row, mv_row, mv)
        add_force(sim, nodes, w, dw, t_row, t_last, f)


@ti.func
def particles_to_nodes(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """Mass and momentum, force, or both, of particles [start, stop) to the nodes around their bases."""
    frame = sim.grid.frame()
    first = start
    while first < stop:
        last = run_stop(sim, first, stop)
        base = sim.grid.base_of(sim.particles.base[first])
        m = ti.Vector.zero(float, sim.size)
        mv, f = ti.Matrix.zero(float, sim.size, sim.dim), ti.Matrix.zero(float, sim.size, sim.dim)
        for k in range((last - first) & MAX_RUN):
            p = first + k
            xi = coordinates(sim, p, frame)
            w, dw = weights_and_gradients(sim, xi, base, frame)
            add_particle(sim, p, xi, base, frame, w, dw, time - what.force_lag * dt, m, mv, f)
        # what is not asked for ends here, and the compiler leaves its sums out
        if ti.static(what.momentum):
            scatter_mass(sim, base, m)
            scatter(sim, sim.nodes.v, base, mv)
            find_gaps(sim, first, last, base, frame)
        if ti.static(what.force):
            scatter(sim, sim.nodes.f, base, f)
        first = last
