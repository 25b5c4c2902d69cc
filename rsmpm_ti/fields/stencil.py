"""Between one particle, or a run of particles with the same base node, and the nodes of its stencil.

Node values of a run live in locals [stencil, dim], or [stencil] for mass: loaded or added to the grid once per run.
"""

import taichi as ti

from rsmpm_ti.method.shape import fold_at_walls
from rsmpm_ti.method.tensor_product import row_gradient, row_weight

MAX_RUN = 63
"""Most particles of a run: 2^n - 1. A loop over `(end - first) & MAX_RUN` of them tells LLVM that it is short; else it
interleaves four copies of its vector instructions, and runs of fewer than 16 particles get none of them."""


@ti.func
def coordinates(sim: ti.template(), p, frame):
    """Grid coordinates of a particle, in cells."""
    return sim.grid.local(sim.particles.reference[p] + sim.particles.u[p], frame)


@ti.func
def run_stop(sim: ti.template(), p, stop):
    """End of the run that begins at particle p: of those before `stop` with the same base node, at most MAX_RUN."""
    key = sim.particles.base[p]
    end, limit = p + 1, ti.min(stop, p + MAX_RUN)
    running = end < limit
    while running:
        running = False
        if sim.particles.base[end] == key:
            end += 1
            running = end < limit
    return end


@ti.func
def weights_at(sim: ti.template(), xi, base):
    """Weights and gradients [width, dim] of a particle at grid coordinates xi, corrected at walls."""
    grid = sim.grid
    r = xi - base
    w = fold_at_walls(sim.shape.weights(r), base, grid.wall_lower, grid.wall_upper)
    dw = fold_at_walls(sim.shape.gradients(r), base, grid.wall_lower, grid.wall_upper)
    return w, dw


@ti.func
def per_metre(sim: ti.template(), dw, frame):
    """Gradients [width, dim] in 1/m."""
    scaled = dw
    for d in ti.static(range(sim.dim)):
        for k in ti.static(range(sim.shape.width)):
            scaled[k, d] = dw[k, d] * frame[d, 1]
    return scaled


@ti.func
def weights_and_gradients(sim: ti.template(), xi, base, frame):
    """The same, gradients in 1/m; corrected here only if node values are not (see wall_nodes.py)."""
    w, dw = sim.shape.weights(xi - base), sim.shape.gradients(xi - base)
    if ti.static(sim.transfer.affine):
        w, dw = weights_at(sim, xi, base)
    return w, per_metre(sim, dw, frame)


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
def interpolate(sim: ti.template(), w, v_i: ti.template()):
    """sum w_ip v_i, as sum over rows of w_row (sum over k of w_k v_i)."""
    v, last = ti.Vector.zero(float, sim.dim), ti.static(sim.dim - 1)
    for row, stencil in ti.static(sim.rows):
        along = ti.Vector.zero(float, sim.dim)
        for k, _, i in ti.static(stencil):
            for d in ti.static(range(sim.dim)):
                along[d] += w[k, last] * v_i[i, d]
        v += row_weight(w, row) * along
    return v


@ti.func
def velocity_gradient(sim: ti.template(), w, dw, v_i: ti.template()):
    """L = sum v_i (x) grad w_ip, with grad w_ip = (w_k grad w_row, w_row w_k')."""
    L, last = ti.Matrix.zero(float, sim.dim, sim.dim), ti.static(sim.dim - 1)
    for row, stencil in ti.static(sim.rows):
        w_row, dw_row = row_weight(w, row), row_gradient(w, dw, row)
        value, slope = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
        for k, _, i in ti.static(stencil):
            for d in ti.static(range(sim.dim)):
                value[d] += w[k, last] * v_i[i, d]
                slope[d] += dw[k, last] * v_i[i, d]
        for d in ti.static(range(sim.dim)):
            L[d, last] += w_row * slope[d]
            for e in ti.static(range(sim.dim - 1)):
                L[d, e] += dw_row[e] * value[d]
    return L
