"""Beams and half discs: closed forms of their set-ups, and where rollers, notch and gauge are."""

import math

import numpy as np
import pytest

from rsmpm_ti import SceneError, bending_test, lab_rock, semicircular_test
from rsmpm_ti.setups.bending import peak_deflection, peak_load, shape_factor
from rsmpm_ti.setups.semicircular import stress_intensity

DX = 1e-3
ROCK = lab_rock(length=2.0 * DX)


@pytest.mark.parametrize(("ratio", "factor"), [(0.45, 2.29), (0.5, 2.66), (0.55, 3.14)])
def test_shape_factor_is_that_of_the_standard(ratio, factor):
    """f(a/W) of ASTM E399, table A3.1, to its digits."""
    assert shape_factor(ratio) == pytest.approx(factor, abs=0.01)


def test_shallow_notch_is_an_edge_crack():
    """K = 1.12 sigma sqrt(pi a) at the edge of a bent beam, sigma = 3 P S/(2 W^2); a little less in its gradient."""
    depth, span, notch = 1.0, 4.0, 0.002
    K = span / depth**1.5 * shape_factor(notch)
    assert K == pytest.approx(1.12 * 1.5 * span / depth**2 * math.sqrt(math.pi * notch), rel=0.04)


def test_beam_without_a_notch_bends_as_beam_theory_says():
    load = peak_load(ROCK, depth=50e-3, span=200e-3, notch=0.0)
    assert 1.5 * load * 200e-3 / 50e-3**2 == pytest.approx(ROCK.criterion.tensile_strength)
    modulus = 17e9 / (1.0 - 0.14**2)
    slender = load * 4.0**3 / (4.0 * modulus)
    found = peak_deflection(ROCK, depth=50e-3, span=200e-3, notch=0.0)
    assert found == pytest.approx(slender * (1.0 + 2.4 * 1.14 / 16.0)), "shear adds 17 %"


def test_half_disc_is_within_four_per_cent_of_finite_elements():
    """K_I over P/sqrt(R) of quadratic elements with rollers a fortieth of the radius wide: 4.072."""
    got = stress_intensity(1.0, radius=1.0, notch=0.5, span=1.6)
    assert got == pytest.approx(4.072, rel=0.04), "rollers that are points bend a little more"


@pytest.mark.parametrize("build", [bending_test, semicircular_test])
def test_notch_cuts_the_middle_and_rollers_touch(build):
    size = {"depth": 40e-3, "notch": 20e-3} if build is bending_test else {"radius": 40e-3}
    scene = build(title="t", rock=ROCK, dx=DX, **size)
    x = np.concatenate([body.x for body in scene.particles()])
    middle = np.abs(x[:, 0]) < 1.5 * DX
    assert x[middle, 1].min() > 20e-3 - 2.0 * DX and x[:, 1].min() < DX and x[:, 1].max() > 39e-3
    lower, upper = scene.loading.boundaries[:2], scene.loading.boundaries[2]
    assert [0.5 * sum(b.span) for b in lower] == pytest.approx([-lower[1].span[1] + DX, lower[1].span[0] + DX])
    for boundary in (*lower, upper):
        near = np.abs(x[:, 1] - boundary.position) < DX
        assert (near & (x[:, 0] > boundary.span[0]) & (x[:, 0] < boundary.span[1])).any(), "rock is below each roller"
    assert scene.loading.cell.gauges[0].name == "mouth"


def test_notch_through_the_beam_is_refused():
    with pytest.raises(SceneError, match="notch = 0.05 is refused"):
        bending_test(title="t", rock=ROCK, dx=DX, depth=50e-3, notch=50e-3)
    with pytest.raises(SceneError, match="notch = 0.0 is refused"):
        semicircular_test(title="t", rock=ROCK, dx=DX, notch=0.0)


def test_gauge_and_pace_follow_what_they_are_told():
    told = bending_test(title="t", rock=ROCK, dx=DX, depth=40e-3, notch=20e-3, gauge_length=20e-3, servo=None)
    (gauge,) = told.loading.cell.gauges
    assert gauge.length == pytest.approx(20e-3) and told.loading.servo is None
    peak = peak_deflection(ROCK, depth=40e-3, span=160e-3, notch=20e-3)
    slower = bending_test(title="t", rock=ROCK, dx=DX, depth=40e-3, notch=20e-3, deflection_peak=3.0 * peak)
    assert slower.loading.start.time == pytest.approx(3.0 * told.loading.start.time)
    assert slower.schedule.strain_end == told.schedule.strain_end, "where it ends is another matter"
