"""Fields of the background nodes, dense or under sparse blocks."""

import numpy as np
import taichi as ti

from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.spec.scene import Scene

BLOCK = 8
"""Cells per axis of a sparse block."""


@ti.data_oriented
class Nodes:
    """Node fields, interleaved in memory. `sparse` places them under pointer blocks.

    v holds momentum until the nodes are updated, then velocity; f holds force, then the velocity change of the step;
    w and u (musl only) the momentum, then velocity, mapped back from moved particles, and the velocity v of the step,
    by which particles move, while v takes the next step's momentum.
    """

    def __init__(self, scene: Scene, grid: Grid, real, sparse: bool):
        self.mass = ti.field(real)
        self.v, self.f = ti.Vector.field(grid.dim, real), ti.Vector.field(grid.dim, real)
        self.remap = scene.order == "musl"
        self.w = self.u = self.v
        if self.remap:
            self.w, self.u = ti.Vector.field(grid.dim, real), ti.Vector.field(grid.dim, real)
        axes = (ti.ij, ti.ijk)[grid.dim - 2]
        self.sparse, self.blocks = sparse, None
        if sparse:
            counts = tuple(-(-n // BLOCK) for n in grid.nodes)
            self.blocks = ti.root.pointer(axes, counts)
            parent = self.blocks.dense(axes, (BLOCK,) * grid.dim)
        else:
            parent = ti.root.dense(axes, grid.nodes)
        parent.place(self.mass, self.v, self.f, *((self.w, self.u) if self.remap else ()))

        # the same fields by component
        self.v_columns, self.f_columns, self.w_columns = (components(field) for field in (self.v, self.f, self.w))
        self.momentum_columns = (self.mass, *self.v_columns)

    def forget_empty(self) -> None:
        """Deactivate every block; the next P2G activates those that hold material."""
        if self.blocks is not None:
            self.blocks.deactivate_all()


def components(field) -> tuple:
    if isinstance(field, ti.MatrixField):
        columns = range(field.m) if field.ndim == 2 else (None,)
        return tuple(field.get_scalar_field(*((a,) if b is None else (a, b))) for a in range(field.n) for b in columns)
    return (field,)


def use_sparse_grid(scene: Scene, particle_count: int) -> bool:
    """'auto' takes the sparse grid where less than a quarter of the nodes can hold material."""
    if scene.domain.outside == "grow":
        return True
    if scene.domain.grid != "auto":
        return scene.domain.grid == "sparse"
    per_cell = min(body.seeding.particles_per_axis for body in scene.bodies) ** scene.dim
    return particle_count / per_cell < 0.25 * np.prod(Grid(scene).nodes)
