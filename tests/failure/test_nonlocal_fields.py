"""Mean stress over a length of the rock: what it keeps, what it attenuates, and that it misses no overload."""

import math

import numpy as np
import pytest
import taichi as ti
from harness import name_of
from nonlocal_block import DX, block, positions

from rsmpm_ti.failure.nonlocal_fields import mark_overloaded, mean_stress, near_overloaded, sum_nonlocal
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.regions import Disc, Slit
from rsmpm_ti.spec.seeding import Jittered

pytestmark = pytest.mark.usefixtures("taichi_f64")


@ti.kernel
def read(sim: ti.template(), mean: ti.types.ndarray(), near: ti.types.ndarray()):
    for p in range(mean.shape[0]):
        m = mean_stress(sim, p)
        for k in ti.static(range(4)):
            mean[p, k] = m[k]
        near[p] = ti.cast(near_overloaded(sim, p), ti.i32)


def averaged(sim: Simulation, sigma: np.ndarray, limit: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """(mean stress [n, 4], whether the particle is near a node where it reaches `limit` [n]) of stress [n, 4]."""
    sim.particles.sigma.from_numpy(np.ascontiguousarray(sigma))
    sum_nonlocal(sim)
    mark_overloaded(sim, limit)
    mean, near = np.zeros((len(sigma), 4)), np.zeros(len(sigma), dtype=np.int32)
    read(sim, mean, near)
    return mean, near == 1


def test_uniform_stress_is_its_own_mean_at_faces_flaws_and_walls():
    """Free faces weigh nothing: nothing is missing there, whatever the particles' volumes."""
    sim = block(
        16,
        seeding=Jittered(amount=0.3, fitted=True),
        removed=(
            Slit(centre=(8e-3, 6e-3), length=7e-3, width=3e-3, angle=30.0, rounded=True),
            Disc(centre=(16e-3, 16e-3), radius=5.3e-3),
        ),
        walls=(Wall(axis=0, side="lower", position=0.0), Wall(axis=1, side="upper", position=16e-3)),
    )
    assert np.ptp(sim.particles.volume.to_numpy()) > 0.5 * (0.5 * DX) ** 2  # fitted particles differ in volume
    stress = np.array([3.0, -7.0, 1.0, 2.0])
    mean, _ = averaged(sim, np.tile(stress, (sim.particles.count, 1)))
    np.testing.assert_allclose(mean, np.broadcast_to(stress, mean.shape), rtol=1e-12)


CASES = [(shape, ratio) for shape in (Linear(), Gimp(), QuadraticBSpline()) for ratio in (2.0, 2.5)]
waves = pytest.mark.parametrize("shape, ratio", CASES, ids=lambda v: name_of(v))
CELLS = 32


def inside(x: np.ndarray, length: float) -> np.ndarray:
    """Particles so far from every face that the mean sees none: taps reach 3.5 lengths and a cell, functions two."""
    depth = np.minimum(x, CELLS * DX - x).min(axis=1)
    return depth > 3.5 * length + 3.0 * DX


@waves
def test_linear_field_is_its_own_mean_inside(shape, ratio):
    """The kernel is symmetric, and on a lattice every node has as much rock on one side as on the other."""
    sim = block(CELLS, shape, ratio * DX)
    x = positions(sim)
    sigma = np.stack([1.0 + 2e3 * x[:, 0], 3e3 * x[:, 1], 1e3 * (x[:, 0] - x[:, 1]), np.ones(len(x))], axis=1)
    mean, _ = averaged(sim, sigma)
    deep = inside(x, ratio * DX)
    assert deep.sum() > 250
    np.testing.assert_allclose(mean[deep], sigma[deep], rtol=0.0, atol=1e-9)  # round-off of values up to 100


def attenuation(x: np.ndarray, values: np.ndarray, wave: np.ndarray) -> float:
    """Amplitude of the plane wave [1/m] that fits values best, by least squares; the phase must have stayed."""
    phase = x @ wave
    (sine, cosine), *_ = np.linalg.lstsq(np.stack([np.sin(phase), np.cos(phase)], axis=1), values, rcond=None)
    assert abs(cosine) < 0.002 * abs(sine)
    return float(sine)


@waves
def test_length_is_the_standard_deviation_of_the_gaussian_whatever_the_cell_and_the_direction(shape, ratio):
    """A wave sin(k x) leaves a Gaussian mean as exp(-k^2 l^2/2) of itself, along the grid and across."""
    length = ratio * DX
    sim = block(CELLS, shape, length)
    x = positions(sim) - 0.5 * CELLS * DX
    degrees = (0.0, 22.5, 45.0)
    turns = [np.array([math.cos(math.radians(a)), math.sin(math.radians(a))]) for a in degrees]
    k = [0.8 * turn / length for turn in turns] + [1.3 * turns[0] / length]
    mean, _ = averaged(sim, np.stack([np.sin(x @ wave) for wave in k], axis=1))
    deep = inside(positions(sim), length)
    found = np.array([attenuation(x[deep], mean[deep, c], wave) for c, wave in enumerate(k)])
    # a hat has a variance of 1/6 in the mean over all places, but f (1 - f) at f from a node: 3/16 at 1/4 and 3/4 of a
    # cell, where a lattice has its particles, on the way to nodes and back; the other functions have theirs everywhere
    variance = length**2 + (2.0 * (3.0 / 16.0 - 1.0 / 6.0) * DX**2 if isinstance(shape, Linear) else 0.0)
    expected = np.exp(-0.5 * variance * np.array([wave @ wave for wave in k]))
    # cut off at 3.5 deviations a Gaussian has lost 0.6 % of its variance: 0.2 % at k l = 0.8, 0.5 % at 1.3
    assert found[:3] == pytest.approx(expected[:3], rel=0.01)
    assert np.ptp(found[:3]) < 0.01 * found[0]
    assert found[3] == pytest.approx(expected[3], rel=0.01)


def mean_by_matrices(sim: Simulation, sigma: np.ndarray) -> np.ndarray:
    """The same mean from dense NumPy matrices and the shape function's profile: spread, blur by axis, read."""
    xi = (positions(sim) - np.array(sim.grid.origin)) / DX
    by_axis = [sim.shape.profile(xi[:, d, None] - np.arange(n)) for d, n in enumerate(sim.grid.nodes)]
    w = (by_axis[0][:, :, None] * by_axis[1][:, None, :]).reshape(len(xi), -1)
    filter_weights = np.array(sim.rock.nonlocal_mean.filter_weights(DX, sim.shape.variance))
    rows = [
        sum(t * np.eye(n, k=j - len(filter_weights) // 2) for j, t in enumerate(filter_weights)) for n in sim.grid.nodes
    ]
    volume = sim.particles.volume.to_numpy()[:, None]
    read_back = w @ np.kron(*rows) @ w.T
    return (read_back @ (volume * sigma)) / (read_back @ volume)


@pytest.fixture(scope="module")
def jittered(taichi_f64):
    sim = block(12, seeding=Jittered(amount=0.4, fitted=True), removed=(Disc(centre=(6e-3, 6e-3), radius=2.2e-3),))
    return sim, mean_by_matrices(sim, np.eye(4)[np.zeros(sim.particles.count, dtype=int)])


def test_mean_is_that_of_dense_matrices(jittered):
    sim, ones = jittered
    np.testing.assert_allclose(ones[:, 0], 1.0, rtol=1e-12)
    sigma = np.random.default_rng(4).normal(size=(sim.particles.count, 4))
    mean, _ = averaged(sim, sigma)
    np.testing.assert_allclose(mean, mean_by_matrices(sim, sigma), rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("fraction", [0.5, 0.9, 0.99, 0.998])
def test_no_overloaded_particle_is_spared_the_reading(jittered, fraction):
    """sigma_1 by eigenvalues of the brute-force mean; a fraction of all particles lies below the limit."""
    sim, _ = jittered
    for seed in range(6):
        sigma = np.random.default_rng(seed).normal(size=(sim.particles.count, 4))
        m = mean_by_matrices(sim, sigma)
        first = np.maximum(np.linalg.eigvalsh(m[:, [0, 3, 3, 1]].reshape(-1, 2, 2))[:, 1], m[:, 2])
        limit = float(np.quantile(first, fraction))
        _, near = averaged(sim, sigma, limit)
        assert near[first >= limit * (1.0 + 1e-12)].all()
        # and the marks are worth it: most particles are spared where few are overloaded
        assert fraction < 0.99 or near.mean() < 0.25
        assert sim.nonlocal_sums.overloaded.to_numpy().any()
    averaged(sim, sigma, 1e3)
    assert not sim.nonlocal_sums.overloaded.to_numpy().any()
