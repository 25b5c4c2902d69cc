"""What a run holds: particles, background nodes, ledger and events, allocated for one scene and no more."""

import math

import numpy as np
import taichi as ti

from rsmpm_ti.errors import SceneError
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.fields.parallel import traversal
from rsmpm_ti.method.tensor_product import offsets, rows
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.spec.confinement import confined_volume_ratio
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Seeds

MOST_FRESH = 4096
"""Most particles that crack by mean stress in one step; the others wait for the next."""

NO_SHADE = 100.0
"""Angle [rad] beside a crack of a particle that none runs beside."""

BLOCK = 8
"""Cells per axis of a sparse block."""

FEW_NODES = 50_000
"""On a CPU, fewer nodes than these are done by one thread: 0.2 ms, as waking the others takes."""


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
        self.v_columns, self.f_columns, self.w_columns = (_components(field) for field in (self.v, self.f, self.w))
        self.momentum_columns = (self.mass, *self.v_columns)

    def forget_empty(self) -> None:
        """Deactivate every block; the next P2G activates those that hold material."""
        if self.blocks is not None:
            self.blocks.deactivate_all()


@ti.data_oriented
class Particles:
    """Particle fields, one array per component (SoA), in cell order. `id` is the seeding order.

    Position is reference + displacement: adding 1e-9 m to 0.1 m does nothing in float32.
    """

    def __init__(self, scene: Scene, count: int, real):
        dim, self.count = scene.dim, count

        def vector(n):
            return ti.Vector.field(n, real, count, layout=ti.Layout.SOA)

        self.reference, self.u, self.v = vector(dim), vector(dim), vector(dim)
        self.sigma = vector(PACKED_LENGTH[dim])
        self.L = ti.Matrix.field(dim, dim, real, count, layout=ti.Layout.SOA)  # within a step only: grad v [1/s]
        self.J, self.volume = ti.field(real, count), ti.field(real, count)  # volume: stress-free [m^dim]
        self.id = ti.field(ti.i32, count)
        self.affine, self.viscous = scene.transfer.affine, scene.rock.viscosity.acts
        self.breaks, self.varied = scene.rock.criterion.breaks, scene.rock.heterogeneity.varies
        real_fields = [self.reference, self.u, self.v, self.sigma, self.J, self.volume]
        whole_fields = [self.id]
        if self.affine:
            self.C = ti.Matrix.field(dim, dim, real, count, layout=ti.Layout.SOA)
            real_fields.append(self.C)
        if self.viscous:
            self.q = ti.field(real, count)
            real_fields.append(self.q)
        if self.varied:
            self.strength = ti.field(real, count)  # factor on cohesion and tensile strength
            real_fields.append(self.strength)
        if self.breaks:
            self.mode = ti.field(ti.i32, count)
            whole_fields.append(self.mode)
        self.cracks = self.breaks and scene.rock.after_failure.directional
        if self.cracks:
            # angle of the crack's normal [rad]; opening strains across it and along it, and their largest; slip strain
            self.crack_angle, self.slip = ti.field(real, count), ti.field(real, count)
            self.opening, self.widest = vector(2), vector(2)
            # energy lost so far [J]; `failed`: the mode by which the particle itself opened or slipped by what costs
            # half of the strength, while `mode` starts with the loss
            self.lost, self.failed = ti.field(real, count), ti.field(ti.i32, count)
            real_fields += [self.crack_angle, self.slip, self.opening, self.widest, self.lost]
            whole_fields.append(self.failed)
        if self.breaks and scene.rock.averaging.acts:
            # overload is of one step only; shade_angle: normal of the crack beside [rad]
            self.overload, self.shade_angle = ti.field(real, count), ti.field(real, count)
            # crack strain of the rock around, by which tensile strength is lost: as last averaged, and the largest
            self.mean_opening, self.worn = ti.field(real, count), ti.field(real, count)
            real_fields += [self.shade_angle, self.mean_opening, self.worn]
        self.real_components = tuple(c for field in real_fields for c in _components(field))
        self.whole_components = tuple(whole_fields)
        # cell key at the last sort and now, and room for sorting
        self.key, self.base, self.order = (ti.field(ti.i32, count) for _ in range(3))
        self.scratch = ti.field(real, count)


def _components(field) -> tuple:
    if isinstance(field, ti.MatrixField):
        columns = range(field.m) if field.ndim == 2 else (None,)
        return tuple(field.get_scalar_field(*((a,) if b is None else (a, b))) for a in range(field.n) for b in columns)
    return (field,)


