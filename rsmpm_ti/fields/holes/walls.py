"""What presses on the walls of holes, on the nodes around them.

A pressure p in a hole gives node i the force

    f_i = p q_i,    q_i = int_hole grad N_i dV = -int_rock grad N_i dV = -sum_p V_p grad w_ip

where no other surface is near. The last is what is taken, as for the confining pressure (`mpm/p2g.py`): rock that has
the stress -p 1 is in balance at every node, and a node that hardly any rock reaches gets as little force. A sum over
points in the hole is the traction too, but it pushed such nodes by the whole of it: at some particles of a wall the
stress was then off by 16 p. It only says which nodes are at the wall: within the hole, and in rock, it is nothing.

q_i is that of the start. It goes with the grid, and only lengths change: f_id is p q_id times the cell's volume over
its length along d, both over what they were.
"""

import itertools

import numpy as np
import taichi as ti

from rsmpm_ti.errors import SceneError
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.spec.holes.pressure import HolePressure, fill_hole
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Seeds

SMALL = 1e-5
"""Part of the largest q_i below which a node lies within the hole: round-off, also of single precision."""


CLOSED = 0.3
"""Part of the forces of a hole by which those of the rock around it may differ where it has rock on all sides."""


@ti.kernel
def _sum_gradients(
    shape: ti.template(), dim: ti.template(), xi: ti.types.ndarray(), volume: ti.types.ndarray(),
    base: ti.types.ndarray(), first: ti.types.ndarray(), counts: ti.types.ndarray(), q: ti.types.ndarray(),
):  # fmt: skip
    """Add volume times grad w of points at grid coordinates xi to nodes of a box, row by row from its first."""
    ti.loop_config(serialize=True)
    for g in range(xi.shape[0]):
        r = ti.Vector.zero(float, dim)
        for d in ti.static(range(dim)):
            r[d] = xi[g, d] - base[g, d]
        w, dw = shape.weights(r), shape.gradients(r)
        for offset in ti.static(list(itertools.product(range(shape.width), repeat=dim))):
            node = 0
            for d in ti.static(range(dim)):
                node = node * counts[d] + base[g, d] + offset[d] - first[d]
            for d in ti.static(range(dim)):
                slope = 1.0
                for e in ti.static(range(dim)):
                    slope *= dw[offset[e], e] if ti.static(d == e) else w[offset[e], e]
                q[node, d] += volume[g] * slope


def _box(scene: Scene, grid: Grid, points: Seeds) -> tuple[np.ndarray, np.ndarray]:
    """First and last node of a box around the stencils of points."""
    xi = grid.coordinates_at(points.x) - scene.shape.shift
    first, last = np.floor(xi.min(axis=0)).astype(np.int32), np.floor(xi.max(axis=0)).astype(np.int32)
    return first - 1, last + scene.shape.width


def _at_wall(hole: np.ndarray) -> np.ndarray:
    """Which nodes of a box are at the wall of a hole whose gradients these are."""
    size = np.abs(hole).max(axis=-1)
    return size > SMALL * size.max()


def unit_forces(scene: Scene, grid: Grid, region, rock: Seeds) -> tuple[np.ndarray, np.ndarray]:
    """Nodes at the wall of a hole, [n, dim], and their force per pressure [m^(dim-1)], [n, dim]; rock: all particles.

    Taichi must have started.
    """
    points = fill_hole(scene, region)
    first, last = _box(scene, grid, points)
    near = np.all(np.abs(grid.coordinates_at(rock.x) - 0.5 * (first + last)) < 0.5 * (last - first) + 2.0, axis=1)
    hole = _gradients(scene, grid, points, first, last)
    q = -_gradients(scene, grid, Seeds(rock.x[near], rock.volume[near]), first, last)
    node = np.argwhere(_at_wall(hole))
    hole, q = hole[tuple(node.T)], q[tuple(node.T)]
    if np.abs(hole - q).sum() < CLOSED * np.abs(hole).sum():
        # it pushes nothing away, which points in the hole know and jittered rock does not
        size = np.linalg.norm(q, axis=1, keepdims=True)
        q += (hole.sum(axis=0) - q.sum(axis=0)) * size / size.sum()
    return (node + first).astype(np.int32), q * scene.domain.dx ** (scene.dim - 1)


def support_nodes(scene: Scene, grid: Grid, region) -> np.ndarray:
    """Nodes at the wall of a region and beside them, [n, dim]: those on which its rock presses, also when it has moved
    by half a cell."""
    first, last = _box(scene, grid, points := fill_hole(scene, region))
    first, last = np.maximum(first - 1, 0), np.minimum(last + 1, np.array(grid.nodes) - 1)
    there = _at_wall(_gradients(scene, grid, points, first, last))
    for axis in range(scene.dim):
        along = np.moveaxis(there, axis, 0)
        wide = along.copy()
        wide[1:] |= along[:-1]
        wide[:-1] |= along[1:]
        there = np.moveaxis(wide, 0, axis)
    return (np.argwhere(there) + first).astype(np.int32)


