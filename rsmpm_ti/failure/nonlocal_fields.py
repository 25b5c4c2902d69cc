"""Mean stress, crack strain and slip over a length of the rock: spread to nodes, blurred along each axis, read back.

2D. A look for cracks needs them only near what is cracked or has tension of its own beyond the strength, since a mean
is no larger than the largest that it is taken over; the grid is averaged there, tile by tile, with the same sums. In a
scene of several rocks `sim` is the view of one, which has sums of its own, of its own particles.
"""

import taichi as ti

from rsmpm_ti.failure.of_rock import belongs
from rsmpm_ti.fields.nonlocal_sums import TILE
from rsmpm_ti.fields.parallel import over_particles
from rsmpm_ti.fields.stencil import coordinates, per_metre, weights_at
from rsmpm_ti.method.tensor_product import tensor_gradient, tensor_weight
from rsmpm_ti.rock.tensors import extreme_principals

RESULT, SOURCE = 2, 1
"""What is needed of a tile: means at its nodes, or only its sums for those of others; or 0."""

ROUNDING = 1e-3
"""Part of the strength below which own tension makes no mean that reaches it, whatever the precision."""


@ti.func
def needed(sim: ti.template(), i):
    """What is needed of the tile of node i."""
    return sim.nonlocal_sums.needed[i // TILE]


@ti.kernel
def need_all_tiles(sim: ti.template()):
    for tile in ti.grouped(sim.nonlocal_sums.needed):
        sim.nonlocal_sums.needed[tile] = RESULT


@ti.func
def need_of_tile(sim: ti.template(), tile):
    """By the hot tiles around it."""
    means, need = sim.nonlocal_sums, 0
    near, far = ti.static(means.result_tiles, means.result_tiles + means.source_tiles)
    for a in range(ti.max(tile[0] - far, 0), ti.min(tile[0] + far + 1, means.hot.shape[0])):
        for b in range(ti.max(tile[1] - far, 0), ti.min(tile[1] + far + 1, means.hot.shape[1])):
            if means.hot[a, b] == 1:
                away = ti.max(ti.abs(a - tile[0]), ti.abs(b - tile[1]))
                need = ti.max(need, ti.select(away <= near, RESULT, SOURCE))
    return need


@ti.kernel
def needed_tiles(sim: ti.template(), limit: float) -> ti.i32:
    """Find what is needed of each tile if means below `limit` [Pa] are of no interest; returns whether any is."""
    particles, means = sim.particles, sim.nonlocal_sums
    for tile in ti.grouped(means.hot):
        means.hot[tile] = 0
        means.any_hot[None] = 0
    for p in particles.mode:
        hot = particles.mode[p] != 0 or extreme_principals(particles.sigma[p])[0] >= (1.0 - ROUNDING) * limit
        if belongs(sim, p) and hot:
            means.hot[sim.grid.base(coordinates(sim, p, sim.grid.frame()), sim.shape) // TILE] = 1
            means.any_hot[None] = 1
    for tile in ti.grouped(means.needed):
        if means.any_hot[None] == 1:
            means.needed[tile] = need_of_tile(sim, tile)
    return means.any_hot[None]


@ti.kernel
def clear_nonlocal_sums(sim: ti.template()):
    zero = ti.Vector.zero(float, 7)
    for i in ti.grouped(sim.nonlocal_sums.sums):
        if needed(sim, i) > 0:
            sim.nonlocal_sums.sums[i] = zero
        sim.nonlocal_sums.peak[i] = 0.0
    for _ in range(1):
        sim.nonlocal_sums.count[None] = 0


@ti.func
def add_stress(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """sum w_ip V_p (sigma_p, 1, e_p, slip_p) to nodes; e: largest opening strain across the crack."""
    particles = sim.particles
    for p in range(start, stop):
        xi = coordinates(sim, p, sim.grid.frame())
        base = sim.grid.base(xi, sim.shape)
        if needed(sim, base) == 0 or not belongs(sim, p):
            continue
        w, dw = weights_at(sim, xi, base)
        sigma, V_p = particles.sigma[p], particles.volume[p] * sim.rock.after_failure.carrying_ratio(sim, p)
        strain, slip = particles.history.crack_strain_max[p][0], particles.history.slip[p]
        carried = V_p * ti.Vector([sigma[0], sigma[1], sigma[2], sigma[3], 1.0, strain, slip])
        for offset in ti.static(sim.stencil):
            i = base + ti.Vector(offset)
            sim.traversal.add(sim.nonlocal_sums.sums, i, tensor_weight(w, offset) * carried)


@ti.kernel
def spread_stress(sim: ti.template(), ticket: int):
    over_particles(sim, add_stress, None, 0.0, 0.0, ticket)


@ti.kernel
def blur(sim: ti.template(), source: ti.template(), target: ti.template(), axis: ti.template(), least: ti.template()):
    """Convolution of node sums with the filter's weights along one axis, where at least that much is needed."""
    reach = ti.static(sim.nonlocal_sums.reach)
    for i in ti.grouped(source):
        if needed(sim, i) < least:
            continue
        total = ti.Vector.zero(float, 7)
        for k in range(-reach, reach + 1):
            j = i + k * ti.Vector.unit(2, axis)
            if j[axis] >= 0 and j[axis] < sim.grid.nodes[axis]:
                total += sim.nonlocal_sums.filter_weights[k + reach] * source[j]
        target[i] = total


@ti.func
def mean_stress(sim: ti.template(), p):
    """Packed mean stress at a particle."""
    xi = coordinates(sim, p, sim.grid.frame())
    base = sim.grid.base(xi, sim.shape)
    w, dw = weights_at(sim, xi, base)
    total = ti.Vector.zero(float, 7)
    for offset in ti.static(sim.stencil):
        total += tensor_weight(w, offset) * sim.nonlocal_sums.sums[base + ti.Vector(offset)]
    return ti.Vector([total[0], total[1], total[2], total[3]]) / total[4]


@ti.func
def strain_of_band(sim: ti.template(), mean, slope):
    """(strain of a crack band at a place where the mean of it and its slope across are these, how much it is in it).

    Bazant & Lin (1988), J. Struct. Eng. 114:2493. What the mean makes of a band is highest in its middle and falls off
    as a Gaussian; the slope across tells how far away the middle is, so that all rows of a band lose strength together.
    Beyond half the band's width that fades, and beyond the whole of it there is none: the mean of a crack that gapes
    reaches far, but what cracks there is no part of it.
    """
    means = sim.nonlocal_sums
    away = slope * means.variance / ti.max(mean, 1e-30)
    part = ti.max(0.0, ti.min(1.0, 2.0 - 2.0 * away / sim.band))
    away = ti.min(away, 0.5 * sim.band)
    return ti.exp(0.5 * away * away / means.variance) * mean / means.band_fraction, part


@ti.kernel
def read_crack_strains(sim: ti.template()):
    """Crack strain and slip of each cracked particle if its band had the opening and the slip of the rock around.

    A crack opens along its normal. Of a slip its plane is not known, but it varies across it only: its slope is taken
    whole, and where that says that a particle is in no band, at a shear crack's end or in a crowd, its own slip counts.
    """
    particles = sim.particles
    for p in particles.mode:
        if particles.mode[p] != 0 and belongs(sim, p):
            xi = coordinates(sim, p, sim.grid.frame())
            base = sim.grid.base(xi, sim.shape)
            w, slopes = weights_at(sim, xi, base)
            dw = per_metre(sim, slopes, sim.grid.frame())
            volume, opened, slipped = 0.0, 0.0, 0.0
            opened_slope, slipped_slope = ti.Vector.zero(float, 2), ti.Vector.zero(float, 2)
            for offset in ti.static(sim.stencil):
                weighted = tensor_weight(w, offset) * sim.nonlocal_sums.sums[base + ti.Vector(offset)]
                volume += weighted[4]
                opened += weighted[5]
                slipped += weighted[6]
            opened, slipped = opened / volume, slipped / volume
            for offset in ti.static(sim.stencil):
                total = sim.nonlocal_sums.sums[base + ti.Vector(offset)]
                slope = tensor_gradient(w, dw, offset) / volume
                opened_slope += (total[5] - opened * total[4]) * slope
                slipped_slope += (total[6] - slipped * total[4]) * slope
            across = sim.grid.space_vector(opened_slope).dot(particles.history.crack_normal[p])
            strain, part = strain_of_band(sim, opened, ti.abs(across))
            slip, within = strain_of_band(sim, slipped, slipped_slope.norm())
            particles.crack_strain_nonlocal[p] = part * strain
            particles.slip_nonlocal[p] = within * slip + (1.0 - within) * particles.history.slip[p]


@ti.kernel
def mark_overloaded(sim: ti.template(), limit: float):
    """Which nodes have a mean sigma_1 of at least `limit` [Pa].

    The mean stress at a particle is a weighted mean of those at its nodes and sigma_1 is convex, so a particle without
    an overloaded node cannot be overloaded: most are spared the reading.
    """
    for i in ti.grouped(sim.nonlocal_sums.sums):
        total, overloaded = sim.nonlocal_sums.sums[i], 0
        if needed(sim, i) == RESULT and total[4] > 0.0:
            sigma = ti.Vector([total[0], total[1], total[2], total[3]])
            if extreme_principals(sigma)[0] >= limit * total[4]:
                overloaded = 1
        sim.nonlocal_sums.overloaded[i] = overloaded


@ti.func
def near_overloaded(sim: ti.template(), p):
    base = sim.grid.base(coordinates(sim, p, sim.grid.frame()), sim.shape)
    near = 0
    for offset in ti.static(sim.stencil):
        near |= sim.nonlocal_sums.overloaded[base + ti.Vector(offset)]
    return near == 1


def sum_nonlocal(sim) -> None:
    """Fill sim.nonlocal_sums.sums for `mean_stress` and `read_crack_strains`, of all particles of its rock."""
    need_all_tiles(sim)
    sum_needed(sim)


def sum_needed(sim) -> None:
    """The same in those tiles whose results are needed."""
    clear_nonlocal_sums(sim)
    spread_stress(sim, sim.traversal.ticket())
    blur(sim, sim.nonlocal_sums.sums, sim.nonlocal_sums.other, 0, SOURCE)
    blur(sim, sim.nonlocal_sums.other, sim.nonlocal_sums.sums, 1, RESULT)
