"""Pieces of made-up specimens cut by bands of failed particles."""

import numpy as np
import pytest
from broken_bands import SPACING, lattice, scattered, snapshot

from rsmpm_ti.analysis.fragments import find_fragments

DENSITY = 2600.0
BLOCK = lattice((0.0, 0.0), (10e-3, 20e-3))


def test_specimen_without_failure_is_one_fragment_with_all_its_mass():
    found = find_fragments(snapshot(scattered(BLOCK)), DENSITY)
    (piece,) = found.pieces
    assert found.dust is None and found.largest_fraction == pytest.approx(1.0)
    assert piece.particles == len(BLOCK)
    assert piece.mass == pytest.approx(DENSITY * 10e-3 * 20e-3)
    assert piece.diameter == pytest.approx(np.sqrt(4.0 * 10e-3 * 20e-3 / np.pi))
    np.testing.assert_allclose(piece.centroid, [5e-3, 10e-3], atol=0.1 * SPACING)


def test_a_row_of_failed_particles_cuts_in_two():
    mode = np.where(np.abs(BLOCK[:, 1] - 5.125e-3) < 0.1 * SPACING, 1, 0)
    velocity = np.where(BLOCK[:, 1:] > 5e-3, [0.0, 2.0], [1.0, 0.0])
    found = find_fragments(snapshot(scattered(BLOCK), mode, velocity=velocity), DENSITY)
    large, small = found.pieces
    assert (small.particles, large.particles) == (20 * 40, 59 * 40)
    assert small.mass == pytest.approx(DENSITY * 10e-3 * 5e-3)
    np.testing.assert_allclose(small.velocity, [1.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(large.velocity, [0.0, 2.0], atol=1e-12)
    np.testing.assert_allclose(small.centroid, [5e-3, 2.5e-3], atol=0.1 * SPACING)
    assert found.largest_fraction == pytest.approx(59.0 / 80.0)  # of the whole specimen, its failed row included


def test_a_band_that_ends_inside_cuts_nothing():
    mode = (np.abs(BLOCK[:, 1] - 5.125e-3) < 0.1 * SPACING) & (BLOCK[:, 0] < 9.9e-3 - SPACING)
    assert len(find_fragments(snapshot(scattered(BLOCK), mode), DENSITY).pieces) == 1


def test_pieces_that_drift_apart_are_two_without_a_failure():
    x = BLOCK.copy()
    x[x[:, 1] > 10e-3, 1] += SPACING  # a gap of one spacing: neighbours two spacings apart
    assert len(find_fragments(snapshot(x), DENSITY).pieces) == 2


def test_pieces_below_four_particles_are_dust_counted_together():
    lone = np.array([[0.05, 0.0], *([0.06 + k * SPACING, 0.0] for k in range(3))])
    four = 0.07 + SPACING * np.array([[0, 0], [1, 0], [0, 1], [1, 1]])
    found = find_fragments(snapshot(np.concatenate([BLOCK, lone, four])), DENSITY)
    assert [piece.particles for piece in found.pieces] == [len(BLOCK), 4]
    assert found.dust.particles == 4 and found.dust.mass == pytest.approx(4 * DENSITY * SPACING**2)
    assert np.isnan(found.dust.diameter)


def test_coarse_and_fine_bodies_each_hold_together_by_their_own_spacing():
    coarse = 2.0 * BLOCK + (0.05, 0.0)
    volume = np.repeat([SPACING**2, 4.0 * SPACING**2], len(BLOCK))
    found = find_fragments(snapshot(np.concatenate([BLOCK, coarse]), volume=volume), DENSITY)
    assert [piece.particles for piece in found.pieces] == [len(BLOCK)] * 2
    assert found.pieces[0].mass == pytest.approx(4.0 * found.pieces[1].mass)


def test_solid_in_3d_has_the_diameter_of_a_ball():
    axis = SPACING * (np.arange(8) + 0.5)
    x = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), axis=-1).reshape(-1, 3)
    mode = (x[:, 2] > 3.0 * SPACING) & (x[:, 2] < 4.0 * SPACING)
    found = find_fragments(snapshot(x, mode), DENSITY)
    assert [piece.particles for piece in found.pieces] == [256, 192]
    assert found.pieces[0].diameter == pytest.approx(np.cbrt(6.0 * 256 * SPACING**3 / np.pi))
    assert found.pieces[0].velocity.shape == (3,)


def test_particles_that_are_not_finite_are_left_out():
    x = BLOCK.copy()
    x[:5] = np.nan
    found = find_fragments(snapshot(x), DENSITY)
    assert sum(piece.particles for piece in found.pieces) == len(BLOCK) - 5


def test_nothing_left_is_no_fragment():
    found = find_fragments(snapshot(BLOCK, np.ones(len(BLOCK))), DENSITY)
    assert found.pieces == () and found.dust is None and found.largest_fraction is None