@ti.data_oriented
class Events:
    """Failure events in the order in which they happen; at most one of each mode per particle."""

    def __init__(self, scene: Scene, capacity: int, real):
        self.count, self.by_mode = ti.field(ti.i32, ()), ti.field(ti.i32, 3)
        # when a particle first begins to lose strength: without fracture energy that is the first event
        self.onset = ti.field(ti.f64, ())
        self.onset[None] = np.inf
        self.directional = scene.rock.criterion.breaks and scene.rock.after_failure.directional
        if self.directional:
            capacity *= 2  # a particle that failed in tension may fail in shear later
        capacity = capacity if scene.rock.criterion.breaks else 1
        if self.directional:
            self.crack_angle = ti.field(real, capacity)  # of the crack's normal [rad]
        self.time, self.sigma_1 = ti.field(ti.f64, capacity), ti.field(real, capacity)
        self.sigma_3, self.released = ti.field(real, capacity), ti.field(real, capacity)
        self.x = ti.Vector.field(scene.dim, real, capacity)
        self.mode, self.id = ti.field(ti.i32, capacity), ti.field(ti.i32, capacity)


@ti.data_oriented
class Means:
    """Node fields of averages: sums of V sigma, V and V x crack strain, a second copy for blurring, and the largest
    overload."""

    def __init__(self, scene: Scene, grid: Grid, real):
        taps = scene.rock.averaging.taps(scene.domain.dx, scene.shape.variance)
        self.reach, self.taps = len(taps) // 2, ti.field(real, len(taps))
        self.taps.from_numpy(np.array(taps))
        self.sums, self.other = (ti.Vector.field(6, real, grid.nodes) for _ in range(2))
        self.peak, self.hot, self.any_hot = (
            ti.field(real, grid.nodes),
            ti.field(ti.i32, grid.nodes),
            ti.field(ti.i32, ()),
        )
        band = scene.shape.crack_band * scene.domain.dx
        self.band_share = scene.rock.averaging.band_share(band)
        self.variance = scene.rock.averaging.band_variance(band)
        # smallest tensile strength of a particle [Pa], and steps between two looks: the mean over a length cannot
        # change within a quarter of the time that a wave needs for it
        self.weakest = scene.rock.criterion.tensile_strength
        travel = scene.wave_speed * scene.dt
        self.interval = max(1, math.floor(0.25 * scene.rock.averaging.length / travel))
        # cracked particles whose shade has not been cast yet: place and angle of the crack's normal
        self.fresh, self.x, self.angle = (
            ti.field(ti.i32, ()),
            ti.Vector.field(2, real, MOST_FRESH),
            ti.field(real, MOST_FRESH),
        )


@ti.data_oriented
class Ledger:
    """Sums over steps, always float64: platen impulses [N s], their work [J], energy lost [J].

    `latest` is the work of the latest step alone: forces are those of a step's beginning, so that the work until now
    takes half of it again (trapezoidal rule).
    """

    def __init__(self, scene: Scene, slots: int):
        boundaries = max(1, len(scene.loading.boundaries))
        self.impulse = ti.Vector.field(scene.dim, ti.f64, boundaries)
        self.work, self.latest = ti.field(ti.f64, boundaries), ti.field(ti.f64, boundaries)
        self.body_work = ti.field(ti.f64, slots)
        self.viscous, self.released = ti.field(ti.f64, slots), ti.field(ti.f64, slots)


SCALARS = (
    "kinetic",
    "elastic",
    "speed",
    "J_min",
    "J_max",
    "J_intact",
    "sick",
    "sick_id",
    "outside",
    "strays",
    "far_strays",
    "work",
    "dissipated",
)
"""Numbers of a survey, in the order in which the report lists them."""


@ti.data_oriented
class Report:
    """What a survey sums into: scalar fields, because Taichi reduces those per thread, and one vector of them all."""

    def __init__(self, scene: Scene):
        for name in SCALARS:
            setattr(self, name, ti.field(ti.f64, ()))
        self.momentum = tuple(ti.field(ti.f64, ()) for _ in range(scene.dim))
        self.scalars = tuple(getattr(self, name) for name in SCALARS)
        self.sums = (*self.scalars, *self.momentum)
        self.boundary_count = len(scene.loading.boundaries)
        self.values = ti.field(ti.f64, len(SCALARS) + 2 + scene.dim + scene.dim * max(1, self.boundary_count))


