"""What a run holds: particles, background nodes, ledger and events, allocated for one scene and no more."""

import math
from typing import NamedTuple

import numpy as np
import taichi as ti

from rsmpm_ti.errors import SceneError
from rsmpm_ti.fields.contacts import Contacts
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.fields.holes.walls import Walls
from rsmpm_ti.fields.nodes import Nodes
from rsmpm_ti.fields.nonlocal_sums import NonlocalSums
from rsmpm_ti.fields.parallel import traversal
from rsmpm_ti.fields.particles import Particles
from rsmpm_ti.fields.records import Events, Ledger, Report
from rsmpm_ti.method.tensor_product import offsets, rows
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.spec.confinement import confined_volume_ratio
from rsmpm_ti.spec.ground.in_situ import start_stress
from rsmpm_ti.spec.holes.excavation import Excavation
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.review.memory import use_sparse_grid
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.seeding import Seeds

SERIAL_NODES = 50_000
"""On a CPU, fewer nodes than these are done by one thread: 0.2 ms, as waking the others takes."""


@ti.data_oriented
class NoForceField:
    """In place of a scene's force field; the compiler leaves out what is multiplied by zero."""

    @ti.func
    def acceleration(self, X, t):
        return ti.Vector.zero(float, X.n)


class Seeded(NamedTuple):
    """All particles of a scene as they are seeded, in the order of their ids."""

    x: np.ndarray  # [m], [n, dim]
    volume: np.ndarray  # as the scene is drawn [m^dim], [n]
    stress: np.ndarray  # along axes [Pa], [n, 3]
    J: np.ndarray  # volume over the stress-free one, [n]
    J_start: float  # of all together


def seeded(scene: Scene, seeds: list[Seeds]) -> Seeded:
    """seeds: `scene.particles()`."""
    x, volume = (np.concatenate([getattr(body, name) for body in seeds]) for name in ("x", "volume"))
    if scene.loading.initial_stress is not None:
        stress, J = start_stress(scene, x)
        return Seeded(x, volume, stress, J, float(volume.sum() / (volume / J).sum()))
    pressure = scene.loading.confinement
    ratio = confined_volume_ratio(pressure, scene.rock.elasticity)
    return Seeded(x, volume, -pressure * np.ones((len(x), 3)), np.broadcast_to(ratio, len(x)), ratio)


@ti.data_oriented
class Simulation:
    """Everything kernels need, as one object: a kernel launch then looks up one template argument, not ten."""

    def __init__(self, scene: Scene, seeds: list[Seeds], real=ti.f64, gpu: bool = False, deterministic: bool = False):
        self.scene, self.real, self.dim = scene, real, scene.dim
        self.rock, self.shape, self.transfer = scene.rock, scene.shape, scene.transfer
        self.boundaries = scene.loading.boundaries
        self.absorbing = tuple(k for k, b in enumerate(self.boundaries) if getattr(b, "absorbs", False))
        self.stencil = offsets(scene.shape, scene.dim)
        self.rows = rows(scene.shape, scene.dim)
        self.size = len(self.stencil)  # nodes of a stencil
        self.band = scene.shape.crack_band * scene.domain.dx
        self.confinement = scene.loading.confinement
        self.mixes = getattr(scene.transfer, "flip", 1.0) < 1.0  # PIC's part takes energy, which is booked
        self.local_damping = scene.local_damping
        if self.local_damping > 0.0:  # which boundaries the load presses between, along which axis
            lower, upper = scene.loading.ends
            self.ends = self.boundaries.index(lower), self.boundaries.index(upper), lower.axis
        self.confined = self.confinement > 0.0
        x, volume, stress, J, self.J_start = seeded(scene, seeds)
        # of the stress-free rock, to go with `particles.volume`; as it starts it is the scene's
        self.density, self.wave_speed = scene.density * self.J_start, scene.wave_speed
        # mass scaling must leave the weight of a body unchanged, so its acceleration shrinks as its density grows
        force = scene.loading.body_force or (0.0,) * scene.dim
        self.lightness = 1.0 / scene.time_scale**2
        self.acceleration = tuple(component * self.lightness for component in force)
        self.force_field = scene.loading.force_field or NoForceField()
        self.loaded = any(component != 0.0 for component in force) or scene.loading.force_field is not None
        self.grid = Grid(scene)
        self.contacts = Contacts(scene, self.grid, real)
        self.drops = scene.domain.outside == "drop"
        self.outside_is_sick = 0 if self.drops else 1
        self.loses = self.drops or any(isinstance(hole, Excavation) for hole in scene.loading.holes)
        count = sum(len(body.x) for body in seeds)
        if count >= 2**31:
            raise SceneError(f"{count} particles are more than 2^31 - 1; use a larger dx or fewer particles per axis")
        self.particles = Particles(scene, count, real)
        self.traversal = traversal(count, gpu, deterministic)
        self.nodes = Nodes(scene, self.grid, real, use_sparse_grid(scene, count))
        few = not gpu and math.prod(n - 2 * scene.domain.room for n in self.grid.nodes) < SERIAL_NODES
        self.nodes.serial = self.traversal.serial or self.traversal.ordered or few
        self.events, self.ledger = (
            Events(scene, count, real, self.particles.history),
            Ledger(scene, self.traversal.count),
        )
        self.is_nonlocal = scene.rock.criterion.breaks and scene.rock.nonlocal_mean.acts
        if self.is_nonlocal:
            self.nonlocal_sums = NonlocalSums(scene, self.grid, real)
        self.report = Report(scene)
        self.walls = Walls(scene, self.grid, Seeds(x, volume))
        self._fill(scene, seeds, x, volume, stress, J)

    def _fill(self, scene: Scene, seeds: list[Seeds], x, volume, stress, J) -> None:
        """Particles as they start: x [m], [n, dim]; volume [m^dim], [n]; stress along axes [Pa], [n, 3]; J, [n]."""
        kind = np.float64 if self.real == ti.f64 else np.float32
        particles = self.particles
        v = np.concatenate([initial_velocity(scene, k, body.x) for k, body in enumerate(seeds)])
        # already in cell order, so that the first sort has nothing to move and its kernel need not be compiled
        base = np.floor(self.grid.coordinates_at(x) - self.shape.shift).astype(int)
        order = np.argsort(np.ravel_multi_index(base.T, self.grid.nodes, mode="clip"), kind="stable")
        particles.reference.from_numpy(x[order].astype(kind))
        particles.v.from_numpy(v[order].astype(kind))
        particles.volume.from_numpy((volume / J)[order].astype(kind))
        particles.J.from_numpy(J[order].astype(kind))
        if stress.any():
            packed = np.zeros((len(x), PACKED_LENGTH[self.dim]), dtype=kind)
            packed[:, :3] = stress[order]
            particles.sigma.from_numpy(packed)
        particles.id.from_numpy(order.astype(np.int32))
        if particles.varied:
            strength = scene.rock.heterogeneity.factors(x, volume)  # one draw over all bodies
            particles.strength.from_numpy(strength[order].astype(kind))
            if self.is_nonlocal:
                self.nonlocal_sums.weakest *= float(strength.min())


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
        fraction = (x[:, axis] - lower.position) / loading.height
        v[:, axis] += lower.speed + (upper.speed - lower.speed) * fraction
        ratio = elasticity.lateral_ratio(scene.dim)
        for lateral in (d for d in range(scene.dim) if d != axis):
            v[:, lateral] += ratio * loading.strain_rate * (x[:, lateral] - centre[lateral])
    return v
