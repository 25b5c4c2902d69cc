"""A grid turned against its domain: the same mechanics in every direction, and platens that press by their position."""

from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from small_scene import refusal

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.method.shape import Gimp, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.uniaxial import uniaxial_test
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.review.slit_check import Turn, slit_tie
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice, Seeds

pytestmark = pytest.mark.usefixtures("taichi_f64")

STONE = Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable())
TURN = 26.565


def free(turn: float, **changes) -> Scene:
    """A free block of 8 x 12 mm in a square of 40 mm, whose middle is a node."""
    return Scene(
        title="free",
        domain=Domain(lower=(0.0, 0.0), upper=(0.04, 0.04), dx=1e-3, turn=turn),
        bodies=(Body(region=Box(lower=(0.016, 0.014), upper=(0.024, 0.026))),),
        rock=STONE,
        loading=Loading(),
        schedule=Schedule(t_end=1e-4),
        **changes,
    )


def swung(turn: float, rotation: np.ndarray, **changes):
    """State by particle after 60 steps from a velocity field, all of it rotated: u and v [n, 2], sigma [n, 2, 2]."""
    scene, middle = free(turn, **changes), np.array([0.02, 0.02])
    (seeds,) = free(0.0).particles()
    places = Seeds(middle + (seeds.x - middle) @ rotation.T, seeds.volume)
    drive = Drive(scene, [places], ti.f64)
    particles = drive.sim.particles
    local = seeds.x[particles.id.to_numpy()] - middle
    v = np.stack([2.0 * np.sin(300.0 * local[:, 1]), 3.0 * np.cos(200.0 * local[:, 0])], axis=1)
    particles.v.from_numpy(v @ rotation.T)
    drive.advance(60)
    order = np.argsort(particles.id.to_numpy())
    packed = particles.sigma.to_numpy()[order]
    sigma = packed[:, [0, 3, 3, 1]].reshape(-1, 2, 2)
    return particles.u.to_numpy()[order], particles.v.to_numpy()[order], sigma


@pytest.mark.parametrize(
    ("turn", "shape", "transfer"),
    [
        (TURN, QuadraticBSpline(), PicFlip()),
        pytest.param(-40.0, Gimp(), Apic(), marks=pytest.mark.validation),  # half a minute to compile
    ],
    ids=str,
)
@pytest.mark.thorough
def test_a_body_on_a_turned_grid_moves_as_the_body_turned_back_on_a_straight_one(turn, shape, transfer):
    c, s = np.cos(np.radians(turn)), np.sin(np.radians(turn))
    back = np.array([[c, s], [-s, c]])
    u, v, sigma = swung(turn, np.eye(2), shape=shape, transfer=transfer)
    u_back, v_back, sigma_back = swung(0.0, back, shape=shape, transfer=transfer)
    assert np.abs(u).max() > 1e-5 and np.abs(sigma).max() > 1e6
    # round-off of 60 steps
    assert np.abs(u @ back.T - u_back).max() < 1e-10 * np.abs(u).max()
    assert np.abs(v @ back.T - v_back).max() < 1e-9 * np.abs(v).max()
    assert np.abs(back @ sigma @ back.T - sigma_back).max() < 1e-9 * np.abs(sigma).max()


def pressed(**changes) -> Scene:
    return uniaxial_test(
        title="pressed",
        rock=STONE,
        dx=1e-3,
        width=20e-3,
        height=40e-3,
        turn=TURN,
        transfer=PicFlip(flip=0.99),
        time_scale=10.0,
        **changes,
    )


