"""Cracks read from synthetic bands of failed particles whose angles and offsets are known."""

import math

import numpy as np
import pytest

from rsmpm_ti.analysis.wing_cracks import (
    Wing,
    crack_directions,
    first_crack_angles,
    half_turn_mismatch,
    leaving_angle,
    wings,
)
from rsmpm_ti.spec.regions import Slit

SPACING = 0.25e-3
FLAW = Slit(centre=(0.025, 0.05), length=0.015, width=1.5e-3, angle=45.0)
CENTRE = np.array(FLAW.centre)


def band(angle: float, *, length: float = 0.02, sign: float = 1.0, half_width: int = 1) -> np.ndarray:
    """Failed particles in a straight band from one tip, `angle` degrees from the flaw's outward direction, in order
    of their distance from the tip; several particles wide, on a lattice of SPACING with seeded scatter."""
    outward = sign * FLAW.direction
    tip = CENTRE + 0.5 * FLAW.length * outward
    t = np.radians(angle)
    along = np.array([[np.cos(t), -np.sin(t)], [np.sin(t), np.cos(t)]]) @ outward
    across = np.array([-along[1], along[0]])
    s, k = np.meshgrid(np.arange(0.0, length, SPACING), np.arange(-half_width, half_width + 1), indexing="ij")
    points = tip + s.reshape(-1, 1) * along + SPACING * k.reshape(-1, 1) * across
    return points + np.random.default_rng(1).uniform(-0.1, 0.1, points.shape) * SPACING


def angle_of(wing: Wing, sign: float = 1.0) -> float:
    return leaving_angle(wing.points, wing.start, sign * FLAW.direction)


def half_turn(points: np.ndarray) -> np.ndarray:
    return 2.0 * CENTRE - points


@pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 60.0, 70.5, 110.0])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_straight_wings_give_their_angles(angle, sense):
    pair = wings(np.concatenate([band(sense * angle), band(sense * angle, sign=-1.0)]), FLAW, SPACING)
    for wing, sign in zip(pair, (1.0, -1.0), strict=True):
        assert angle_of(wing, sign) == pytest.approx(angle, abs=2.0)
        np.testing.assert_allclose(wing.tip, CENTRE + sign * 0.0075 * FLAW.direction)
        assert len(wing.points) == len(band(0.0))


def test_only_the_first_part_of_a_curving_wing_counts():
    start = band(70.0, length=3.5e-3)
    end = start[-1] + np.outer(np.arange(1, 60) * SPACING, [0.0, 1.0])
    wing = wings(np.concatenate([start, end]), FLAW, SPACING)[0]
    assert angle_of(wing) == pytest.approx(70.0, abs=2.0)
    assert len(wing.points) == len(start) + len(end)


def test_points_elsewhere_and_beyond_a_gap_belong_to_no_wing():
    wing_points = band(60.0)
    far = CENTRE + (0.02, -0.03) + np.random.default_rng(3).uniform(-1e-3, 1e-3, (30, 2))
    beyond_gap = wing_points[-1] + band(60.0)[40:60] - band(60.0)[0]
    wing = wings(np.concatenate([far, wing_points, beyond_gap]), FLAW, SPACING)[0]
    assert len(wing.points) == len(wing_points)


def test_a_wing_points_away_from_its_start_in_whatever_order_it_grew():
    points = band(60.0)
    wing = wings(np.concatenate([points[:1], points[:0:-1]]), FLAW, SPACING)[0]
    assert angle_of(wing) == pytest.approx(60.0, abs=2.0)


def test_failures_that_come_first_decide_where_a_wing_starts():
    points = band(60.0)
    wing = wings(points, FLAW, SPACING)[0]
    np.testing.assert_array_equal(wing.start, points[0])


@pytest.mark.parametrize("points", [np.zeros((0, 2)), np.full((20, 2), 0.001)], ids=["none", "elsewhere"])
def test_nothing_grown_is_none(points):
    assert wings(points, FLAW, SPACING) == [None, None]


def test_one_sided_growth_is_one_wing():
    pair = wings(band(60.0, sign=-1.0), FLAW, SPACING)
    assert pair[0] is None and angle_of(pair[1], -1.0) == pytest.approx(60.0, abs=2.0)
    assert np.isnan(half_turn_mismatch(pair, FLAW, 1, 0.01, 1e-3))


def test_few_particles_make_a_wing_without_an_angle():
    wing = wings(band(60.0)[:5], FLAW, SPACING)[0]
    assert len(wing.points) == 5 and np.isnan(angle_of(wing))


def mismatch(shift=(0.0, 0.0), angle: float = 45.0, axis: int = 1) -> float:
    first = band(angle, length=0.02)
    pair = wings(np.concatenate([first, half_turn(first) + shift]), FLAW, SPACING)
    return half_turn_mismatch(pair, FLAW, axis, 0.012, 1e-3)


def test_wings_symmetric_under_half_a_turn_do_not_differ():
    assert mismatch() < 1e-12


@pytest.mark.parametrize("shift", [0.3e-3, -0.8e-3])
def test_lateral_shift_of_one_wing_is_the_mismatch(shift):
    assert mismatch((shift, 0.0)) == pytest.approx(abs(shift), rel=1e-9)


def test_mismatch_of_wings_along_the_other_axis():
    assert mismatch((0.0, 0.5e-3), angle=-45.0, axis=0) == pytest.approx(0.5e-3, rel=1e-9)


def test_wings_shorter_than_the_length_are_not_compared():
    first = band(45.0, length=6e-3)
    pair = wings(np.concatenate([first, half_turn(first)]), FLAW, SPACING)
    assert np.isnan(half_turn_mismatch(pair, FLAW, 1, 0.012, 1e-3))


def test_direction_leads_away_from_the_face_beside_it():
    begun = np.array([[7.2e-3, 1.2e-3], [-7.2e-3, -1.2e-3], [0.1e-3, 1.6e-3], [-0.1e-3, 1.6e-3], [7.6e-3, 0.0]])
    for turn in (0.0, math.pi):  # a normal has no sense
        got = crack_directions(begun, np.radians([30.0, 30.0, 0.0, 0.0, 90.0]) + turn, 6e-3)
        assert got == pytest.approx([120.0, 120.0, 90.0, 90.0, 0.0], abs=1e-4)


@pytest.mark.parametrize("angle", [0.0, 45.0, -60.0])
def test_first_crack_angles_are_those_of_the_first_six_cracks_at_each_end(angle):
    """Cracks at 70 and 100 degrees from the flaw's plane at its two ends; later and farther ones do not count."""
    slit = Slit(centre=(0.02, 0.05), length=15e-3, width=3e-3, angle=angle, rounded=True)
    t = slit.direction
    n = np.array([-t[1], t[0]])
    x, normal = [], []
    for k in range(8):
        for end, lean in ((1.0, 70.0), (-1.0, 100.0)):
            # the crack is a line at `lean` from end t towards end n; its normal a quarter turn from it
            x.append(np.array(slit.centre) + end * ((7.5e-3 + 1e-4 * k) * t + 1e-3 * n))
            late = 0.0 if k < 6 else 40.0
            normal.append(math.radians(angle + lean + late + 90.0))
        x.append(np.array(slit.centre) + 5e-3 * n)  # beside the middle
        normal.append(math.radians(angle))
    got = first_crack_angles(np.array(x), np.array(normal), slit)
    assert got == pytest.approx([70.0, 100.0], abs=1e-4)
    few = first_crack_angles(np.array(x)[:15], np.array(normal)[:15], slit)  # five at each end
    assert np.isnan(few).all()
