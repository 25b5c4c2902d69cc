"""The generalised maximum tangential stress criterion against printed numbers, and stress on the faces of a flaw."""

import math

import numpy as np
import pytest

from rsmpm_ti.study.gmts import (
    critical_distance,
    inglis,
    initiation,
    mid_face_cube,
    mid_face_disc,
    sif_cube,
    sif_disc,
    tip,
)

SHARP = 1e-10
"""r_c over a at which T no longer counts."""


@pytest.mark.parametrize("angle, expected", [(15, 130.7), (30, 104.6), (45, 90.9), (60, 82.3), (75, 75.9)])
def test_sharp_cube_crack_leaves_at_the_printed_angle(angle, expected):
    # 0.2: K is printed with four digits, and at 15 degrees one in the last moves the angle by 0.1
    assert tip(sif_cube(angle), SHARP)[0] == pytest.approx(expected, abs=0.2)


@pytest.mark.parametrize(
    "angle, expected",
    [(0, 0.0), (10, 51.1), (15, 59.3), (20, 64.7), (27.217, 70.53), (30, 72.5), (45, 82.9), (60, 96.7), (75, 123.0)],
)
def test_sharp_disc_crack_leaves_at_the_printed_angle(angle, expected):
    # 0.1: printed to a tenth; the angle of the largest of a flat top is found to 1e-4 degrees
    assert tip(sif_disc(angle), SHARP)[0] == pytest.approx(expected, abs=0.1)


@pytest.mark.parametrize("ratio, expected", [(0.1, 11.20), (0.25, 25.33), (0.5, 40.21), (1, 53.13), (2, 61.34)])
def test_sharp_crack_follows_erdogan_and_sih(ratio, expected):
    assert initiation(1.0, ratio, 0.0, 1.0)[0] == pytest.approx(expected, abs=0.01)  # printed with two decimals


def test_pure_shear_needs_root_three_over_two_of_the_opening_toughness():
    """K_IIc/K_Ic = sqrt(3)/2 at 2 atan(1/sqrt 2), whatever the sign of K_II."""
    for K_II in (1.0, -1.0):
        angle, stress = initiation(0.0, K_II, 0.0, 0.5 / math.pi)
        assert angle == pytest.approx(2.0 * math.degrees(math.atan(math.sqrt(0.5))), abs=1e-4)  # a flat top
        assert 1.0 / stress == pytest.approx(0.5 * math.sqrt(3.0), rel=1e-10)  # round-off


@pytest.mark.parametrize(
    "fraction, printed", [(0.0167, (0.94, 1.68, 2.00, 1.67, 0.72)), (0.2, (0.88, 0.88, 0.62, 0.18, 0.0))]
)
def test_concentration_at_a_distance_is_the_printed_one(fraction, printed):
    got = [tip(sif_cube(angle), fraction)[1] for angle in (15.0, 30.0, 45.0, 60.0, 75.0)]
    assert got == pytest.approx(printed, abs=0.0055)  # printed to a hundredth


@pytest.mark.parametrize("angle, expected, digits", [(10, 29, 0.5), (20, 54, 0.5), (27.217, 66.2, 0.05)])
def test_t_stress_turns_the_crack_of_a_disc_by_the_printed_angle(angle, expected, digits):
    assert tip(sif_disc(angle), 0.0167)[0] == pytest.approx(expected, abs=digits)


def test_crack_pressed_everywhere_has_no_direction():
    angle, stress = initiation(-1.0, 0.0, -1.0, 1.0)
    assert math.isnan(angle) and stress == 0.0


def test_critical_distance_gives_back_the_stress_it_was_fitted_to():
    r_c = critical_distance(sif_cube(45.0), 7.5e-3, 0.7)
    assert tip(sif_cube(45.0), r_c / 7.5e-3)[1] == pytest.approx(0.7, rel=1e-8)
    # without T the stress falls with the root of the distance; T at 45 degrees adds 0.054, so 2 % less than this
    equivalent = tip((*sif_cube(45.0)[:2], 0.0), 0.5)[1]
    bare = critical_distance((*sif_cube(45.0)[:2], 0.0), 7.5e-3, 0.7)
    assert bare == pytest.approx(7.5e-3 * 0.5 * (equivalent / 0.7) ** 2, rel=1e-8)
    assert bare < r_c


def test_critical_distance_of_a_stress_never_reached_is_not_a_number():
    assert math.isnan(critical_distance(sif_cube(75.0), 7.5e-3, 1e4))
    assert math.isnan(critical_distance(sif_cube(45.0), 7.5e-3, 0.1))  # T, 0.054, and the root's rest are more at a
    assert math.isnan(critical_distance(sif_cube(45.0), 7.5e-3, math.nan))


def test_interpolated_intensities_follow_those_of_an_infinite_plate():
    """-cos^2, sin cos, cos 2b: the finite width adds 3 to 8 % (docs/references.md, section 7), and T at most 0.08."""
    for angle in np.linspace(0.0, 90.0, 31):
        b = math.radians(angle)
        got = np.array(sif_cube(angle))
        infinite = np.array([-(math.cos(b) ** 2), math.sin(b) * math.cos(b), math.cos(2.0 * b)])
        assert np.all(np.abs(got - infinite) <= 0.1), angle


def test_interpolated_intensities_are_mirrored_about_the_load_and_across_it():
    """So the even ones are level there: T, cos 2b, changes by 6e-6 in a tenth of a degree."""
    for sif, scale in ((sif_cube, 1.0), (sif_disc, 4.0)):
        for end, beside in ((0.0, 0.1), (90.0, 89.9)):
            K_I, K_II, T = sif(beside)
            assert K_I == pytest.approx(sif(end)[0], abs=2e-5 * scale)
            assert T == pytest.approx(sif(end)[2], abs=2e-5 * scale)
            assert sif(end)[1] == pytest.approx(0.0, abs=1e-12) and K_II > 0.0


def test_ends_and_middle_of_a_hole_are_those_of_inglis():
    fraction = 0.2
    assert inglis(0.0, fraction, 90.0) == pytest.approx(1.0 + 2.0 / fraction)  # end, pulled across
    assert inglis(90.0, fraction, 90.0) == pytest.approx(-1.0)
    assert inglis(0.0, fraction, 0.0) == pytest.approx(-1.0)
    assert inglis(90.0, fraction, 0.0) == pytest.approx(1.0 + 2.0 * fraction)  # pulled along
    assert inglis(37.0, 1.0 - 1e-12, 0.0) == pytest.approx(1.0 - 2.0 * math.cos(math.radians(74.0)))  # a round hole


def test_flaw_across_the_load_is_pulled_in_its_middle_whatever_its_width():
    for fraction in (1e-6, 0.1, 0.2):
        assert mid_face_cube(0.0, fraction) == pytest.approx(1.0)
        # 3 of the load across it, and 1 + 2 b/a of the pull along it
        assert mid_face_disc(90.0, fraction) == pytest.approx(4.0 + 2.0 * fraction)
    assert mid_face_cube(90.0, 0.2) == pytest.approx(-1.4)