@pytest.mark.parametrize("strain", [1e-3, -1e-3])
@pytest.mark.thorough
def test_platens_strain_a_plate_uniformly_by_their_position(strain):
    scene = pressed(strain_end=strain, speed=np.copysign(2.5e-3, strain))
    drive = Drive(scene, scene.particles(), ti.f64)
    drive.advance(drive.clock.total)
    sigma = drive.sim.particles.sigma.to_numpy()
    exact = -strain * STONE.elasticity.E / (1.0 - STONE.elasticity.nu**2)
    # the sides cut through cells of a turned grid: what they hold rings
    assert sigma[:, 1].mean() == pytest.approx(exact, rel=0.01)
    assert np.abs(sigma[:, 1] - exact).mean() < 0.02 * abs(exact)
    assert np.abs(sigma[:, [0, 3]]).mean() < 0.02 * abs(exact)


def test_a_turned_grid_knows_no_planes_of_nodes():
    scene = pressed(strain_end=1e-3)
    lower, upper = scene.loading.boundaries

    def with_boundaries(*boundaries, **changes):
        return replace(scene, loading=replace(scene.loading, boundaries=boundaries, **changes))

    plain = replace(upper, pulls=False)
    assert "pulls = True on a turned grid" in refusal(lambda: with_boundaries(lower, plain))
    assert "smooth and without a span" in refusal(lambda: with_boundaries(lower, replace(upper, friction=0.1)))
    assert "smooth and without a span" in refusal(lambda: with_boundaries(lower, replace(upper, span=(0.0, 0.01))))
    wall = Wall(axis=0, side="lower", position=-5e-3)
    assert "two platens that face each other, alone" in refusal(lambda: with_boundaries(lower, upper, wall))
    assert "0 in 3D" in refusal(lambda: Domain(lower=(0.0,) * 3, upper=(1.0,) * 3, dx=0.1, turn=10.0))
    assert "in [-45, 45] degrees" in refusal(lambda: replace(scene.domain, turn=50.0))


@pytest.mark.thorough
def test_a_ramp_presses_a_turned_grid_too():
    scene = pressed(strain_end=3e-4)
    ramp = Ramp(time=8.0 * 40e-3 / scene.wave_speed)
    scene = replace(scene, loading=replace(scene.loading, start=ramp))
    drive = Drive(scene, scene.particles(), ti.f64)
    drive.advance(drive.clock.total)
    sigma = drive.sim.particles.sigma.to_numpy()
    exact = -3e-4 * STONE.elasticity.E / (1.0 - STONE.elasticity.nu**2)
    assert sigma[:, 1].mean() == pytest.approx(exact, rel=0.02)


def test_what_ties_a_slit_is_measured_as_the_turned_grid_sees_it():
    slit = Slit(centre=(20e-3, 20e-3), length=15e-3, width=1e-3, angle=20.0)
    whole = Box(lower=(0.0, 0.0), upper=(40e-3, 40e-3))
    seeds = Lattice().fill(Difference(whole=whole, removed=(slit,)), np.zeros(2), 1e-3)
    plain = slit_tie(seeds, slit, QuadraticBSpline(), 1e-3, np.zeros(2))
    c, s = np.cos(np.radians(TURN)), np.sin(np.radians(TURN))
    node = np.array([0.1, 0.2])
    turned = Seeds(node + seeds.x @ np.array([[c, s], [-s, c]]), seeds.volume)
    centre = tuple(node + np.array(slit.centre) @ np.array([[c, s], [-s, c]]))
    rotated = replace(slit, centre=centre, angle=slit.angle + TURN)
    back = slit_tie(*Turn(node, TURN).back(turned, rotated), QuadraticBSpline(), 1e-3, np.zeros(2))
    assert plain.passed > 0.01
    assert back.passed == pytest.approx(plain.passed, rel=1e-6)
    assert back.highest == pytest.approx(plain.highest, rel=1e-6)


def test_cells_are_sorted_by_where_they_are_on_a_turned_grid():
    scene = free(TURN)
    drive = Drive(scene, scene.particles(), ti.f64)
    before = drive.sim.particles.id.to_numpy()
    sort_particles(drive.sim)
    assert np.array_equal(before, drive.sim.particles.id.to_numpy())
