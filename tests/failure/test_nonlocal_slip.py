"""Mean slip: a shear band loses cohesion by the slip that all its rows share, and robs nothing ahead of its end."""

import math

import numpy as np
import pytest
import taichi as ti
from nonlocal_block import DX, ROCK, block, positions

from rsmpm_ti.failure.nonlocal_fields import read_crack_strains, sum_nonlocal
from rsmpm_ti.failure.stress_update import check_failure
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.rock.broken.crack_return import MIN_CRACK_STRAIN, strength_left
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import Brittle, LinearSoftening
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice

pytestmark = pytest.mark.usefixtures("taichi_f64")


@pytest.fixture(autouse=True, scope="module")
def blocks_of_this_start(taichi_f64):
    """Blocks that another file's tests have made are gone with the Taichi that it started."""
    block.cache_clear()


CELLS = 32
BAND = 2.0 * DX  # of the quadratic B-spline
LENGTH = 2.0 * DX
W = 4e-6
"""Slip across the band [m]."""


def turned(sim, angle: float) -> tuple[np.ndarray, np.ndarray]:
    """Distances of particles from the middle of the block, along a line at `angle` [degrees] and across it [m]."""
    x, turn = positions(sim) - 0.5 * CELLS * DX, math.radians(angle)
    return x @ [math.cos(turn), math.sin(turn)], x @ [-math.sin(turn), math.cos(turn)]


def read(sim, slip: np.ndarray, crushed: np.ndarray) -> np.ndarray:
    """Slip by which particles lose cohesion; normals lie anyhow, since no plane of slip is known."""
    particles = sim.particles
    particles.history.slip.from_numpy(slip)
    particles.mode.from_numpy(np.where(crushed, 2, 0).astype(np.int32))
    particles.history.crack_normal.fill(ti.Vector([0.8, 0.6]))
    particles.history.crack_strain_max.fill(0.0)
    particles.slip_nonlocal.fill(0.0)
    sum_nonlocal(sim)
    read_crack_strains(sim)
    return particles.slip_nonlocal.to_numpy()


@pytest.mark.parametrize("angle, rows", [(0.0, 1.0), (27.0, 1.0), (45.0, 1.0), (0.0, 0.5)])
def test_rows_of_a_shear_band_lose_cohesion_by_the_slip_that_they_share(angle, rows):
    """Of a band as wide as assumed, and of one half as wide whose other rows have not slipped; by their own slip the
    first would lose it by W/BAND, the second by twice that and by nothing."""
    sim = block(CELLS, length=LENGTH, seeding=Lattice(particles_per_axis=4))
    along, across = turned(sim, angle)
    slipped = np.abs(across) < 0.5 * rows * BAND
    slip = np.where(slipped, W / (rows * BAND), MIN_CRACK_STRAIN)
    found = read(sim, slip, np.abs(across) < 1.5 * BAND) * BAND / W
    inside = np.maximum(np.abs(along), np.abs(across)) < 0.5 * CELLS * DX - 8.0 * DX
    near = (np.abs(across) < 0.45 * BAND) & inside
    assert near.sum() > 50
    assert found[near].mean() == pytest.approx(1.0, abs=0.05) and found[near].std() < 0.05
    assert (found[(np.abs(across) > 1.2 * BAND) & inside] < 1e-3).all()


def test_rock_ahead_of_a_shear_crack_loses_by_its_own_slip_only():
    """On its line the mean of half a band is a normal distribution: half a length ahead of its end the slope says that
    the band's middle is 2.5 cells away, more than the whole width."""
    sim = block(CELLS, length=LENGTH, seeding=Lattice(particles_per_axis=4))
    along, across = turned(sim, 0.0)
    slip = np.where((along < 0.0) & (np.abs(across) < 0.5 * BAND), W / BAND, 0.0)
    found = read(sim, slip, np.abs(across) < 0.5 * BAND) * BAND / W
    line = np.abs(across) < 0.25 * DX
    ahead, behind = line & (along > 0.6 * LENGTH) & (along < 4.0 * LENGTH), line & (np.abs(along + 3.0 * LENGTH) < DX)
    assert found[behind] == pytest.approx(np.ones(behind.sum()), abs=0.05)
    assert ahead.sum() > 20 and (found[ahead] == 0.0).all()


@ti.kernel
def hold(sim: ti.template(), cohesion: ti.types.ndarray()):
    """A step without strain; what is left of cohesion after it [Pa]."""
    for p in range(cohesion.shape[0]):
        sim.particles.L[p] = ti.Matrix.zero(float, 2, 2)
        check_failure(sim, p, 1.0, 0.0, 0)
        cohesion[p] = strength_left(sim, p)[2]


def cell(softening) -> Simulation:
    scene = Scene(
        title="cell",
        domain=Domain(lower=(0.0, 0.0), upper=(DX, DX), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(DX, DX))),),
        rock=Rock(**ROCK | {"after_failure": Directional(softening=softening)}, nonlocal_mean=Nonlocal(length=LENGTH)),
        loading=Loading(),
        schedule=Schedule(t_end=1e-6),
    )
    sim = Simulation(scene, scene.particles())
    sim.particles.mode.fill(2)
    sim.particles.history.crack_normal.fill(ti.Vector([1.0, 0.0]))
    return sim


def test_cohesion_is_lost_by_the_mean_slip_and_does_not_come_back():
    """f (1 - w f/(2 G)), w = band x slip: gone at a slip of 2 G/(c band)."""
    energy = 24.0
    sim = cell(LinearSoftening(G_f_I=5.0, G_f_II=energy))
    c = sim.rock.criterion.cohesion
    gone, left = 2.0 * energy / (c * BAND), np.zeros(4)
    sim.particles.history.slip.fill(gone)  # its own is not what counts
    for mean, ratio in ((0.0, 1.0), (0.25 * gone, 0.75), (0.1 * gone, 0.75), (2.0 * gone, 0.0)):
        sim.particles.slip_nonlocal.fill(mean)
        hold(sim, left)
        assert left == pytest.approx(np.full(4, ratio * c), abs=1e-6 * c)


def test_brittle_rock_that_begins_to_slip_has_lost_its_cohesion_at_once():
    sim, left = cell(Brittle()), np.ones(4)
    sim.particles.slip_max_nonlocal.fill(MIN_CRACK_STRAIN)
    hold(sim, left)
    assert (left == 0.0).all()
