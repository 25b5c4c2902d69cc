"""What touches a platen that pushes and does not pull, for each node of its plane."""

from typing import NamedTuple

import numpy as np
import taichi as ti

from rsmpm_ti.fields.geometry import Geometry
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.spec.scene import Scene

NOTHING_NEAR = 1e6
"""Gap where no particle is near a plane [cells]."""

ROUND_OFF = 0.05
"""Gap below which rock touches a plane [cells]. Under uniform strain that of rock which was in touch stays zero; waves
and what breaks beside a platen move its edge against the grid by their strain, a fifth of this in the hardest rock."""


class Plane(NamedTuple):
    """A plane of nodes: number of its row along its axis, step towards the bodies, its nodes (`Grid.plane`)."""

    axis: int
    row: int
    inward: int
    extent: tuple[int, ...]


def pushing_planes(scene: Scene, grid: Geometry) -> tuple[tuple[Plane, ...], dict[int, int]]:
    """Planes that boundaries push from, and boundary -> plane, both by their number."""
    of = {
        k: Plane(b.axis, grid.row(b), 1 if b.side == "lower" else -1, grid.plane(b.axis))
        for k, b in enumerate(scene.loading.boundaries)
        if b.unilateral
    }
    planes = tuple(sorted(set(of.values())))
    return planes, {k: planes.index(plane) for k, plane in of.items()}


@ti.data_oriented
class Contacts:
    """Planes of nodes that boundaries push from: one for all boundaries of the same side, axis and place.

    gap: between the nearest particle's edge and the plane [cells], seen from each node of the plane; of all particles
    that reach the node. seat: the gap that counts as none. state: what the node did in its latest step, as
    boundaries.py has it.

    A platen that touches its body at the start is seated on it: stairs and curved faces that its nodes then reach are
    finer than the grid, and the gap that they leave stays none. So the disc of a Brazilian test lies on an arc, of
    some cells' depth, as in jaws. A platen that starts off the body has no seat, and meets it where it is.
    """

    def __init__(self, scene: Scene, grid: Grid, real):
        self.planes, self.plane_of = pushing_planes(scene, grid)
        self.gaps = tuple(ti.field(real, extent) for *_, extent in self.planes)
        self.seats = tuple(ti.field(real, extent) for *_, extent in self.planes)
        self.states = tuple(ti.field(ti.i32, extent) for *_, extent in self.planes)
        # particles that were moved at random lie further from a plane that their body touches
        self.tolerance = ROUND_OFF + max(
            getattr(body.seeding, "amount", 0.0) / body.seeding.particles_per_axis for body in scene.bodies
        )
        # mass of a node of the plane over that of as much rock as a cell of its row holds
        self.share = 0.5 + 2.0 * scene.shape.overhang

    def sit(self) -> None:
        """Seat platens that touch their bodies, at the gaps that there are."""
        for gaps, seats in zip(self.gaps, self.seats, strict=True):
            gap = gaps.to_numpy()
            touches = gap.min() <= self.tolerance
            seats.from_numpy(np.where((gap < NOTHING_NEAR) & touches, np.maximum(gap, 0.0), 0.0).astype(gap.dtype))

    def state(self) -> dict[str, np.ndarray]:
        """Seats, and what nodes did in the latest step, with which usf begins the next."""
        kept = {"seat": self.seats, "contact": self.states}
        return {f"{name}_{k}": field.to_numpy() for name, fields in kept.items() for k, field in enumerate(fields)}

    def resume(self, state: dict[str, np.ndarray]) -> None:
        for name, fields in (("seat", self.seats), ("contact", self.states)):
            for k, field in enumerate(fields):
                field.from_numpy(state[f"{name}_{k}"])

    @ti.func
    def touches(self, plane: ti.template(), i):
        """Whether rock touches the plane at a node of it or beyond it."""
        j = self.across(plane, i)
        return self.gaps[plane][j] <= self.seats[plane][j] + self.tolerance

    @ti.func
    def across(self, plane: ti.template(), i):
        """Place of a node in the fields of a plane."""
        j = i
        j[ti.static(self.planes[plane].axis)] = 0
        return j
