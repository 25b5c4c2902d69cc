"""Particles anywhere in the domain in any state, and a whole time step of theirs against plain NumPy."""

from types import SimpleNamespace

import numpy as np
import taichi as ti
from harness import epsilon

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import QuadraticBSpline
from rsmpm_ti.method.transfer import Apic
from rsmpm_ti.mpm.nodes import clear_nodes
from rsmpm_ti.mpm.plain import PlainStep
from rsmpm_ti.mpm.stepper import LOAD, ORDERS, scatter_all
from rsmpm_ti.mpm.wall_nodes import fold
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.rock.viscosity import BulkViscosity, NoViscosity
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Seeds

DX = 0.5e-3
CELLS = (24, 6)
COUNT = 150
LOWER = Wall(axis=1, side="lower", position=0.0)
UPPER = Wall(axis=1, side="upper", position=CELLS[1] * DX)


def make_scene(shape, transfer, *, order="musl", cells=CELLS, boundaries=(), viscosity=None, body_force=None) -> Scene:
    dim = len(cells)
    upper = tuple(c * DX for c in cells)
    return Scene(
        title="cloud",
        domain=Domain(lower=(0.0,) * dim, upper=upper, dx=DX),
        bodies=(Body(region=Box(lower=(0.0,) * dim, upper=upper)),),
        rock=Rock(
            density=2600.0,
            elasticity=Hooke(E=17e9, nu=0.14),
            criterion=Unbreakable(),
            viscosity=viscosity or NoViscosity(),
        ),
        loading=Loading(boundaries=boundaries, body_force=body_force),
        schedule=Schedule(t_end=1e-6, cfl=0.3),
        shape=shape,
        transfer=transfer,
        order=order,
    )


def cloud(scene: Scene, sim: Simulation) -> SimpleNamespace:
    """Put particles anywhere in the domain in any state; the same state in NumPy, by particle id."""
    random, dim = np.random.default_rng(17), scene.dim
    upper = np.array(scene.domain.upper)
    state = SimpleNamespace(
        reference=random.uniform(1e-4 * DX, upper - 1e-4 * DX, size=(COUNT, dim)),
        u=np.zeros((COUNT, dim)),
        v=random.normal(size=(COUNT, dim)),
        sigma=random.normal(size=(COUNT, PACKED_LENGTH[dim])) * 1e6,
        J=random.uniform(0.9, 1.1, size=COUNT),
        volume=np.full(COUNT, (0.5 * DX) ** dim),
        C=random.normal(size=(COUNT, dim, dim)) * 1e3 * scene.transfer.affine,
        q=random.uniform(0.0, 1e6, size=COUNT) * scene.rock.viscosity.acts,
    )
    put(sim, state)
    return state


def put(sim: Simulation, state: SimpleNamespace) -> None:
    kind = np.float64 if sim.real == ti.f64 else np.float32
    for name, values in vars(state).items():
        if hasattr(sim.particles, name):
            getattr(sim.particles, name).from_numpy(values.astype(kind))
    sim.particles.id.from_numpy(np.arange(COUNT, dtype=np.int32))
    sort_particles(sim)


def simulation(scene: Scene, real=ti.f64, gpu=False) -> Simulation:
    """gpu: with the GPU's traversal, on the CPU."""
    return Simulation(scene, [Seeds(np.zeros((COUNT, scene.dim)), np.zeros(COUNT))], real, gpu)


def by_id(sim: Simulation, name: str) -> np.ndarray:
    field = getattr(sim.particles, name).to_numpy().astype(float)
    return field[np.argsort(sim.particles.id.to_numpy())]


def close(found, expected, eps: float, times: float = 3e4) -> None:
    """Equal within `times` round-offs of the largest entry: sums of some 30 products, divided by nodes that hold as
    little as a thousandth of a particle."""
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=times * eps * np.abs(expected).max())


@ti.kernel
def fold_sums(sim: ti.template()):
    fold(sim.nodes.momentum_columns, sim.grid.walls)
    fold(sim.nodes.f_columns, sim.grid.walls)


def compare_step(scene: Scene, sim: Simulation) -> None:
    state = cloud(scene, sim)
    plain, dt, eps = PlainStep(scene, state), scene.dt, epsilon(sim.real)
    clear_nodes(sim)
    scatter_all(sim, LOAD, 0.0)
    fold_sums(sim)
    size = -1, scene.dim
    close(sim.nodes.mass.to_numpy().ravel(), plain.mass, eps, 100)
    close(sim.nodes.v.to_numpy().reshape(size), plain.momentum(), eps, 100)
    close(sim.nodes.f.to_numpy().reshape(size), plain.internal_force(), eps, 100)
    ORDERS[scene.order](sim, dt, 0.0, [1.0])
    plain.step(dt)
    for name in ("u", "v", "sigma", "J", *("C",) * sim.particles.affine, *("q",) * sim.particles.viscous):
        close(by_id(sim, name), getattr(state, name), eps)


def free_scene(shape, transfer, order="musl", body_force=None) -> Scene:
    return make_scene(shape, transfer, order=order, viscosity=BulkViscosity(), body_force=body_force)


def walled_scene(shape) -> Scene:
    """One wall, so that both sides of the grid are met over all shapes; free material is far from it."""
    return make_scene(shape, Apic(), boundaries=(UPPER if isinstance(shape, QuadraticBSpline) else LOWER,))
