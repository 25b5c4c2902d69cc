"""What a run will take of memory, by the scene alone, and whether this machine has it.

Memory is that of the two processes of a run, the one that solves and the one that paints: Python with its libraries,
the fields, and copies of the particles on their way to files. Measured as the largest resident memory of runs of 20 000
to 500 000 particles, on Linux.
"""

import math

import numpy as np

from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.spec.bodies.rocks import variables_of
from rsmpm_ti.spec.review.machine import address_space, free_memory
from rsmpm_ti.spec.review.placement import measure

SOLVER_MB, NONLOCAL_MB, PAINTER_MB = {2: 255.0, 3: 300.0}, 20.0, 325.0
"""Largest resident memory of a run of no particles: Python, Taichi and its compiler, by dimension; what kernels of a
nonlocal mean add; the process that paints."""

COPIES, PAINTED = {2: 125, 3: 165}, {2: 130, 3: 65}
"""Numbers of 8 bytes per particle in the copies that are there at one time in the process that solves and in the one
that paints, by dimension; in 3D it shows a slab."""

SEEDING = 120.0
"""Bytes for each place in the box around a body at which a particle might be seeded."""

VIRTUAL_MB = 1900.0
"""What a process asks for beyond what it fills: stacks of threads, and Taichi's gigabyte for its fields."""

LIKELY = 0.8
"""Of the particles that a body's area says, before they are seeded."""

BLOCK = 8
"""Cells per axis of a block of the sparse grid."""

POINTER = 2
"""Numbers of 8 bytes for each place of a block, also of one that is not there."""

SPARSE_PAYS = 0.03
"""Filled fraction of the grid below which a step is shorter on the sparse grid: `bench fill`."""


def check_seeding(scene) -> None:
    """Refuse what this machine surely cannot hold, before its particles are seeded."""
    places = likely = 0.0
    for body in scene.bodies:
        low, high = body.region.bounds()
        per_volume = (body.seeding.particles_per_axis / scene.domain.dx) ** scene.dim
        places += math.prod(high - low) * per_volume
        area = measure(body.region)
        likely += 0.0 if math.isnan(area) else LIKELY * area * per_volume
    _check(scene, likely, SEEDING * places)


def check_memory(scene, count: int) -> None:
    """Refuse what this machine cannot hold, before fields are allocated. count: particles."""
    _check(scene, count, 0.0)


def _check(scene, count: float, seeding: float) -> None:
    solver, painter = memory(scene, count)
    needed, free = max(solver + painter, seeding), free_memory()
    if needed > free:
        _refuse(scene, count, needed, free, "free here")
    # each process has the whole of what `ulimit` leaves
    needed, free = max(solver, painter, seeding) + 1e6 * VIRTUAL_MB, address_space()
    if needed > free:
        _refuse(scene, count, needed, free, "that ulimit leaves to a process")


def _refuse(scene, count: float, needed: float, free: float, whose: str) -> None:
    nodes = math.prod(scene.domain.node_counts)
    allowed = (
        f"such that {count:.3g} particles on {nodes:.3g} nodes, about {needed / 1e9:.3g} GB, fit in the "
        f"{free / 1e9:.3g} GB {whose}"
    )
    remedy = "or take fewer particles_per_axis"
    if memory_of_nodes(scene, count) > 0.5 * needed:
        sparse = use_sparse_grid(scene, count)
        remedy = "or take a smaller domain" if sparse else "or take domain.grid = sparse, or a smaller domain"
    raise refuse("domain.dx", scene.domain.dx, allowed, remedy)


def memory(scene, count: float) -> tuple[float, float]:
    """Largest resident memory of the process that solves and of the one that paints [bytes]; count: particles."""
    acts = any(averaging(scene))
    held = 8.0 * count
    fields = memory_of_particles(scene, count) + memory_of_nodes(scene, count)
    solver = 1e6 * (SOLVER_MB[scene.dim] + NONLOCAL_MB * acts) + fields + COPIES[scene.dim] * held
    return solver, 1e6 * PAINTER_MB + PAINTED[scene.dim] * held


def averaging(scene) -> list[bool]:
    """Of each rock, whether something is averaged over a length of it."""
    return [rock.criterion.breaks and rock.nonlocal_mean.acts for rock in scene.rocks]


def memory_of_particles(scene, count: float) -> float:
    """Bytes of the fields of so many particles and of their failure events, in double precision."""
    rocks, dim = scene.rocks, scene.dim
    packed = PACKED_LENGTH[dim]
    # reference, u, v; sigma; L; J, volume and room for sorting
    reals = 3 * dim + packed + dim * dim + 3
    reals += dim * dim * scene.transfer.affine
    reals += any(rock.viscosity.acts for rock in rocks) + any(rock.heterogeneity.varies for rock in rocks)
    whole = 4 + (len(rocks) > 1)  # id, key, base, order; rock
    event = 0
    if scene.breaks:
        laws, nonlocal_fields = [rock.after_failure for rock in rocks if rock.criterion.breaks], 5 + 2 * dim
        history = variables_of(scene)
        whole += 1 + sum(v.whole for v in history)
        reals += sum(dim if v.per_axis else 1 for v in history if not v.whole)
        reals += nonlocal_fields * any(averaging(scene))
        oriented = any(law.oriented for law in laws)
        event = max(law.max_events for law in laws) * (8 * (4 + dim + dim * oriented) + 4 * 2)
    return count * (8 * reals + 4 * whole + event)


def memory_of_nodes(scene, count: float) -> float:
    """Bytes of the fields of all nodes, of the sparse grid where it has material, in double precision."""
    reals, nodes = 1 + scene.dim * (4 if scene.order == "musl" else 2), math.prod(scene.domain.node_counts)
    means = (2 * 7 + 1.5) * sum(averaging(scene))
    if not use_sparse_grid(scene, count):
        return 8.0 * (reals + means) * nodes
    edge = BLOCK * scene.domain.dx
    blocks = sum(
        math.prod(np.ceil((np.asarray(high) - np.asarray(low)) / edge) + 2.0)
        for low, high in (body.region.bounds() for body in scene.bodies)
    )
    places = math.prod(power_of_two(-(-n // BLOCK)) for n in scene.domain.node_counts)
    return 8.0 * (reals * BLOCK**scene.dim * min(blocks, places) + POINTER * places + means * nodes)


def power_of_two(count: int) -> int:
    """The smallest that is not below `count`."""
    return 1 << (count - 1).bit_length()


def use_sparse_grid(scene, count: float) -> bool:
    """'auto' takes the sparse grid where material fills less than the fraction SPARSE_PAYS of the grid."""
    if scene.domain.outside == "grow":
        return True
    if scene.domain.grid != "auto":
        return scene.domain.grid == "sparse"
    return filled_fraction(scene, count) < SPARSE_PAYS


def filled_fraction(scene, count: float) -> float:
    """Cells full of particles over all nodes. count: particles."""
    per_cell = min(body.seeding.particles_per_axis for body in scene.bodies) ** scene.dim
    return float(count / per_cell / math.prod(scene.domain.node_counts))
