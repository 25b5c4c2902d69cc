"""Fields of the background nodes, dense or under sparse blocks."""

import taichi as ti

from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.spec.review.memory import BLOCK, power_of_two
from rsmpm_ti.spec.scene import Scene

SMALL_MASS = 1e-24
"""Nodes lighter than this fraction of a full cell hold nothing: what they are made of is round-off.

A particle that reaches a fraction r of a cell into a node's support gives it r^2/2 by B-splines and GIMP, and has a
gradient of r there: a node that was dropped at 1e-12 took 1e-6 of the speed from its velocity gradient.
"""

PUSHED_MASS = 1e-12
"""With `usl`, nodes lighter than this fraction of a full cell take no force. What a force of r does to r^2/2 is 1/r,
and `usl` takes it into the gradient, times r: a node just reached would strain its particle as much as any other.
"""


@ti.data_oriented
class Nodes:
    """Node fields, interleaved in memory. `sparse` places them under pointer blocks.

    v holds momentum until the nodes are updated, then velocity; f holds force, then the velocity change of the step.
    With `musl`, v takes the next step's momentum while particles still move by this step's velocity, which v_moving
    keeps; v_remapped holds the momentum, then the velocity, mapped back from particles with their new velocities. With
    the other orders both are v itself.
    """

    def __init__(self, scene: Scene, grid: Grid, real, sparse: bool):
        self.mass = ti.field(real)
        self.v, self.f = ti.Vector.field(grid.dim, real), ti.Vector.field(grid.dim, real)
        self.v_remapped = self.v_moving = self.v
        self.remap = scene.order == "musl"
        if self.remap:
            self.v_remapped, self.v_moving = ti.Vector.field(grid.dim, real), ti.Vector.field(grid.dim, real)
        # what boundaries stop is booked where particles carry a velocity alone: see `mpm/nodes.py`
        self.books_stopping = self.remap and not scene.transfer.affine
        # lightest node that takes a force, as a fraction of a full cell
        self.pushed_mass = PUSHED_MASS if scene.order == "usl" else SMALL_MASS
        axes = (ti.ij, ti.ijk)[grid.dim - 2]
        self.sparse, self.blocks = sparse, None
        if sparse:
            # Taichi 1.7.4 visits every active node only where counts of blocks are powers of two (its issue 7112)
            counts = tuple(power_of_two(-(-n // BLOCK)) for n in grid.nodes)
            self.blocks = ti.root.pointer(axes, counts)
            parent = self.blocks.dense(axes, (BLOCK,) * grid.dim)
        else:
            parent = ti.root.dense(axes, grid.nodes)
        parent.place(self.mass, self.v, self.f, *((self.v_remapped, self.v_moving) if self.remap else ()))

        # the same fields by component
        self.v_columns, self.f_columns = components(self.v), components(self.f)
        self.v_remapped_columns = components(self.v_remapped)
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
