"""Whole time steps against plain NumPy over particles and nodes, and what transfers must keep exactly."""

import itertools

import numpy as np
import pytest
import taichi as ti
from cloud import (
    COUNT,
    DX,
    by_id,
    close,
    cloud,
    compare_step,
    free_scene,
    make_scene,
    put,
    simulation,
    walled_scene,
)
from harness import epsilon, name_of, variants

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.parallel import REACH, Slabs
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.mpm.nodes import clear_nodes
from rsmpm_ti.mpm.plain import PlainStep
from rsmpm_ti.mpm.stepper import LOAD, ORDERS, scatter_all
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.spec.scene import Scene

every_shape = pytest.mark.parametrize("shape", variants(Scene, "shape"), ids=name_of)
every_transfer = pytest.mark.parametrize("transfer", variants(Scene, "transfer"), ids=name_of)


@pytest.fixture(scope="module")
def simulations(every_traversal):
    """Scene -> Simulation: kernels compile once for each, so tests share them."""
    return {}


def shared(simulations: dict, scene: Scene) -> Simulation:
    if scene not in simulations:
        simulations[scene] = simulation(scene)
    return simulations[scene]


def test_each_traversal_is_taken(simulations, every_traversal):
    sim = shared(simulations, free_scene(Linear(), PicFlip(flip=0.3)))
    assert type(sim.traversal).__name__ == every_traversal


@every_shape
@every_transfer
@pytest.mark.thorough(
    "Chunks-Apic-Gimp",
    "Single-Apic-Gimp",
    "Single-Apic-Linear",
    "Single-Apic-QuadraticBSpline",
    "Single-PicFlip-Gimp",
    "Slabs-Apic-Gimp",
    "Slabs-Apic-Linear",
    "Slabs-Apic-QuadraticBSpline",
    "Slabs-PicFlip-Gimp",
    "Slabs-PicFlip-Linear",
)
def test_musl_step_is_that_of_a_plain_loop(simulations, shape, transfer):
    scene = walled_scene(shape) if isinstance(transfer, Apic) else free_scene(shape, transfer)
    compare_step(scene, shared(simulations, scene))


WEIGHT = (3e8, -1e9)
"""A body force [m/s^2] that changes velocities of 1 m/s by as much in a step."""

OTHER_ORDERS = [
    free_scene(QuadraticBSpline(), Apic(), "usf", WEIGHT),
    free_scene(Gimp(), PicFlip(flip=0.3), "usl", WEIGHT),
]


@pytest.mark.parametrize("scene", OTHER_ORDERS, ids=lambda scene: scene.order)
@pytest.mark.thorough("Single-usf", "Single-usl", "Slabs-usf")
def test_step_of_the_other_orders_is_that_of_a_plain_loop(simulations, scene):
    compare_step(scene, shared(simulations, scene))


def test_every_order_is_compared():
    assert {scene.order for scene in OTHER_ORDERS} | {"musl"} == set(ORDERS)


@pytest.mark.thorough
def test_step_in_3d_is_that_of_a_plain_loop(simulations):
    scene = make_scene(Linear(), Apic(), cells=(5, 4, 3), viscosity=BulkViscosity())
    compare_step(scene, shared(simulations, scene))


FREE = [free_scene(shape, PicFlip(flip=0.3)) for shape in variants(Scene, "shape")] + OTHER_ORDERS


@pytest.mark.parametrize("scene", FREE, ids=lambda scene: f"{scene.order}-{name_of(scene.shape)}")
def test_momentum_of_a_free_body_changes_by_its_weight_alone_to_round_off(simulations, scene):
    sim = shared(simulations, scene)
    state = cloud(scene, sim)
    mass = sim.density * state.volume[:, None]
    start = np.sum(mass * state.v, axis=0)
    if scene.transfer.affine:  # sum w_ip (x_i - x_p) = 0: the affine part carries none
        start = PlainStep(scene, state).momentum().sum(axis=0)
    ORDERS[scene.order](sim, scene.dt, 0.0, [1.0] * 5)
    v = by_id(sim, "v")
    end = start + 5 * scene.dt * mass.sum() * np.array(scene.loading.body_force or (0.0, 0.0))
    assert np.abs(np.sum(mass * v, axis=0) - end).max() < 1e-12 * np.sum(mass * np.abs(v))
    assert np.abs(v - state.v).max() > 1e-2  # and something did happen


