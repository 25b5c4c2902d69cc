"""Lengths and lines of bands of failed particles whose shapes are known."""

import numpy as np
import pytest
from broken_bands import SPACING, lattice, scattered, strip

from rsmpm_ti.analysis.crack_path import (
    REACH,
    centre_path,
    distances,
    mean_direction,
    path_length,
    tortuosity,
)
from rsmpm_ti.analysis.neighbours import neighbour_graph


def path_of(x: np.ndarray, seed: int = 0) -> np.ndarray:
    return centre_path(x, neighbour_graph(x, REACH * SPACING), SPACING, seed)


def ring_part(radius: float, degrees: float, width: float) -> np.ndarray:
    """Lattice places of an arc about the origin from +x upwards; width in spacings."""
    x = lattice((-1.2 * radius, -1.2 * radius), (1.2 * radius, 1.2 * radius))
    r, angle = np.linalg.norm(x, axis=1), np.degrees(np.arctan2(x[:, 1], x[:, 0])) % 360.0
    return scattered(x[(np.abs(r - radius) < 0.5 * width * SPACING) & (angle < degrees)])


@pytest.mark.parametrize("kept", [1.0, 0.6], ids=["whole", "ragged"])
@pytest.mark.parametrize("width", [2.0, 3.0, 5.0])
@pytest.mark.parametrize("angle", [0.0, 10.0, 30.0, 45.0, 70.5, 90.0])
def test_straight_band_is_as_long_as_its_ends_are_apart(angle, width, kept):
    x = strip(angle, 20e-3, width, kept=1.0 if width < 3.0 else kept)  # a thin one with holes is no longer one band
    t = np.radians(angle)
    truth = np.ptp(x @ np.array([np.cos(t), np.sin(t)]))
    length = path_length(path_of(x))
    # never more than 2 % too long; an end's middle may lie a quarter of a spacing behind its foremost particle
    assert truth - 0.5 * SPACING < length < 1.02 * truth
    # the ends of a band w wide may lie w/2 to either side of its middle: 2.5 of 80 spacings are 1.8 degrees
    assert abs((mean_direction(path_of(x)) - angle + 90.0) % 180.0 - 90.0) < 2.0
    assert tortuosity(path_of(x)) < 1.02


def test_direction_of_a_line_has_no_sense():
    assert mean_direction(np.array([[0.0, 0.0], [1.0, -0.02], [2.0, 0.0]])) % 180.0 == pytest.approx(0.0, abs=1e-9)
    assert mean_direction(np.array([[1.0, 1.0], [0.0, 0.0]])) == pytest.approx(45.0)
    assert mean_direction(np.array([[0.0, 1.0], [1.0, 0.0]])) == pytest.approx(135.0)


@pytest.mark.parametrize("width", [2.0, 3.0, 5.0])
def test_arc_is_as_long_as_its_middle(width):
    path = path_of(ring_part(10e-3, 150.0, width))
    truth = 10e-3 * np.radians(150.0)
    # at most 2 % too long; a shortest way keeps to the inside, where the arc is shorter by w/2R = 6 % at most
    assert truth * (1.0 - 0.5 * width * SPACING / 10e-3) < path_length(path) < 1.02 * truth
    # each end may lie anywhere across the band, which moves the chord by up to a width
    chord = 2.0 * 10e-3 * np.sin(np.radians(75.0))
    assert tortuosity(path) == pytest.approx(truth / chord, rel=width * SPACING / chord)
    # the shortest way hugs the inside of the bend; centring brings it to within half a cell of the middle
    assert np.abs(np.linalg.norm(path[3:-3], axis=1) - 10e-3).max() < 1.0 * SPACING


def test_a_shorter_branch_is_not_in_the_path():
    stem, branch = strip(90.0, 20e-3, 3.0), strip(30.0, 6e-3, 3.0, start=(0.0, 8e-3))
    path = path_of(np.concatenate([stem, branch]))
    truth = np.ptp(stem[:, 1])
    assert truth - 2.0 * SPACING < path_length(path) < 1.02 * truth
    assert np.abs(path[:, 0]).max() < 2.0 * SPACING  # the junction may pull it aside by a little


def test_path_is_the_same_line_wherever_the_search_begins():
    x = strip(30.0, 20e-3, 3.0)
    lengths = [path_length(path_of(x, seed)) for seed in (0, len(x) // 2, len(x) - 1)]
    assert np.ptp(lengths) < 0.5 * SPACING


def test_distance_follows_the_band_and_not_the_chord():
    x = ring_part(10e-3, 180.0, 3.0)
    angle = np.arctan2(x[:, 1], x[:, 0])
    start, end = np.argmin(angle), np.argmax(angle)
    way = distances(neighbour_graph(x, REACH * SPACING), int(start))[end]
    # on the inside of the band, pi (R - w/2), to the outside, zigzag included; the chord is 2 R
    assert np.pi * (10e-3 - 2.5 * SPACING) < way < 1.03 * np.pi * (10e-3 + 2.0 * SPACING)


def test_particle_that_failed_twice_in_one_place_stays_in_its_band():
    x = strip(0.0, 5e-3, 2.0)
    twice = np.concatenate([x, x])
    graph = neighbour_graph(twice, REACH * SPACING)
    assert np.isfinite(distances(graph, 0)).all()
    assert path_length(centre_path(twice, graph, SPACING)) == pytest.approx(path_length(path_of(x)), rel=1e-6)


def test_smallest_band_has_a_path():
    x = SPACING * np.array([[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]], dtype=float)
    path = path_of(x)
    assert 1.0 * SPACING < path_length(path) <= np.hypot(2.0, 1.0) * SPACING * (1.0 + 1e-12)


def test_pairs_beyond_reach_are_not_joined():
    x = np.array([[0.0, 0.0], [0.9, 0.0], [2.0, 0.0]])
    way = distances(neighbour_graph(x, 1.0), 0)
    np.testing.assert_allclose(way, [0.0, 0.9, np.inf])


def test_graph_of_a_band_has_the_indices_that_every_scipy_takes():
    """Of 64 bits, SciPy 1.13 refuses them in `dijkstra`."""
    graph = neighbour_graph(lattice((0.0, 0.0), (4.0 * SPACING, 4.0 * SPACING)), 1.5 * SPACING)
    band = np.arange(8)
    for part in (graph, graph[band][:, band]):
        assert part.indices.dtype == part.indptr.dtype == np.int32
