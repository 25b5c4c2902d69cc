"""Cell order: particles sorted by the base node of their stencil, refreshed only when too many have strayed."""

import numpy as np
import taichi as ti

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.fields.stencil import coordinates


@ti.kernel
def cell_keys(sim: ti.template()):
    grid = sim.grid
    for p in sim.particles.key:
        sim.particles.key[p] = grid.key(grid.base(coordinates(sim, p, grid.frame()), sim.shape))


@ti.kernel
def reorder(sim: ti.template()):
    """Permute every particle field by particles.order, one component after another through the scratch array."""
    particles = sim.particles
    for component in ti.static(particles.real_components):
        for p in particles.order:
            particles.scratch[p] = component[particles.order[p]]
        for p in particles.order:
            component[p] = particles.scratch[p]
    for component in ti.static(particles.whole_components):
        for p in particles.order:
            particles.key[p] = component[particles.order[p]]
        for p in particles.order:
            component[p] = particles.key[p]


def sort_particles(sim: Simulation) -> None:
    """Put particles into cell order; ties keep their order, so the result does not depend on threads.

    Dropped particles, which have no volume, come last, and passes end before them.
    """
    cell_keys(sim)
    key = sim.particles.key.to_numpy()
    gone = sim.particles.volume.to_numpy() == 0.0 if sim.loses else np.zeros(len(key), dtype=bool)
    order = np.lexsort((key, gone)).astype(np.int32)
    if not np.array_equal(order, np.arange(len(order))):
        sim.particles.order.from_numpy(order)
        reorder(sim)
        cell_keys(sim)
    sim.traversal.refresh(first_rows(sim))
    sim.nodes.forget_empty()


def first_rows(sim: Simulation) -> np.ndarray:
    """Row of cells along the first axis in which each particle was at the last sort, ascending; not of dropped ones."""
    key = sim.particles.key.to_numpy()
    if sim.loses:
        key = key[: np.count_nonzero(sim.particles.volume.to_numpy())]
    return key // int(np.prod(sim.grid.nodes[1:]))
