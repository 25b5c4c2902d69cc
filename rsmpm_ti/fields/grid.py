"""Geometry of the background grid."""

import taichi as ti

from rsmpm_ti.spec.scene import MARGIN, Scene

NO_WALL = -(10**6)
"""Wall index of an axis without a wall."""


@ti.data_oriented
class Grid:
    """Geometry of the background grid: node i sits at origin + i dx [m]."""

    def __init__(self, scene: Scene):
        domain, dim = scene.domain, scene.dim
        self.dim, self.dx, self.inv_dx = dim, domain.dx, 1.0 / domain.dx
        beyond = MARGIN + domain.room
        self.nodes = domain.node_counts
        self.origin = tuple(float(a) - beyond * domain.dx for a in domain.lower)
        lower, upper = [NO_WALL] * dim, [-NO_WALL] * dim
        for boundary in scene.loading.boundaries:
            row = round((boundary.position - self.origin[boundary.axis]) / domain.dx)
            if boundary.side == "lower":
                lower[boundary.axis] = max(lower[boundary.axis], row)
            else:
                upper[boundary.axis] = min(upper[boundary.axis], row)
        self.wall_lower, self.wall_upper = tuple(lower), tuple(upper)
        # walls whose nodes are folded, as (axis, row, step inwards, nodes of the row): see wall_nodes.py
        folded = scene.shape.width == 3 and not scene.transfer.affine
        self.walls = tuple(
            (d, rows[d], step, tuple(1 if e == d else n for e, n in enumerate(self.nodes)))
            for d in range(dim)
            for rows, step in ((lower, 1), (upper, -1))
            if folded and abs(rows[d]) != -NO_WALL
        )

    @ti.func
    def local(self, x):
        """Grid coordinates x/dx from the first node."""
        return (x - ti.Vector(self.origin)) * self.inv_dx

    @ti.func
    def base(self, xi, shape: ti.template()):
        """First node of the stencil; clamped, so that a lost or NaN particle never writes out of bounds."""
        base = ti.floor(xi - shape.shift).cast(int)
        return ti.max(0, ti.min(base, ti.Vector(self.nodes) - shape.width))

    @ti.func
    def key(self, base):
        """Row-major index of a base node: the sort key of cell order."""
        key = base[0]
        for d in ti.static(range(1, self.dim)):
            key = key * self.nodes[d] + base[d]
        return key

    @ti.func
    def base_of(self, key):
        """Base node of a key."""
        base = ti.Vector.zero(int, self.dim)
        rest = key
        for k in ti.static(range(self.dim - 1)):
            d = ti.static(self.dim - 1 - k)
            base[d] = rest % self.nodes[d]
            rest = rest // self.nodes[d]
        base[0] = rest
        return base

    @ti.func
    def position(self, i):
        return ti.Vector(self.origin) + i * self.dx
