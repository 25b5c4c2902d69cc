"""What a run holds: particles, background nodes, ledger and events, allocated for one scene and no more."""

import copy
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
from rsmpm_ti.spec.bodies.rocks import rock_indices
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
    rock: np.ndarray  # index in `Scene.rocks`, [n]
    J_start: tuple[float, ...]  # of all particles of each rock together


def seeded(scene: Scene, seeds: list[Seeds]) -> Seeded:
    """seeds: `scene.particles()`."""
    x, volume = (np.concatenate([getattr(body, name) for body in seeds]) for name in ("x", "volume"))
    rock = np.repeat(rock_indices(scene), [len(body.x) for body in seeds])
    if scene.loading.initial_stress is not None:
        stress, J = start_stress(scene, x, np.array([one.elasticity.bulk for one in scene.rocks])[rock])
        of_rock = [rock == k for k in range(len(scene.rocks))]
        starts = tuple(float(volume[own].sum() / (volume / J)[own].sum()) for own in of_rock)
        return Seeded(x, volume, stress, J, rock, starts)
    pressure = scene.loading.confinement
    ratios = tuple(confined_volume_ratio(pressure, one.elasticity) for one in scene.rocks)
    return Seeded(x, volume, -pressure * np.ones((len(x), 3)), np.array(ratios)[rock], rock, ratios)


def densities(scene: Scene, all_of: Seeded) -> np.ndarray:
    """Of the stress-free rock of all particles, without mass scaling [kg/m^dim], [n]."""
    return np.array([rock.density * J for rock, J in zip(scene.rocks, all_of.J_start, strict=True)])[all_of.rock]


def strength_factors(scene: Scene, all_of: Seeded) -> np.ndarray:
    """Of all particles, [n]: one draw for each rock over all bodies of it."""
    factors = np.ones(len(all_of.x))
    for k, rock in enumerate(scene.rocks):
        own = all_of.rock == k
        factors[own] = rock.heterogeneity.factors(all_of.x[own], all_of.volume[own])
    return factors


@ti.data_oriented
class Simulation:
    """Everything kernels need, as one object: a kernel launch then looks up one template argument, not ten.

    views: for each rock, in the order of `Scene.rocks`, this object as it is where only that rock is asked: the same
    fields, and of the rock its laws, density, wave speed and means. With one rock that is this object itself.
    """

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
        begun = seeded(scene, seeds)
        self._be_of(0, begun)
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
        self.report = Report(scene)
        self.walls = Walls(scene, self.grid, Seeds(begun.x, begun.volume))
        self.several = len(scene.rocks) > 1
        self.views = tuple(copy.copy(self) if self.several else self for _ in scene.rocks)
        for k, view in enumerate(self.views):
            view._be_of(k, begun)
            if view.is_nonlocal:
                view.nonlocal_sums = NonlocalSums(scene, view.rock, self.grid, real)
        self.nonlocal_views = tuple(view for view in self.views if view.is_nonlocal)
        self.is_nonlocal = bool(self.nonlocal_views)
        # steps between two looks for cracks by mean stress
        self.look_interval = min((view.nonlocal_sums.interval for view in self.nonlocal_views), default=0)
        self._fill(scene, seeds, begun)

    def _be_of(self, index: int, begun: Seeded) -> None:
        """Of one rock of the scene."""
        scene = self.scene
        self.index, self.rock, self.J_start = index, scene.rocks[index], begun.J_start[index]
        # of the stress-free rock, to go with `particles.volume`; as it starts it is the scene's
        self.density = self.rock.density * scene.time_scale**2 * self.J_start
        self.wave_speed = self.rock.wave_speed(scene.time_scale)
        self.is_nonlocal = self.rock.criterion.breaks and self.rock.nonlocal_mean.acts

    def _fill(self, scene: Scene, seeds: list[Seeds], begun: Seeded) -> None:
        """Particles as they start."""
        x, volume, stress, J, rock, _ = begun
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
        if self.several:
            particles.rock.from_numpy(rock[order].astype(np.int32))
        if particles.varied:
            strength = strength_factors(scene, begun)
            particles.strength.from_numpy(strength[order].astype(kind))
            for view in self.nonlocal_views:
                view.nonlocal_sums.weakest *= float(strength[rock == view.index].min())


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