# fraction of a cell by which particles lie outside the wall, as beside a platen that pulls
@pytest.mark.parametrize("beyond", [0.0, 0.05])
@pytest.mark.parametrize("shape", variants(Scene, "shape"), ids=name_of)
@pytest.mark.thorough("Single-Gimp-0.0")
def test_apic_keeps_an_affine_velocity_field_exactly(simulations, shape, beyond):
    """Also beside a frictionless wall, where this field has no normal velocity."""
    if beyond and shape.width == 2:
        pytest.skip("the hat is not folded: beyond a wall it meets another row of nodes")
    scene = walled_scene(shape)
    sim, boundary = shared(simulations, scene), scene.loading.boundaries[0]
    state, gradient = cloud(scene, sim), np.array([[30.0, -70.0], [0.0, 20.0]])
    if beyond:
        outward = -1.0 if boundary.side == "lower" else 1.0
        state.reference[:20, 1] = boundary.position + outward * beyond * DX
    state.C = np.broadcast_to(gradient, (COUNT, 2, 2))
    state.v = (2.0, 0.0) + (state.reference - (0.3 * DX, boundary.position)) @ gradient.T
    state.sigma = np.zeros_like(state.sigma)
    put(sim, state)
    ORDERS["musl"](sim, 1e-9, 0.0, [1.0])
    close(by_id(sim, "v"), state.v, epsilon(ti.f64))
    # C divides differences of velocity by the spread D, as small as 1e-4 of a cell squared beside a node
    close(by_id(sim, "C"), state.C, epsilon(ti.f64), 1e7)


@every_shape
def test_strayed_particles_reach_the_same_nodes_as_after_sorting_again(simulations, shape):
    scene = free_scene(shape, PicFlip(flip=0.3))
    sim = shared(simulations, scene)
    state = cloud(scene, sim)
    moves = np.random.default_rng(2).uniform(-0.45, 0.45, size=(COUNT, 2)) * DX
    sim.particles.u.from_numpy(moves[sim.particles.id.to_numpy()])
    home, now = (np.floor(x / DX - shape.shift) for x in (state.reference, state.reference + moves))
    assert (home[:, 0] != now[:, 0]).sum() > COUNT // 10
    found = []
    for _ in range(2):
        clear_nodes(sim)
        scatter_all(sim, LOAD, 0.0)
        found.append([f.to_numpy() for f in (sim.nodes.mass, sim.nodes.v, sim.nodes.f)])
        sort_particles(sim)
    assert found[0][0].sum() == pytest.approx(COUNT * sim.density * (0.5 * DX) ** 2, rel=1e-12)
    for strayed, sorted_again in zip(*found, strict=True):
        close(strayed, sorted_again, epsilon(ti.f64), 100)


@pytest.mark.parametrize("threads", [2, 3, 5])
@pytest.mark.parametrize("shape", variants(Scene, "shape"), ids=name_of)
def test_slabs_share_rows_only_in_the_parts_that_wait_for_each_other(threads, shape):
    """Threads add to nodes without atomics; a clash shows only now and then in a result, so rows are counted: those
    that particles of a part may touch when they have strayed by a row. First rows of a slab are added before the last
    ones of the slab before, which wait; nothing else of two slabs may meet."""
    row = np.sort(np.random.default_rng(threads).integers(5, 60, size=4000))
    slabs = Slabs(threads, ordered=False)
    slabs.refresh(row)
    bounds = slabs.bounds.to_numpy()
    assert bounds[0, 0] == 0 and bounds[-1, -1] == len(row) and (bounds[1:, 0] == bounds[:-1, -1]).all()
    assert (np.diff(bounds, axis=1) >= 0).all()
    touched = {
        (slab, part): {r + k for r in set(row[low:high]) for k in range(-1, 1 + shape.width)}
        for slab, parts in enumerate(bounds)
        for part, (low, high) in enumerate(itertools.pairwise(parts))
    }
    for (a, part_a), (b, part_b) in itertools.combinations(touched, 2):
        if a < b and touched[a, part_a] & touched[b, part_b]:
            assert b == a + 1 and (part_a, part_b) == (2, 0)
    most = max(bounds[:, -1] - bounds[:, 0])
    assert most < 1.5 * len(row) / threads


@pytest.mark.parametrize("rows", [1, 3, 9, 17])
def test_body_of_few_rows_is_shared_by_fewer_threads(rows):
    slabs = Slabs(4, ordered=False)
    slabs.refresh(np.repeat(np.arange(7, 7 + rows), 5))
    bounds = slabs.bounds.to_numpy()
    assert bounds[0, 0] == 0 and bounds.max() == 5 * rows
    assert np.count_nonzero(bounds[:, -1] > bounds[:, 0]) == -(-rows // (2 * REACH))


def test_sorting_changes_no_particle_and_puts_them_into_cell_order(simulations):
    scene = walled_scene(QuadraticBSpline())
    sim = shared(simulations, scene)
    state = cloud(scene, sim)
    order = sim.particles.id.to_numpy()
    rows, columns = np.floor(state.reference[order] / DX - 0.5).T
    assert (np.diff(rows * 1000 + columns) >= 0).all()
    assert sorted(order) == list(range(COUNT))
    for name in ("reference", "v", "sigma", "J", "C", "volume"):
        np.testing.assert_array_equal(by_id(sim, name), getattr(state, name), err_msg=name)