def _gradients(scene: Scene, grid: Grid, points: Seeds, first: np.ndarray, last: np.ndarray) -> np.ndarray:
    """Sum of volume times grad w over points, on the nodes of a box from first to last, in cells [box, dim]."""
    width, dim = scene.shape.width, scene.dim
    # a margin, so that stencils which reach into the box lie in it
    low, counts = (first - width).astype(np.int32), (last - first + 1 + 2 * width).astype(np.int32)
    xi = grid.coordinates_at(points.x)
    base = np.floor(xi - scene.shape.shift).astype(np.int32)
    inside = np.all((base >= low) & (base + width <= low + counts), axis=1)
    q = np.zeros((int(counts.prod()), dim))
    volume = points.volume[inside] / scene.domain.dx**dim
    _sum_gradients(scene.shape, dim, xi[inside], volume, base[inside], low, counts, q)
    q = q.reshape(*counts, dim)
    _fold(q, grid, low, width)
    if grid.turned:
        (c, s), along = grid.direction, q.copy()
        q[..., 0], q[..., 1] = c * along[..., 0] - s * along[..., 1], s * along[..., 0] + c * along[..., 1]
    return q[tuple(slice(width, -width) for _ in range(dim))]


def _fold(q: np.ndarray, grid: Grid, first: np.ndarray, width: int) -> None:
    """Give what lies one beyond a wall to the two nodes inside, as `mpm/wall_nodes.py` does; in place.

    Across the wall nothing presses on its own nodes: what a hole that meets it has there is no wall of rock.
    """
    for d in range(grid.dim):
        along = np.moveaxis(q, d, 0)
        for wall, inward in ((grid.wall_lower[d], 1), (grid.wall_upper[d], -1)):
            row = wall - first[d]
            if not (0 < row < len(along) - 1):
                continue
            if width == 3:
                along[row] += 2.0 * along[row - inward]
                along[row + inward] -= along[row - inward]
                along[row - inward] = 0.0
            along[row, ..., d] = 0.0


@ti.data_oriented
class Walls:
    """Nodes on the walls of all holes of a scene, the holes one after another; nothing where there is no hole.

    load: what the nodes of each hole are loaded by now: of a pressure, it [Pa], of a support, the part that is left. q:
    their force per load; force: that of the latest step [N]. first: the first node of each hole, and the end; starts:
    the same of the tables of times and loads, which stand one after another too.
    """

    def __init__(self, scene: Scene, grid: Grid, rock: Seeds):
        holes, dim = scene.loading.holes, scene.dim
        self.holes = len(holes)
        self.latest = 0.0 if holes else 0.5  # part of boundaries' latest work that counts: mpm/holes/press.py
        if self.holes == 0:
            return
        forces = [
            unit_forces(scene, grid, hole.region, rock) if isinstance(hole, HolePressure)
            else (nodes := support_nodes(scene, grid, hole.region), np.zeros(nodes.shape)) for hole in holes
        ]  # fmt: skip
        node, q = (np.concatenate(part) for part in zip(*forces, strict=True))
        counts = [len(n) for n, _ in forces]
        self.size, self.first = len(node), tuple(itertools.accumulate(counts, initial=0))
        self.node, self.hole = ti.Vector.field(dim, ti.i32, self.size), ti.field(ti.i32, self.size)
        self.q, self.force = ti.Vector.field(dim, ti.f64, self.size), ti.Vector.field(dim, ti.f64, self.size)
        self.node.from_numpy(node)
        self.q.from_numpy(q)
        self.hole.from_numpy(np.repeat(np.arange(self.holes), counts).astype(np.int32))
        times, loads = zip(*(hole.table for hole in holes), strict=True)
        self.starts = tuple(itertools.accumulate(map(len, times), initial=0))
        self.times, self.loads = ti.field(ti.f64, self.starts[-1]), ti.field(ti.f64, self.starts[-1])
        self.times.from_numpy(np.concatenate(times))
        self.loads.from_numpy(np.concatenate(loads))
        self.load = ti.field(ti.f64, self.holes)
        self.dt = ti.field(ti.f64, ())  # of the latest step [s]
        self.ahead = -0.5 if scene.order == "usf" else 0.5  # steps by which stress is ahead of velocity

    def state(self) -> dict[str, np.ndarray]:
        """What a run goes on with: the forces of supports are known only when their rock is taken out."""
        return {"wall_forces": self.q.to_numpy()} if self.holes else {}

    def resume(self, state: dict[str, np.ndarray]) -> None:
        if self.holes and state["wall_forces"].shape != (self.size, self.q.n):
            raise SceneError(f"the checkpoint has other walls of holes than {self.size} nodes; start anew")
        if self.holes:
            self.q.from_numpy(state["wall_forces"])

    @ti.func
    def look_up(self, hole: ti.template(), time):
        """Load of a hole at a time [s], linear between the entries of its table."""
        first, last = ti.static(self.starts[hole], self.starts[hole + 1] - 1)
        found = self.loads[last]
        for k in range(first, last):
            t_a, t_b = self.times[k], self.times[k + 1]
            if t_a <= time and time < t_b:
                found = self.loads[k] + (time - t_a) / (t_b - t_a) * (self.loads[k + 1] - self.loads[k])
        return found
