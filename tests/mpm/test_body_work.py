"""The work of body forces, as it was done: in free fall, at rest, and under a force field; with every order of a step.

Walls are smooth and do no work.
"""

from dataclasses import dataclass, replace

import pytest
import taichi as ti

from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import BulkViscosity, NoViscosity
from rsmpm_ti.run.run import simulate
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule

DENSITY, GRAVITY, DX = 2600.0, 9.81, 0.5
STONE = Rock(
    density=DENSITY, elasticity=Hooke(E=17e9, nu=0.25), criterion=Unbreakable(), viscosity=BulkViscosity(c2=2.0)
)
ORDERS = ("musl", "usf", "usl")


def column(dim: int = 2, steps: int = 8000, cells: int = 6, **changes) -> Scene:
    """A column of one cell by so many, let go between smooth walls; viscosity brings it to rest."""
    top = (*(dim - 1) * (DX,), cells * DX)
    walls = [Wall(axis=dim - 1, side="lower", position=0.0)]
    walls += [
        Wall(axis=d, side=side, position=p) for d in range(dim - 1) for side, p in (("lower", 0.0), ("upper", DX))
    ]
    loading = Loading(boundaries=tuple(walls), body_force=(*(dim - 1) * (0.0,), -GRAVITY))
    settings = {
        "title": "column",
        "domain": Domain(lower=dim * (0.0,), upper=(*top[:-1], top[-1] + 2.0 * DX), dx=DX),
        "bodies": (Body(region=Box(lower=dim * (0.0,), upper=top)),),
        "rock": STONE,
        "loading": loading,
        "schedule": Schedule(t_end=1.0, cfl=0.5, rows=50),
        "shape": Linear() if changes.get("order") != "usl" else QuadraticBSpline(),
        "output": Output(frames=0, movie=False, vtu=0),
    }
    if changes.get("order") == "usl":  # its steps are short, and explicit viscosity makes them shorter
        settings["schedule"] = Schedule(t_end=1.0, cfl=0.2, rows=50)
    scene = Scene(**settings | changes)
    return replace(scene, schedule=replace(scene.schedule, t_end=steps * scene.dt))


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize(("dim", "time_scale", "threads"), [(2, 1.0, 1), (2, 3.0, 1), (2, 1.0, 2), (3, 1.0, 1)])
@pytest.mark.thorough("3-1.0-1-musl", "3-1.0-1-usl", "3-1.0-1-usf", "2-1.0-2-usf")
def test_weight_of_a_column_let_go_does_twice_the_work_that_is_stored_at_rest(order, dim, time_scale, threads):
    """Virtual work, W = f.u and U = f.u/2, whatever density it fell with; and W is the weight times its way down."""
    scene = column(dim, order=order)
    scene = replace(scene, loading=replace(scene.loading, time_scale=time_scale))
    scene = replace(scene, schedule=replace(scene.schedule, t_end=8000 * scene.dt))
    result = simulate(scene, threads=threads)
    work, stored = result.history["work_J"], result.history["energy_elastic_J"][-1]
    assert result.history["energy_kinetic_J"][-1] < 1e-9 * stored
    assert work[-1] == pytest.approx(2.0 * stored, rel=1e-5)  # strains are 1e-6
    sunk = -result.snapshot.displacement[:, -1].mean()
    weight = DENSITY * GRAVITY * DX ** (dim - 1) * 6 * DX
    assert work[-1] == pytest.approx(weight * sunk, rel=1e-6)
    assert abs(work[-1] - work[-2]) < 1e-7 * work[-1], "at rest nothing is booked"


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("transfer", [PicFlip(), PicFlip(flip=0.9), Apic()], ids=str)
@pytest.mark.parametrize("time_scale", [1.0, 4.0])
def test_work_of_a_free_fall_is_its_kinetic_energy(order, transfer, time_scale):
    shape = QuadraticBSpline() if order == "usl" else Linear()
    body = Body(region=Box(lower=(2.0, 4.0), upper=(3.0, 5.0)), velocity=(0.5, 1.0))
    scene = column(
        domain=Domain(lower=(0.0, 0.0), upper=(6.0, 8.0), dx=DX), bodies=(body,), shape=shape, order=order,
        loading=Loading(body_force=(30.0, -50.0), time_scale=time_scale), transfer=transfer,
        schedule=Schedule(t_end=1.0, cfl=0.3, rows=4), steps=300, rock=replace(STONE, viscosity=NoViscosity()),
    )  # fmt: skip
    history = simulate(scene, threads=1).history
    kinetic = history["energy_kinetic_J"]
    given = 0.5 * DENSITY * time_scale**2 * 1.0 * (0.5**2 + 1.0**2)
    assert history["work_J"] == pytest.approx(kinetic - given, rel=1e-9, abs=1e-9 * kinetic[-1])


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class TopLoad:
    """Downwards on the upper half of the column, from the first step on."""

    b: float

    @ti.func
    def acceleration(self, X, t):
        return ti.Vector([0.0, ti.select(X[1] > 1.5, -self.b, 0.0)])


@pytest.mark.parametrize("order", ORDERS)
def test_dead_load_of_a_force_field_does_force_times_displacement(order):
    load = TopLoad(b=100.0)
    scene = column(order=order)
    scene = replace(scene, loading=replace(scene.loading, body_force=None, force_field=load))
    result = simulate(scene, threads=1)
    snapshot = result.snapshot
    loaded = (snapshot.x - snapshot.displacement)[:, 1] > 1.5
    done = -DENSITY * (0.5 * DX) ** 2 * load.b * snapshot.displacement[loaded, 1].sum()
    assert result.history["work_J"][-1] == pytest.approx(done, rel=1e-6)
    assert result.history["work_J"][-1] == pytest.approx(2.0 * result.history["energy_elastic_J"][-1], rel=1e-5)
