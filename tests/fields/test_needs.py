"""A scene allocates the fields that its own physics needs, and no others."""

from dataclasses import replace

import pytest
import taichi as ti

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.transfer import Apic
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.heterogeneity import Weibull
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import ExponentialSoftening
from rsmpm_ti.rock.viscosity import BulkViscosity, NoViscosity
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

pytestmark = pytest.mark.usefixtures("taichi_f64")

STRENGTH = MohrCoulomb(cohesion=6e6, friction_angle=40.0, tensile_strength=2e6)
BARE = Scene(
    title="bare",
    domain=Domain(lower=(0.0, 0.0), upper=(0.02, 0.02), dx=1e-3),
    bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(0.02, 0.02))),),
    rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable(), viscosity=NoViscosity()),
    loading=Loading(),
    schedule=Schedule(t_end=1e-5),
    order="usl",
)
HISTORY = {"crack_normal", "crack_strain", "crack_strain_max", "slip", "dissipated", "failed"}
SOFT = Directional(softening=ExponentialSoftening(G_f_I=5.0, G_f_II=50.0))


def rock(**parts):
    return replace(BARE, rock=replace(BARE.rock, **parts))


ADDED = {
    "viscosity": (rock(viscosity=BulkViscosity()), {"q"}),
    "affine transfer": (replace(BARE, transfer=Apic()), {"C"}),
    "failure": (rock(criterion=STRENGTH), {"mode"}),
    "heterogeneity": (
        rock(criterion=STRENGTH, heterogeneity=Weibull(shape=6.0, reference_volume=1e-6)),
        {"mode", "strength"},
    ),
    "directional cracks": (
        rock(criterion=STRENGTH, after_failure=SOFT),
        {"mode", *HISTORY},
    ),
    "mean stress": (
        rock(criterion=STRENGTH, after_failure=SOFT, nonlocal_mean=Nonlocal(length=3e-3)),
        {"mode", *HISTORY, "overload", "to_crack", "nearest_normal", "crack_strain_nonlocal",
         "crack_strain_max_nonlocal", "slip_nonlocal", "slip_max_nonlocal"},
    ),
}  # fmt: skip


def fields(thing) -> set[str]:
    return {name for name, value in vars(thing).items() if isinstance(value, (ti.Field, ti.MatrixField))}


def simulation(scene: Scene) -> Simulation:
    return Simulation(scene, scene.particles())


@pytest.fixture(scope="module")
def bare(taichi_f64) -> Simulation:
    return simulation(BARE)


@pytest.mark.parametrize("need", ADDED)
def test_each_piece_of_physics_adds_its_own_particle_fields_and_no_others(bare, need):
    scene, expected = ADDED[need]
    sim = simulation(scene)
    found = fields(sim.particles) | fields(sim.particles.history)
    assert found - fields(bare.particles) == expected and not fields(bare.particles.history)
    assert fields(sim.nodes) == fields(bare.nodes)
    assert hasattr(sim, "nonlocal_sums") == (need == "mean stress")


def test_a_plane_scene_stores_two_components_and_four_stresses(bare):
    particles = bare.particles
    assert [f.n for f in (particles.reference, particles.u, particles.v, particles.sigma)] == [2, 2, 2, 4]
    assert bare.events.time.shape == (1,), "unbreakable rock has no events"


def test_only_musl_stores_a_velocity_mapped_back(bare):
    added = {name for name in ("v_remapped", "v_moving") if getattr(bare.nodes, name) is not bare.nodes.v}
    musl = simulation(replace(BARE, order="musl")).nodes
    assert added == set() and all(getattr(musl, name) is not musl.v for name in ("v_remapped", "v_moving"))


@pytest.mark.parametrize(("weight", "loaded"), [(None, False), ((0.0, 0.0), False), ((0.0, -9.81), True)])
def test_work_of_gravity_is_booked_only_where_there_is_some(weight, loaded):
    scene = replace(BARE, loading=Loading(body_force=weight))
    assert simulation(scene).loaded is loaded, "kernels are compiled with or without it"
