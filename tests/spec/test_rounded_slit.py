"""A flaw with round ends: its outline by hand, its area in particles, and what is asked of any slit."""

import json
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import load_scene
from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import QuadraticBSpline
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.review.slit_check import check_slit
from rsmpm_ti.spec.scene_json import from_plain, to_plain
from rsmpm_ti.spec.seeding import Lattice

LENGTH, WIDTH, CENTRE = 15e-3, 3e-3, (25e-3, 50e-3)
BLOCK = Box(lower=(0.0, 0.0), upper=(50e-3, 100e-3))
angles = pytest.mark.parametrize("angle", [0.0, 30.0, 45.0, 90.0, -20.0])


def flaw(angle: float = 45.0, width: float = WIDTH) -> Slit:
    return Slit(centre=CENTRE, length=LENGTH, width=width, angle=angle, rounded=True)


def position(angle: float, along: float, across: float) -> np.ndarray:
    """A point given along and across the flaw [m], [1, 2]."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return np.array([[CENTRE[0] + along * c - across * s, CENTRE[1] + along * s + across * c]])


@angles
@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_round_ends_are_half_circles_within_the_length(angle, side):
    slit, square = flaw(angle), replace(flaw(angle), rounded=False)
    r, almost = 0.5 * WIDTH, 1.0 - 1e-6
    middle = 0.5 * LENGTH - r  # of the half circle
    for degrees in (0.0, 30.0, 60.0, 90.0, -45.0):
        along, across = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        assert slit.contains(position(angle, side * (middle + almost * r * along), almost * r * across)).all()
        assert not slit.contains(position(angle, side * (middle + r * along / almost), r * across / almost)).any()
    tip = position(angle, side * 0.5 * LENGTH * almost, 0.0)
    assert slit.contains(tip).all() and not slit.contains(position(angle, side * 0.5 * LENGTH / almost, 0.0)).any()
    corner = position(angle, side * 0.99 * 0.5 * LENGTH, 0.99 * r)
    assert square.contains(corner).all() and not slit.contains(corner).any()
    face = position(angle, side * 0.5 * middle, almost * r)
    assert slit.contains(face).all() and not slit.contains(position(angle, side * 0.5 * middle, r / almost)).any()


@angles
def test_rounded_slit_lies_within_its_bounds_and_reaches_its_length(angle):
    slit = flaw(angle)
    x = np.random.default_rng(3).uniform(-0.6 * LENGTH, 0.6 * LENGTH, (200_000, 2)) + np.array(CENTRE)
    held = x[slit.contains(x)]
    lower, upper = slit.bounds()
    assert ((held >= lower) & (held <= upper)).all()
    reach = np.ptp(slit.frame(held), axis=0)
    # 3e4 points inside: the outermost lies within a cap of some 1e-4 of the area, 0.4 % of the length from its tip
    assert reach == pytest.approx([LENGTH, WIDTH], rel=0.01)


def test_slit_as_wide_as_long_is_a_circle():
    hole = flaw(width=LENGTH)
    x = np.random.default_rng(5).uniform(-LENGTH, LENGTH, (5000, 2)) + np.array(CENTRE)
    np.testing.assert_array_equal(hole.contains(x), np.hypot(*(x - np.array(CENTRE)).T) < 0.5 * LENGTH)


@angles
def test_fitted_body_lacks_a_rectangle_and_a_circle(angle):
    slit = flaw(angle)
    seeds = Lattice(fitted=True).fill(Difference(whole=BLOCK, removed=(slit,)), np.zeros(2), 0.5e-3)
    removed = (LENGTH - WIDTH) * WIDTH + 0.25 * math.pi * WIDTH**2
    # samples place an edge to 1/32 of a sub-cell of 0.25 mm: at most that times the outline, 0.8 % of the flaw's area
    outline = 2.0 * (LENGTH - WIDTH) + math.pi * WIDTH
    assert 5e-3 - seeds.volume.sum() == pytest.approx(removed, abs=0.25e-3 / 32.0 * outline)
    assert seeds.volume.sum() == pytest.approx(5e-3 - removed, rel=0.005)
    assert not slit.contains(seeds.x).any()


def test_rounded_slit_survives_json_and_the_command_line_reaches_it():
    scene = load_scene("cube_lab")
    (slit,) = scene.bodies[0].region.removed
    assert slit.rounded
    assert from_plain(json.loads(json.dumps(to_plain(scene), allow_nan=False))) == scene
    plain = to_plain(slit)
    assert plain["rounded"] is True


@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0, 90.0])
@pytest.mark.parametrize("seeding", [Lattice(), Lattice(fitted=True)], ids=["stairs", "fitted"])
def test_narrow_rounded_slit_is_refused_with_a_width_that_passes(angle, seeding):
    def check(slit):
        check_slit(Difference(whole=BLOCK, removed=(slit,)), slit, seeding, QuadraticBSpline(), 0.5e-3, np.zeros(2))

    narrow = flaw(angle, 0.5e-3)
    with pytest.raises(SceneError, match=r"^slit\.width = 0.0005 m is refused") as refused:
        check(narrow)
    width = float(re.search(r"a width of at least (\S+) m", str(refused.value))[1])
    assert 0.5e-3 < width <= 2.5e-3
    check(flaw(angle, width))
