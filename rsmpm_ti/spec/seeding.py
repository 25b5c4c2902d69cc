"""Where particles start: a lattice in each cell, or a jittered one. NumPy only.

Also the check that a slit's two faces really separate, which needs the particles but no kernel.
"""

import itertools
import math
from dataclasses import dataclass
from typing import Annotated, NamedTuple

import numpy as np
from annotated_types import Interval

from rsmpm_ti.checks import Remedy, Seed, checked
from rsmpm_ti.spec.drawings.answers import inside

PerAxis = Annotated[int, Interval(ge=1, le=8)]


class Seeds(NamedTuple):
    """Where the particles of a body start: x [m], [n, dim], and their volume [m^dim], [n]."""

    x: np.ndarray
    volume: np.ndarray


SAMPLES = 16
"""Sample points per axis by which a sub-cell that an edge cuts is measured: the edge's place to 1/32 of it."""

MIN_FRACTION = 0.3
"""A cut sub-cell with less of its volume inside joins a neighbour: small particles at a face would fail by noise."""


def _axes(lower: np.ndarray, upper: np.ndarray, origin: np.ndarray, spacing: float) -> list[np.ndarray]:
    """Coordinates along each axis of the centres of the sub-cells of the background grid that overlap a box."""
    axes = []
    for a, b, o in zip(lower, upper, origin, strict=True):
        first, last = math.floor((a - o) / spacing - 1e-6), math.ceil((b - o) / spacing + 1e-6)
        axes.append(o + (np.arange(first, last) + 0.5) * spacing)
    return axes


def _points(axes: list[np.ndarray]) -> np.ndarray:
    """All points of a lattice, first axis fastest, [n, dim]."""
    return np.stack([c.ravel(order="F") for c in np.meshgrid(*axes, indexing="ij")], axis=1)


def _whole_cells(region, origin: np.ndarray, spacing: float) -> Seeds:
    """One particle per sub-cell whose centre lies inside, with the sub-cell's volume: edges become stairs."""
    lower, upper = region.bounds()
    x = _points(_axes(lower, upper, origin, spacing))
    x = x[inside(region, x)]
    return Seeds(x, np.full(len(x), spacing ** x.shape[1]))


def _cut_cells(region, origin: np.ndarray, spacing: float) -> Seeds:
    """One particle per sub-cell that has material, at the centroid of that material and with its volume."""
    lower, upper = region.bounds()
    axes = _axes(lower, upper, origin, spacing)
    x, dim = _points(axes), len(axes)
    fraction, moment = _fractions(region, x, spacing)
    _merge_slivers(fraction, moment, x, [len(axis) for axis in axes])
    filled = fraction > 0.0
    return Seeds(x[filled] + moment[filled] / fraction[filled][:, None], fraction[filled] * spacing**dim)


def _fractions(region, x: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Fraction of each sub-cell's volume inside a region [n], and its first moment about the centre [n, dim]."""
    dim = x.shape[1]
    corners = np.array(list(itertools.product((-0.5, 0.0, 0.5), repeat=dim))) * (1.0 - 1e-6) * spacing
    within = np.array([inside(region, x + corner) for corner in corners])
    cut = np.flatnonzero(within.any(axis=0) & ~within.all(axis=0))
    steps = ((np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5) * spacing
    count, total = np.zeros(len(cut)), np.zeros((len(cut), dim))
    for sample in itertools.product(steps, repeat=dim):
        held = inside(region, x[cut] + sample)
        count += held
        total += held[:, None] * np.array(sample)
    fraction, moment = within.all(axis=0).astype(float), np.zeros((len(x), dim))
    fraction[cut], moment[cut] = count / SAMPLES**dim, total / SAMPLES**dim
    return fraction, moment


def _merge_slivers(fraction: np.ndarray, moment: np.ndarray, x: np.ndarray, counts: list[int]) -> None:
    """Give the material of sub-cells below MIN_FRACTION to the fullest neighbour along an axis; in place."""
    slivers = np.flatnonzero((fraction > 0.0) & (fraction < MIN_FRACTION))
    position = np.stack(np.unravel_index(slivers, counts, order="F"), axis=1)
    best, fullest = np.full(len(slivers), -1), np.full(len(slivers), MIN_FRACTION)
    for d, side in itertools.product(range(len(counts)), (-1, 1)):
        beside = position.copy()
        beside[:, d] += side
        there = (beside[:, d] >= 0) & (beside[:, d] < counts[d])
        index = np.ravel_multi_index(beside.T, counts, mode="clip", order="F")
        fuller = there & (fraction[index] > fullest)
        best[fuller], fullest[fuller] = index[fuller], fraction[index[fuller]]
    giving, taking = slivers[best >= 0], best[best >= 0]
    np.add.at(moment, taking, moment[giving] + fraction[giving][:, None] * (x[giving] - x[taking]))
    np.add.at(fraction, taking, fraction[giving])
    fraction[giving] = 0.0


@checked("seeding")
@dataclass(frozen=True, kw_only=True)
class Lattice:
    """`particles_per_axis` particles along each axis of a cell, at the centres of equal sub-cells.

    `fitted`: sub-cells that an edge of the body cuts get a particle with the volume and at the centroid of what lies
    inside, small remainders joined to a neighbour; otherwise edges are stairs of whole sub-cells, as in the paper.
    """

    particles_per_axis: PerAxis = 2
    fitted: bool = False

    def fill(self, region, origin: np.ndarray, dx: float) -> Seeds:
        """Particles of a region on a grid of cells dx [m] with a node at origin [dim]."""
        fill = _cut_cells if self.fitted else _whole_cells
        return fill(region, origin, dx / self.particles_per_axis)


@checked("seeding")
@dataclass(frozen=True, kw_only=True)
class Jittered:
    """The lattice with every particle moved at random, so that cracks do not follow grid columns.

    `amount` is the largest move along each axis as a fraction of the particle spacing; `seed` fixes it.
    """

    particles_per_axis: PerAxis = 2
    amount: Annotated[float, Interval(ge=0.0, lt=0.5), Remedy("at 0.5 two particles can coincide")] = 0.1
    seed: Seed = 1
    fitted: bool = False

    def fill(self, region, origin: np.ndarray, dx: float) -> Seeds:
        """Particles of a region. Membership is decided before the move, so that faces stay smooth
        in the mean and the number of particles does not depend on the seed; no particle enters a slit."""
        lattice = Lattice(particles_per_axis=self.particles_per_axis, fitted=self.fitted).fill(region, origin, dx)
        reach = abs(self.amount) * dx / self.particles_per_axis
        moved = lattice.x + np.random.default_rng(self.seed).uniform(-reach, reach, lattice.x.shape)
        return Seeds(np.where(inside(region, moved)[:, None], moved, lattice.x), lattice.volume)
