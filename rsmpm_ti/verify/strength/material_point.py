"""Particles that are strained by hand: the stress update and failure check of a run, without grid and motion."""

import math
from dataclasses import dataclass

import numpy as np
import taichi as ti

from rsmpm_ti.failure.stress_update import check_failure, update_stress
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice


@dataclass(frozen=True)
class History:
    """One particle per path, after every step."""

    sigma: np.ndarray  # [paths, steps, 4]: xx, yy, zz, xy, Cauchy, tension positive [Pa]
    mode: np.ndarray  # [paths, steps]: 0 intact, 1 failed in tension, 2 in shear
    lost: np.ndarray  # energy lost since the start, per initial volume [J/m^3], [paths, steps]
    opening: np.ndarray  # crack strain, [paths, steps, 2]: across the crack and along it, or of pores and 0
    normal: np.ndarray  # of the crack, [paths, steps, 2]
    carrying: np.ndarray  # volume that carries stress over the stress-free volume, [paths, steps]


def gradients(strain: np.ndarray) -> np.ndarray:
    """Displacement gradients of steps [..., steps, 2, 2] between strains (xx, yy, xy) [..., steps + 1, 3].

    G = D (1 - D/2)^-1, whose gradient at mid-step is the increment D itself, so that strains add up without error.
    """
    D = np.diff(strain, axis=-2)[..., [0, 2, 2, 1]].reshape(*strain.shape[:-2], -1, 2, 2)
    return D @ np.linalg.inv(np.eye(2) - 0.5 * D)


def simple_shear(strain: np.ndarray) -> np.ndarray:
    """As `gradients`, with a spin that keeps lines along x as they are: rock that slides along them."""
    D = np.diff(strain, axis=-2)[..., [0, 2, 2, 1]].reshape(*strain.shape[:-2], -1, 2, 2)
    D[..., 0, 1] *= 2.0
    D[..., 1, 0] = 0.0
    return D @ np.linalg.inv(np.eye(2) - 0.5 * D)


def turned_by(G: np.ndarray, angles: np.ndarray) -> np.ndarray:
    """The same steps [..., steps, 2, 2] seen from a frame that stands at -angles [steps + 1] [rad]."""
    Q = np.moveaxis(np.array([[np.cos(angles), -np.sin(angles)], [np.sin(angles), np.cos(angles)]]), -1, 0)
    back = np.swapaxes(Q[:-1], -1, -2)
    return Q[1:] @ G @ back + (Q[1:] @ back - np.eye(2))


@ti.kernel
def _follow(sim: ti.template(), G: ti.types.ndarray(), sigma: ti.types.ndarray(), rest: ti.types.ndarray()):
    particles = sim.particles
    for p in range(G.shape[0]):
        for k in range(G.shape[1]):
            L = ti.Matrix([[G[p, k, 0, 0], G[p, k, 0, 1]], [G[p, k, 1, 0], G[p, k, 1, 1]]])
            particles.L[p] = L
            update_stress(sim, p, L, 1.0)
            check_failure(sim, p, 1.0, ti.cast(k, ti.f64), 0)
            for component in ti.static(range(4)):
                sigma[p, k, component] = particles.sigma[p][component]
            rest[p, k, 0] = particles.mode[p]
            rest[p, k, 1] = particles.history.dissipated[p]
            rest[p, k, 2] = sim.rock.after_failure.carrying_ratio(sim, p)
            for axis in ti.static(range(2)):
                rest[p, k, 3 + axis] = particles.history.crack_strain[p][axis]
                rest[p, k, 5 + axis] = particles.history.crack_normal[p][axis]


def follow(rock: Rock, dx: float, G: np.ndarray) -> History:
    """Take one particle of a rock that cracks with a direction along each path G [paths, steps, 2, 2].

    dx [m] is the cell size, and with linear functions the width of the crack band. Taichi must have been started.
    """
    upper = (math.ceil(len(G) / 4) * dx, dx)
    scene = Scene(
        title="material points",
        domain=Domain(lower=(0.0, 0.0), upper=upper, dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=upper), seeding=Lattice()),),
        rock=rock,
        loading=Loading(),
        schedule=Schedule(t_end=1.0),
        shape=Linear(),
    )
    sim = Simulation(scene, scene.particles())
    sigma, rest = np.zeros((*G.shape[:2], 4)), np.zeros((*G.shape[:2], 7))
    _follow(sim, np.ascontiguousarray(G), sigma, rest)
    return History(
        sigma=sigma,
        mode=rest[..., 0].astype(int),
        lost=rest[..., 1],
        carrying=rest[..., 2],
        opening=rest[..., 3:5],
        normal=rest[..., 5:7],
    )