@ti.data_oriented
class Simulation:
    """Everything kernels need, as one object: a kernel launch then looks up one template argument, not ten."""

    def __init__(self, scene: Scene, seeds: list[Seeds], real=ti.f64, gpu: bool = False, deterministic: bool = False):
        self.scene, self.real, self.dim = scene, real, scene.dim
        self.rock, self.shape, self.transfer = scene.rock, scene.shape, scene.transfer
        self.boundaries = scene.loading.boundaries
        self.stencil = offsets(scene.shape, scene.dim)
        self.rows = rows(scene.shape, scene.dim)
        self.size = len(self.stencil)  # nodes of a stencil
        self.band = scene.shape.crack_band * scene.domain.dx
        self.confinement = scene.loading.confinement
        self.confined = self.confinement > 0.0
        self.J_start = confined_volume_ratio(self.confinement, scene.rock.elasticity)
        # of the stress-free rock, to go with `particles.volume`; under the confinement it is the scene's
        self.density, self.wave_speed = scene.density * self.J_start, scene.wave_speed
        # mass scaling must leave the weight of a body unchanged, so its acceleration shrinks as its density grows
        force = scene.loading.body_force or (0.0,) * scene.dim
        self.heavy = any(component != 0.0 for component in force)
        self.lightness = 1.0 / scene.time_scale**2
        self.acceleration = tuple(component * self.lightness for component in force)
        self.force_field = scene.loading.force_field
        self.driven = self.force_field is not None
        self.grid = Grid(scene)
        self.drops = scene.domain.outside == "drop"
        count = sum(len(body.x) for body in seeds)
        if count >= 2**31:
            raise SceneError(f"{count} particles are more than 2^31 - 1; use a larger dx or fewer particles per axis")
        self.particles = Particles(scene, count, real)
        self.traversal = traversal(count, gpu, deterministic)
        self.nodes = Nodes(scene, self.grid, real, use_sparse_grid(scene, count))
        few = not gpu and math.prod(n - 2 * scene.domain.room for n in self.grid.nodes) < FEW_NODES
        self.nodes.serial = self.traversal.serial or self.traversal.ordered or few
        self.events, self.ledger = Events(scene, count, real), Ledger(scene, self.traversal.count)
        self.averaging = scene.rock.criterion.breaks and scene.rock.averaging.acts
        if self.averaging:
            self.means = Means(scene, self.grid, real)
        self.report = Report(scene)
        self._fill(scene, seeds)

    def _fill(self, scene: Scene, seeds: list[Seeds]) -> None:
        kind = np.float64 if self.real == ti.f64 else np.float32
        particles = self.particles
        x = np.concatenate([body.x for body in seeds])
        v = np.concatenate([initial_velocity(scene, k, body.x) for k, body in enumerate(seeds)])
        volume = np.concatenate([body.volume for body in seeds])
        # already in cell order, so that the first sort has nothing to move and its kernel need not be compiled
        base = np.floor((x - np.array(self.grid.origin)) * self.grid.inv_dx - self.shape.shift).astype(int)
        order = np.argsort(np.ravel_multi_index(base.T, self.grid.nodes, mode="clip"), kind="stable")
        particles.reference.from_numpy(x[order].astype(kind))
        particles.v.from_numpy(v[order].astype(kind))
        if self.averaging:
            particles.shade_angle.fill(NO_SHADE)
        particles.volume.from_numpy((volume[order] / self.J_start).astype(kind))
        particles.J.fill(self.J_start)
        if self.confined:
            packed = np.zeros((len(x), PACKED_LENGTH[self.dim]), dtype=kind)
            packed[:, :3] = -self.confinement
            particles.sigma.from_numpy(packed)
        particles.id.from_numpy(order.astype(np.int32))
        if particles.varied:
            strength = scene.rock.heterogeneity.factors(x, volume)  # one draw over all bodies
            particles.strength.from_numpy(strength[order].astype(kind))
            if self.averaging:
                self.means.weakest *= float(strength.min())


def initial_velocity(scene: Scene, body_index: int, x: np.ndarray) -> np.ndarray:
    """Velocity of a body's particles at the start [m/s], [n, dim].

    Affine start: linear between the platens along the axis, and its Poisson part across it, about the centre.
    """
    body, loading = scene.bodies[body_index], scene.loading
    v = np.tile(np.array(body.velocity or (0.0,) * scene.dim), (len(x), 1))
    low, high = (np.array(b) for b in body.region.bounds())
    centre = 0.5 * (low + high)
    if body.spin:
        v[:, 0] -= body.spin * (x[:, 1] - centre[1])
        v[:, 1] += body.spin * (x[:, 0] - centre[0])
    if isinstance(loading.start, Affine):
        lower, upper = loading.platens
        axis, elasticity = lower.axis, scene.rock.elasticity
        share = (x[:, axis] - lower.position) / loading.height
        v[:, axis] += lower.speed + (upper.speed - lower.speed) * share
        ratio = elasticity.lateral_ratio(scene.dim)
        for lateral in (d for d in range(scene.dim) if d != axis):
            v[:, lateral] += ratio * loading.strain_rate * (x[:, lateral] - centre[lateral])
    return v


def use_sparse_grid(scene: Scene, particle_count: int) -> bool:
    """'auto' takes the sparse grid where less than a quarter of the nodes can hold material."""
    if scene.domain.outside == "grow":
        return True
    if scene.domain.grid != "auto":
        return scene.domain.grid == "sparse"
    per_cell = min(body.seeding.particles_per_axis for body in scene.bodies) ** scene.dim
    return particle_count / per_cell < 0.25 * np.prod(Grid(scene).nodes)
