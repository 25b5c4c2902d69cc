"""Mean crack strain: what a band of rows opens by, wherever its opening is and however many rows share it."""

import math

import numpy as np
import pytest
import taichi as ti
from nonlocal_block import DX, block, positions
from scipy.integrate import quad
from scipy.stats import norm

from rsmpm_ti.failure.nonlocal_fields import read_crack_strains, sum_nonlocal
from rsmpm_ti.rock.broken.crack_return import MIN_CRACK_STRAIN
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.spec.seeding import Lattice

pytestmark = pytest.mark.usefixtures("taichi_f64")

CELLS = 32
BAND = 2.0 * DX  # of the quadratic B-spline
W = 4e-6
"""Opening of the crack [m]."""


@pytest.mark.parametrize("length", [0.5, 1.0, 4.0])
def test_what_averaging_leaves_of_a_band(length):
    """Middle and variance of a band of width 1 after a Gaussian mean, by quadrature."""
    rule = Nonlocal(length=length)

    def averaged(d):
        return quad(lambda y: norm.pdf(d - y, scale=length), -0.5, 0.5)[0]

    assert rule.band_fraction(1.0) == pytest.approx(averaged(0.0), rel=1e-10)
    variance = quad(lambda d: d * d * averaged(d), -12.0 * length, 12.0 * length, limit=200)[0]
    assert rule.band_variance(1.0) == pytest.approx(variance, rel=1e-6)


def opened(sim, angle: float, half: float) -> tuple[np.ndarray, np.ndarray]:
    """(mean crack strain, distance from the crack [m]) of cracked particles: within `half` [m] of a line through the
    middle with its normal at `angle` [degrees], which share the opening W, and of those up to 1.5 bands away, shut."""
    x = positions(sim) - 0.5 * CELLS * DX
    n = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    away = np.abs(x @ n)
    inside, cracked = away < half, away < 1.5 * BAND
    particles = sim.particles
    strain = np.where(inside, W / (2.0 * half), np.where(cracked, MIN_CRACK_STRAIN, 0.0))
    particles.history.crack_strain_max.from_numpy(np.stack([strain, 0.0 * strain], axis=1))
    particles.mode.from_numpy(cracked.astype(np.int32))
    particles.history.crack_normal.fill(ti.Vector(n))
    particles.crack_strain_nonlocal.fill(0.0)
    sum_nonlocal(sim)
    read_crack_strains(sim)
    found = particles.crack_strain_nonlocal.to_numpy()
    assert (found[~cracked] == 0.0).all()
    free = cracked & (np.abs(x).max(axis=1) < 0.5 * CELLS * DX - 8.0 * DX)
    return found[free], away[free]


def reading(d: np.ndarray, width: float, length: float) -> np.ndarray:
    """What is read at distances d from the middle of a crack that opens by 1 over `width`, in Gaussian means."""
    ends = (d + 0.5 * width) / length, (d - 0.5 * width) / length
    mean = (norm.cdf(ends[0]) - norm.cdf(ends[1])) / width
    slope = (norm.pdf(ends[0]) - norm.pdf(ends[1])) / (width * length)
    variance = length**2 + BAND**2 / 12.0
    away = np.abs(slope) / mean * variance
    part = np.clip(2.0 - 2.0 * away / BAND, 0.0, 1.0)
    away = np.minimum(away, 0.5 * BAND)
    return part * mean * np.exp(0.5 * away**2 / variance) * BAND / (2.0 * norm.cdf(0.5 * BAND / length) - 1.0)


@pytest.mark.parametrize("ratio", [2.0, 3.0])
@pytest.mark.parametrize("angle, rows", [(0.0, 1.0), (27.0, 1.0), (45.0, 1.0), (0.0, 0.5)])
def test_rows_of_a_crack_lose_strength_by_the_opening_that_they_share(ratio, angle, rows):
    """A band of the assumed width, turned, and one half as wide: nearly all rows read the opening W.

    Sixteen particles in a cell: with four, a turned band holds a few per cent more rock here than there.
    """
    sim = block(CELLS, length=ratio * DX, seeding=Lattice(particles_per_axis=4))
    strain, away = opened(sim, angle, 0.5 * rows * BAND)
    expected = reading(away, rows * BAND, ratio * DX)
    read = strain * BAND / W
    assert len(read) > 50
    assert np.abs(read - expected).mean() < 0.03
    near = away < 0.5 * BAND
    assert (read[away > 1.2 * BAND] == 0.0).all()
    assert read[near].mean() == pytest.approx(1.0, abs=0.04) and read[near].std() < 0.04


def test_crack_that_ends_at_a_free_face_opens_there_as_inside():
    """The mean is over rock: half of what the Gaussian covers there is missing from both its sums."""
    sim = block(CELLS, length=2.0 * DX)
    x = positions(sim)
    opened(sim, 0.0, 0.5 * BAND)
    strain = sim.particles.crack_strain_nonlocal.to_numpy()
    near = np.abs(x[:, 0] - 0.5 * CELLS * DX) < 0.5 * BAND
    edge, inside = near & (x[:, 1] < DX), near & (np.abs(x[:, 1] - 0.5 * CELLS * DX) < 2.0 * DX)
    assert strain[edge].mean() == pytest.approx(strain[inside].mean(), rel=0.01)


def test_lonely_cracked_particle_keeps_nearly_all_of_its_strength():
    """A particle that opens alone is no crack: over two cells it counts as a small fraction of its strain."""
    sim = block(CELLS, length=2.0 * DX)
    middle = int(np.linalg.norm(positions(sim) - 0.5 * CELLS * DX, axis=1).argmin())
    particles = sim.particles
    mode, widest = np.zeros(particles.count, dtype=np.int32), np.zeros((particles.count, 2))
    mode[middle], widest[middle, 0] = 1, W / BAND
    particles.mode.from_numpy(mode)
    particles.history.crack_strain_max.from_numpy(widest)
    sum_nonlocal(sim)
    read_crack_strains(sim)
    # V/(2 pi l^2) of its strain in a mean, over what is left of a band in its middle
    fraction = 0.25 / (2.0 * math.pi * 4.0) / Nonlocal(length=2.0 * DX).band_fraction(BAND)
    assert particles.crack_strain_nonlocal.to_numpy()[middle] * BAND / W == pytest.approx(fraction, rel=0.1)
