"""The numbers of a scene's grid: where its nodes are, and which planes of them boundaries hold. No fields."""

import numpy as np

from rsmpm_ti.fields.side_motion import held_sides, side_speeds
from rsmpm_ti.spec.domain import MARGIN
from rsmpm_ti.spec.scene import Scene

NO_WALL = -(10**6)
"""Wall index of an axis without a wall."""


class Geometry:
    """What is known of a `Grid` before Taichi has started, and does not change in a run."""

    def __init__(self, scene: Scene):
        domain, dim = scene.domain, scene.dim
        self.dim, self.dx, self.inv_dx = dim, domain.dx, 1.0 / domain.dx
        beyond = MARGIN + domain.room
        self.nodes = domain.node_counts
        self.origin = tuple(float(a) - beyond * domain.dx for a in domain.lower)
        # a turned grid lies still: platens have no planes of nodes, and press by their position
        self.turned, self.direction, self.pressed = domain.turn != 0.0, domain.direction, domain.pressed
        self.centre, self.middle = domain.middle, tuple(0.5 * (n - 1) for n in self.nodes)
        edges = (b - a for a, b in zip(domain.lower, domain.upper, strict=True))
        # of particles from the centre [cells]
        self.reach = tuple(0.5 * edge / domain.dx + beyond - 1.0 for edge in edges)
        if self.turned:
            self.origin = tuple(c - n * domain.dx for c, n in zip(self.centre, self.middle, strict=True))
        lower, upper = [NO_WALL] * dim, [-NO_WALL] * dim
        for boundary in () if self.turned else scene.loading.boundaries:
            row = self.row(boundary)
            if boundary.side == "lower":
                lower[boundary.axis] = max(lower[boundary.axis], row)
            else:
                upper[boundary.axis] = min(upper[boundary.axis], row)
        self.wall_lower, self.wall_upper = tuple(lower), tuple(upper)
        # walls whose nodes are folded, as (axis, row, step inwards, nodes of the row): see wall_nodes.py
        folded = scene.shape.width == 3 and not scene.transfer.affine
        self.walls = tuple(
            (d, rows[d], step, self.plane(d))
            for d in range(dim)
            for rows, step in ((lower, 1), (upper, -1))
            if folded and abs(rows[d]) != -NO_WALL
        )
        self.speeds = side_speeds(scene)
        self.held = held_sides(scene)
        self.followed = tuple(d for d in range(dim) if any(self.speeds[d]) or d in {side.axis for side in self.held})
        bounded = tuple((abs(low) != -NO_WALL, abs(up) != -NO_WALL) for low, up in zip(lower, upper, strict=True))
        self.alone = tuple(sides.index(True) if sum(sides) == 1 else -1 for sides in bounded)
        # a plane for each side all the same
        self.rows = tuple(
            tuple(own if abs(own) != -NO_WALL else other + step for own, other, step in ((low, up, -1), (up, low, 1)))
            for low, up in zip(lower, upper, strict=True)
        )

    def row(self, boundary) -> int:
        """Number of a boundary's plane of nodes along its axis."""
        return round((boundary.position - self.origin[boundary.axis]) / self.dx)

    def plane(self, axis: int) -> tuple[int, ...]:
        """Nodes of a plane across an axis, as numbers along each axis: 1 along its own."""
        return tuple(1 if d == axis else n for d, n in enumerate(self.nodes))

    def frame_at(self, travel: np.ndarray) -> np.ndarray:
        """Origin, 1/spacing and spacing along each axis [dim, 3] when sides have gone so far [m], [dim, 2]; see `Grid`.

        An axis along which nothing moves keeps those of the start.
        """
        frame = np.array([(origin, self.inv_dx, self.dx) for origin in self.origin])
        for d in () if self.turned else self.followed:
            stretch = (travel[d, 1] - travel[d, 0]) / (self.rows[d][1] - self.rows[d][0])
            spacing = self.dx + stretch
            frame[d] = self.origin[d] + travel[d, 0] - self.rows[d][0] * stretch, 1.0 / spacing, spacing
        return frame

    def coordinates_at(self, x: np.ndarray, frame: np.ndarray | None = None) -> np.ndarray:
        """Grid coordinates of places x [n, dim] [m], in cells from the first node; of a frame, by default the first."""
        origin, inverse = (np.array(self.origin), self.inv_dx) if frame is None else (frame[:, 0], frame[:, 1])
        xi = (x - origin) * inverse
        if self.turned:
            (c, s), middle = self.direction, np.array(self.middle)
            xi = middle + (xi - middle) @ np.array([[c, -s], [s, c]])
        return xi
