"""Pressure on the wall of a hole that is there from the start: of a fluid behind a dry wall, or of a blast.

The force of a pressure p on the nodes is, by Gauss, an integral over the hole, n pointing from the hole into the rock:

    f_i = p int N_i n dA = p int grad N_i dV

so nobody looks for the wall. It is taken at points with which the hole is seeded as the rock is (`fields/holes`).
"""

import bisect
import itertools
import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len

from rsmpm_ti.checks import MAX_SIZE, NotNegative, Remedy, checked
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.drawings.answers import inside
from rsmpm_ti.spec.regions import Region
from rsmpm_ti.spec.seeding import Lattice, Seeds
from rsmpm_ti.units import Pressure, Time

MOST_TIMES = 1000
"""Entries of a table: each step looks through it."""

Moment = Annotated[Time, Interval(ge=0.0, le=MAX_SIZE)]


@checked("hole_pressure")
@dataclass(frozen=True, kw_only=True)
class HolePressure:
    """A pressure on the wall of a hole: at `times` [s] it is `pressures` [Pa], compression positive.

    Linear between them, after the last the last, before the first from 0 at time 0: a constant one is `times=(0.0,)`.
    `region` is what was cut from the body, or a part of it; what lies outside of the domain does not count.

    Beside a confining pressure it is what the hole holds beyond that, which acts on every surface.

    It acts where the wall was at the start, and goes with platens as the grid does. It does not follow into cracks,
    which stay dry, nor out of the region. When it fails: where the wall moves by more than half a cell, which is said,
    or is less than two cells across. Good values: a hole of ten cells or more, fitted seeding.
    """

    region: Region
    times: Annotated[tuple[Moment, ...], Len(1, MOST_TIMES)]
    pressures: Annotated[
        tuple[Annotated[Pressure, NotNegative], ...], Len(1, MOST_TIMES), Remedy("it is compression positive")
    ]

    def __post_init__(self):
        if any(b <= a for a, b in itertools.pairwise(self.times)):
            raise refuse("hole_pressure.times", self.times, "times that grow, at least one")
        if len(self.pressures) != len(self.times):
            allowed = f"{len(self.times)} numbers, one for each of hole_pressure.times"
            raise refuse("hole_pressure.pressures", self.pressures, allowed)

    @property
    def table(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times [s] and pressures [Pa] from time 0 on."""
        if self.times[0] == 0.0:
            return self.times, self.pressures
        return (0.0, *self.times), (0.0, *self.pressures)

    def pressure(self, time: float) -> float:
        """At a time [s], [Pa]."""
        times, pressures = self.table
        k = bisect.bisect_right(times, time)
        if k == len(times):
            return pressures[-1]
        part = (time - times[k - 1]) / (times[k] - times[k - 1])
        return pressures[k - 1] + part * (pressures[k] - pressures[k - 1])


def fill_hole(scene, region) -> Seeds:
    """Points of a hole with their volumes, on the lattice of the first body, in the domain alone."""
    seeding, domain = scene.bodies[0].seeding, scene.domain
    lattice = Lattice(particles_per_axis=seeding.particles_per_axis, fitted=seeding.fitted)
    points = lattice.fill(region, np.array(domain.lower, dtype=float), domain.dx)
    held = np.all((points.x > np.array(domain.lower)) & (points.x < np.array(domain.upper)), axis=1)
    return Seeds(points.x[held], points.volume[held])


def check_holes(scene) -> None:
    """Raises SceneError for a hole that does not fit its scene, as far as no particle need be seeded."""
    lower, upper = np.array(scene.domain.lower), np.array(scene.domain.upper)
    for k, hole in enumerate(scene.loading.holes):
        low, high = hole.region.bounds()
        if len(low) != scene.dim:
            raise SceneError(f"holes[{k}].region has {len(low)} dimensions, domain has {scene.dim}")
        if np.any(low >= upper) or np.any(high <= lower):
            allowed = f"a region in the domain, from {lower.tolist()} to {upper.tolist()} m"
            raise refuse(f"holes[{k}].region", hole.region, allowed)
        cells = (high - low) / scene.domain.dx + 2.0
        if math.prod(cells) * scene.bodies[0].seeding.particles_per_axis ** scene.dim > MOST_POINTS:
            allowed = f"a region of at most {MOST_POINTS:.3g} points of seeding"
            raise refuse(f"holes[{k}].region", hole.region, allowed)


MOST_POINTS = 20_000_000
"""Of a hole: 1 GB while they are seeded."""


def pressures_of(scene) -> list[tuple[int, HolePressure]]:
    """(its place in loading.holes, pressure) of all."""
    return [(k, hole) for k, hole in enumerate(scene.loading.holes) if isinstance(hole, HolePressure)]


def check_walls(scene, seeds: list[Seeds]) -> None:
    """Refuse a hole that is too small to have a point, that holds rock, or that has no wall of rock."""
    spacing = scene.domain.dx / scene.bodies[0].seeding.particles_per_axis
    for k, hole in pressures_of(scene):
        name, points = f"holes[{k}].region", fill_hole(scene, hole.region)
        if not len(points.x):
            allowed = f"at least one particle large, {spacing:g} m"
            raise refuse(name, hole.region, allowed, "take a smaller domain.dx")
        x = np.concatenate([body.x for body in seeds])
        low, high = hole.region.bounds()
        x = x[np.all((x > low - 2.0 * scene.domain.dx) & (x < high + 2.0 * scene.domain.dx), axis=1)]
        held = np.all([inside(hole.region, x + step) for step in around(scene.dim, 0.5 * spacing)], axis=0)
        if held.any():
            place = x[held][0].tolist()
            allowed = f"a region without rock: there is some at {place} m"
            raise refuse(name, hole.region, allowed, "cut it from the body by Difference")
        near = np.any([inside(hole.region, x + step) for step in around(scene.dim, 1.5 * spacing)], axis=0)
        if not near.any():
            raise refuse(name, hole.region, "beside rock", "it has no wall on which to press")


def around(dim: int, distance: float) -> np.ndarray:
    """Steps to a point itself and to its neighbours along the axes [m]."""
    axes = distance * np.eye(dim)
    return np.concatenate([np.zeros((1, dim)), axes, -axes])
