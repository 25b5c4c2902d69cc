"""Geometry of the background grid, which follows what presses on it along each axis that has a moving boundary."""

import numpy as np
import taichi as ti

from rsmpm_ti.fields.geometry import Geometry
from rsmpm_ti.spec.scene import Scene


@ti.data_oriented
class Grid(Geometry):
    """Geometry of the background grid. At the start node i sits at origin + i dx [m], and by this place, its label,
    boundaries know their nodes.

    MPM throws its grid away in every step, so the next one may be spaced as is best. Along an axis with a moving
    boundary the planes of both sides go with their boundaries, and all nodes between and beyond stay evenly spaced:

        x_i = origin + i spacing
        spacing = dx + (t_u - t_l) / (n_u - n_l)
        origin = origin_0 + t_l - n_l (spacing - dx)

    with t the way that a side has gone [m] and n the number of its plane. So a platen is always a plane of nodes, and
    under uniform strain no particle changes its place in its cell: uniform strain stays exact, however large. With a
    boundary on one side only, the grid moves as a whole.

    A turned grid lies still, only `travel` is counted. With R of its axes as columns, about the domain's middle,

        x_i = centre + R (i - middle) dx,    grad = R grad_xi / dx,

    and a frame's origin is that before the turn. Vectors and tensors of nodes and particles stay along the axes of
    space: L = L_xi R^T and sigma . grad w = (sigma R) . grad_xi w / dx (`space_gradient`, `along_grid`).

    A frame [dim, 3] is origin, 1/spacing and spacing for each axis. Node values of a step belong to `start_frame`, that
    of the step's start; what particles give to nodes for the next step to `frame`, that of the time they are at.
    """

    def __init__(self, scene: Scene):
        super().__init__(scene)
        dim = self.dim
        self.travel = ti.field(ti.f64, (dim, 2))  # of each side since the start [m]
        self.velocity = ti.field(ti.f64, (dim, 2))  # of sides that a force moves [m/s]
        self._answered = ti.field(ti.f64, (dim, 2))  # impulse that such a side has given the bodies so far [N s]
        self._began = ti.field(ti.f64, (dim, 2))  # travel at which the clock started: of bodies that settled first [m]
        self.settles = scene.loading.settle
        self.pace = ti.field(ti.f64, ())  # of time, and of sides that have a speed: 0 while bodies settle, then 1
        if self.settles:
            self.pace[None] = 1.0
        self._now, self._start = ti.field(ti.f64, (dim, 3)), ti.field(ti.f64, (dim, 3))
        self.begin()

    def begin(self) -> None:
        """Everything as it is at the start."""
        nothing = {f"grid_{name}": np.zeros((self.dim, 2)) for name in ("travel", "velocity", "answered", "began")}
        self.resume(nothing | {"grid_frame": self.frame_at(np.zeros((self.dim, 2)))})

    def state(self) -> dict[str, np.ndarray]:
        """Between two steps: how far each side has gone [m], [dim, 2], and the frame, [dim, 3], to the last bit."""
        return {f"grid_{name}": field.to_numpy() for name, field in self._kept.items()}

    def resume(self, state: dict[str, np.ndarray]) -> None:
        for name, field in self._kept.items():
            field.from_numpy(state[f"grid_{name}"])
        self._start.from_numpy(state["grid_frame"])

    @property
    def _kept(self) -> dict:
        ways = {"travel": self.travel, "began": self._began}
        return ways | {"velocity": self.velocity, "answered": self._answered, "frame": self._now}

    def gone(self) -> np.ndarray:
        """How far each side has gone since the clock started [m], [dim, 2]."""
        return self.travel.to_numpy() - self._began.to_numpy()

    def count_from_here(self, impulse: np.ndarray) -> None:
        """The clock starts: `gone` is nothing, and so is what boundaries have given so far [N s], [boundaries, dim]."""
        self._began.from_numpy(self.travel.to_numpy())
        for held in self.held:
            self._answered[held.axis, held.side] -= impulse[held.boundary, held.axis]

    def spacing(self, axis: int) -> float:
        """Of nodes along an axis, now [m]."""
        return float(self._now.to_numpy()[axis, 2])

    @property
    def fastest(self) -> float:
        """Largest speed of a side, at full speed or now [m/s]."""
        speed = max(abs(speed) for axis in self.speeds for speed in axis)
        return max(speed, float(np.abs(self.velocity.to_numpy()).max())) if self.held else speed

    @property
    def quickest(self) -> float:
        """Largest acceleration that a force gives a side which meets nothing [m/s^2]."""
        return max((abs(side.force) / side.mass for side in self.held), default=0.0)

    @ti.func
    def push(self, impulse: ti.template(), dt, factor):
        """Sides that a force moves: what it adds to their momentum, less what the bodies took since the step before.

        impulse: of each boundary on the bodies so far [N s].
        """
        for held in ti.static(self.held):
            given = impulse[held.boundary][held.axis]
            pushed = held.force * ti.cast(factor, ti.f64) * ti.cast(dt, ti.f64)
            change = pushed - (given - self._answered[held.axis, held.side])
            self.velocity[held.axis, held.side] = self.velocity[held.axis, held.side] + change / held.mass
            self._answered[held.axis, held.side] = given

    @ti.func
    def move(self, dt, factor):
        """Start the next frame: sides go on as particles do, by dt times their speed."""
        for d in ti.static(self.followed):
            for side in ti.static(range(2)):
                way = ti.cast(ti.static(self.speeds[d][side]), ti.f64) * ti.cast(factor, ti.f64) * ti.cast(dt, ti.f64)
                if ti.static(self.settles):
                    way *= self.pace[None]
                self.travel[d, side] = self.travel[d, side] + way + self.velocity[d, side] * ti.cast(dt, ti.f64)
            if ti.static(self.alone[d] >= 0):  # the side without a boundary goes with the other
                self.travel[d, ti.static(1 - self.alone[d])] = self.travel[d, ti.static(self.alone[d])]
            for column in ti.static(range(3)):
                self._start[d, column] = self._now[d, column]
            if ti.static(not self.turned):
                rows = ti.static(self.rows[d])
                stretch = (self.travel[d, 1] - self.travel[d, 0]) / ti.static(float(rows[1] - rows[0]))
                spacing = ti.static(self.dx) + stretch
                self._now[d, 0] = ti.static(self.origin[d]) + self.travel[d, 0] - ti.static(float(rows[0])) * stretch
                self._now[d, 1] = 1.0 / spacing
                self._now[d, 2] = spacing

    @ti.func
    def settle(self):
        """The step has ended: its start is now."""
        for d in ti.static(self.followed):
            for column in ti.static(range(3)):
                self._start[d, column] = self._now[d, column]

    @ti.func
    def frame(self):
        """Of now. To be called once, before the loops: what they then use are locals, and they stay vectorised."""
        return self._read(self._now)

    @ti.func
    def start_frame(self):
        """Of the step's start."""
        return self._read(self._start)

    @ti.func
    def _read(self, field: ti.template()):
        frame = ti.Matrix.zero(float, self.dim, 3)
        for d in ti.static(range(self.dim)):
            if ti.static(d in self.followed):
                for column in ti.static(range(3)):
                    frame[d, column] = ti.cast(field[d, column], float)
            else:
                frame[d, 0], frame[d, 1], frame[d, 2] = self.origin[d], self.inv_dx, self.dx
        return frame

    @ti.func
    def local(self, x, frame):
        """Grid coordinates of a place, in cells from the first node."""
        xi = ti.Vector.zero(float, self.dim)
        for d in ti.static(range(self.dim)):
            xi[d] = (x[d] - frame[d, 0]) * frame[d, 1]
        if ti.static(self.turned):
            c, s = self.direction[0], self.direction[1]
            a, b = xi[0] - self.middle[0], xi[1] - self.middle[1]
            xi[0], xi[1] = self.middle[0] + c * a + s * b, self.middle[1] - s * a + c * b
        return xi

    @ti.func
    def along_grid(self, tensor):
        """sigma R: columns of a tensor of space along the axes of the grid."""
        found = tensor
        if ti.static(self.turned):
            c, s = self.direction[0], self.direction[1]
            for d in ti.static(range(2)):
                found[d, 0], found[d, 1] = c * tensor[d, 0] + s * tensor[d, 1], c * tensor[d, 1] - s * tensor[d, 0]
        return found

    @ti.func
    def space_vector(self, v):
        """R v: a vector along the grid's axes, now along those of space."""
        found = v
        if ti.static(self.turned):
            c, s = self.direction[0], self.direction[1]
            found[0], found[1] = c * v[0] - s * v[1], s * v[0] + c * v[1]
        return found

    @ti.func
    def space_gradient(self, gradient):
        """L R^T: gradients of vectors along the grid's axes, now along those of space."""
        found = gradient
        if ti.static(self.turned):
            c, s = self.direction[0], self.direction[1]
            for d in ti.static(range(2)):
                a, b = gradient[d, 0], gradient[d, 1]
                found[d, 0], found[d, 1] = c * a - s * b, s * a + c * b
        return found

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
    def label(self, i):
        """Where node i was at the start."""
        x = ti.Vector(self.origin) + i * self.dx
        if ti.static(self.turned):
            c, s = self.direction[0], self.direction[1]
            a, b = x[0] - self.centre[0], x[1] - self.centre[1]
            x[0], x[1] = self.centre[0] + c * a - s * b, self.centre[1] + s * a + c * b
        return x
