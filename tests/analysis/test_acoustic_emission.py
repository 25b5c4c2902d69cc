"""Acoustic events and b-values, on failures placed by hand and on catalogues drawn from a known law."""

import numpy as np
import pytest
from broken_bands import SPACING, failures

from rsmpm_ti.analysis.acoustic_emission import MIN_PARTICLES, b_value, gather
from rsmpm_ti.analysis.crack_path import REACH

SPEED = 1700.0
R = REACH * SPACING


def gutenberg_richter(b: float, n: int, seed: int) -> np.ndarray:
    """n magnitudes above -3 with number(>= M) proportional to 10^(-b M)."""
    return -3.0 + np.random.default_rng(seed).exponential(np.log10(np.e) / b, n)


@pytest.mark.parametrize("b", [0.6, 1.0, 1.8])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_b_of_a_known_catalogue_is_found_within_three_standard_errors(b, seed):
    found = b_value(gutenberg_richter(b, 4000, seed))
    assert abs(found.b - b) < 3.0 * found.error
    assert found.completeness == pytest.approx(-2.95, abs=0.051)  # the lowest bin, give or take where it begins


def test_error_of_b_falls_as_one_over_root_n_and_is_b_over_root_n():
    few, many = b_value(gutenberg_richter(1.8, 1000, 5)), b_value(gutenberg_richter(1.8, 64000, 5))
    # an exponential law's own scatter: the error estimate of 1000 events is good to 1/sqrt(1000) times a few
    assert few.error / many.error == pytest.approx(8.0, rel=0.15)
    assert many.error == pytest.approx(many.b / np.sqrt(many.events), rel=0.03)


def test_scatter_over_catalogues_is_the_error_claimed():
    found = [b_value(gutenberg_richter(1.0, 400, seed)) for seed in range(200)]
    # 200 catalogues give their scatter to 1/sqrt(400) = 5 %, taken three times
    assert np.std([f.b for f in found]) == pytest.approx(np.mean([f.error for f in found]), rel=0.15)


def test_events_that_the_sensors_miss_do_not_lower_b():
    """Half of what lies below -2.5 is lost, all below -2.8: the fullest bin is the first complete one."""
    rng = np.random.default_rng(11)
    magnitude = gutenberg_richter(1.0, 20000, 11)
    heard = magnitude[(magnitude > -2.5) | ((magnitude > -2.8) & (rng.random(len(magnitude)) < 0.3))]
    found = b_value(heard)
    assert found.completeness == pytest.approx(-2.45, abs=0.11)
    assert abs(found.b - 1.0) < 3.0 * found.error + 0.05  # the bin's edge may lie a part of a bin too low


@pytest.mark.parametrize(
    "magnitude", [np.zeros(0), np.full(MIN_PARTICLES - 1, -3.0), np.full(100, -3.0), np.full(50, np.nan)]
)
def test_no_b_where_there_is_none(magnitude):
    assert b_value(magnitude) is None


def test_no_b_from_fewer_than_twenty_complete_events():
    magnitude = np.concatenate([np.linspace(-4.0, -3.05, 10), np.full(MIN_PARTICLES - 2, -3.0), [-2.9]])
    assert b_value(magnitude) is None
    assert b_value(np.append(magnitude, -2.8)) is not None


@pytest.mark.parametrize(
    "gap, delay, joined",
    [
        (0.9, 0.9, True),
        (1.1, 0.0, False),
        (0.0, 1.1, False),
        (0.0, 0.9, True),
    ],
)
def test_failures_near_in_space_and_in_time_are_one_event(gap, delay, joined):
    """gap in units of r, delay in units of r/c_s; both limits hold separately, (0.9, 0.9) being inside them."""
    found = gather(failures([[0.0, 0.0], [gap * R, 0.0]], time=[0.0, delay * R / SPEED]), SPACING, SPEED)
    assert len(found) == (1 if joined else 2)


def test_space_is_a_ball_and_not_a_box():
    found = gather(failures([[0.0, 0.0], [0.9 * R, 0.9 * R]], time=[0.0, 0.0]), SPACING, SPEED)
    assert len(found) == 2


def test_event_holds_the_sums_and_the_first_failure_of_its_chain():
    x = np.array([[5.0, 5.0], *([k * 0.8 * R, 0.0] for k in range(4))])
    time = np.array([0.0, *(1e-3 + 0.5 * np.arange(4) * R / SPEED)])
    table = failures(x, time=time, mode=np.array([2, 1, 1, 1, 2]), released=np.array([1e-3, 1.0, 2.0, 3.0, 4.0]))
    found = gather(table, SPACING, SPEED)
    np.testing.assert_array_equal(found.time, [0.0, 1e-3])
    np.testing.assert_array_equal(found.position, [[5.0, 5.0], [0.0, 0.0]])
    np.testing.assert_allclose(found.energy, [1e-3, 10.0])
    np.testing.assert_allclose(found.magnitude, [-2.0, 2.0 / 3.0])  # (2/3) log10(E / 1 J)
    np.testing.assert_array_equal(found.failures, [1, 4])
    np.testing.assert_allclose(found.shear_fraction, [1.0, 0.25])


def test_particle_that_fails_twice_is_one_particle_and_two_failures():
    found = gather(failures(np.zeros((2, 2)), time=[0.0, 0.0], mode=np.array([1, 2]), ids=[7, 7]), SPACING, SPEED)
    assert (found.failures.tolist(), found.particles.tolist()) == ([2], [1])


def test_event_that_released_nothing_has_no_magnitude():
    found = gather(failures([[0.0, 0.0]], released=0.0), SPACING, SPEED)
    assert np.isnan(found.magnitude).all() and b_value(found.magnitude) is None


@pytest.mark.parametrize("dim", [2, 3])
def test_no_failures_make_no_events(dim):
    found = gather(failures(np.zeros((0, dim))), SPACING, SPEED)
    assert len(found) == 0 and found.position.shape == (0, dim)
