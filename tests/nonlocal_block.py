"""A square of rock that averages over a length, for tests that give it stress or crack strain."""

import functools

import numpy as np

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import QuadraticBSpline
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box, Difference
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice

DX = 1e-3
ROCK = {
    "density": 2600.0,
    "elasticity": Hooke(E=17e9, nu=0.14),
    "criterion": MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
    "after_failure": Directional(),
}


@functools.cache  # kernels compile for each one; every test gives its own stress
def block(cells, shape=QuadraticBSpline(), length=2.0 * DX, seeding=Lattice(), removed=(), walls=()) -> Simulation:  # noqa: B008
    """A square of rock, `cells` of 1 mm wide."""
    edge = (cells * DX,) * 2
    box = Box(lower=(0.0, 0.0), upper=edge)
    scene = Scene(
        title="block",
        domain=Domain(lower=(0.0, 0.0), upper=edge, dx=DX),
        bodies=(Body(region=Difference(whole=box, removed=removed) if removed else box, seeding=seeding),),
        rock=Rock(**ROCK, nonlocal_mean=Nonlocal(length=length)),
        loading=Loading(boundaries=walls),
        schedule=Schedule(t_end=1e-6),
        shape=shape,
    )
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    return sim


def positions(sim: Simulation) -> np.ndarray:
    return sim.particles.reference.to_numpy()
