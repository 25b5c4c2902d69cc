"""Hoek-Brown and Fairhurst against their definitions, found by search and not by the formulas of the code."""

import functools

import numpy as np
import pytest
import taichi as ti
from harness import on_rows
from small_scene import make

from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.curved.fairhurst import Fairhurst
from rsmpm_ti.rock.curved.hoek_brown import HoekBrown, rock_mass
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.direct_shear import shear_test

pytestmark = pytest.mark.usefixtures("taichi_f64")

INTACT, TENSION, SHEAR = 0, 1, 2
MARBLE = Fairhurst(compressive_strength=130e6, tensile_strength=7.75e6)
GRIFFITH = Fairhurst(compressive_strength=16e6, tensile_strength=2e6)
SANDSTONE = HoekBrown(intact_strength=108e6, m=17.0, tensile_strength=5e6)
MASS = HoekBrown(intact_strength=60e6, **rock_mass(GSI=45.0, m_i=10.0, D=0.5), tensile_strength=10e3)
CURVED = {"marble": MARBLE, "griffith": GRIFFITH, "sandstone": SANDSTONE, "mass": MASS}


def outside_hoek_brown(rock: HoekBrown, sigma_1: float, sigma_3: float) -> bool:
    """By the equation, compression positive as it is published."""
    least, most = -sigma_1, -sigma_3
    inside = rock.m * least / rock.intact_strength + rock.s
    return inside <= 0.0 or most >= least + rock.intact_strength * inside**rock.a


def outside_fairhurst(rock: Fairhurst, sigma_1: float, sigma_3: float) -> bool:
    """Whether any point of Mohr's circle lies on or beyond tau^2 = k (sigma_t - sigma_n)."""
    angle = np.linspace(0.0, np.pi, 3001)
    r, centre = 0.5 * (sigma_1 - sigma_3), 0.5 * (sigma_1 + sigma_3)
    normal, shear = centre + r * np.cos(angle), r * np.sin(angle)
    return bool(np.any(shear**2 >= rock.k * (rock.tensile_strength - normal)))


def outside(rock, sigma_1: float, sigma_3: float) -> bool:
    by_shear = (outside_hoek_brown if isinstance(rock, HoekBrown) else outside_fairhurst)(rock, sigma_1, sigma_3)
    return sigma_1 >= rock.tensile_strength or by_shear


def factor(rock, sigma_1: float, sigma_3: float) -> float:
    """By how much a stress must be multiplied to fail, by bisection of its logarithm; nan beyond 1e4 strengths."""
    low, high = 1e-6, 1e4 * rock.ucs / max(abs(sigma_1), abs(sigma_3))
    if not outside(rock, high * sigma_1, high * sigma_3):
        return np.nan
    for _ in range(45):
        middle = np.sqrt(low * high)
        low, high = (low, middle) if outside(rock, middle * sigma_1, middle * sigma_3) else (middle, high)
    return high


def answers(rock, states: np.ndarray) -> np.ndarray:
    """mode, reached, shear_load of (sigma_1, sigma_3), [n, 3]."""

    @ti.func
    def asked(a: ti.template(), p):
        s = ti.Vector([a[p, 0], a[p, 1]])
        return ti.Vector(
            [
                ti.cast(rock.mode(s[0], s[1]), float), ti.cast(rock.reached(s[0], s[1]), float),
                rock.shear_load(s[0], s[1]),
            ]
        )  # fmt: skip

    return on_rows(asked, states, 3)


@pytest.fixture(params=CURVED)
def rock(request):
    return CURVED[request.param]


@functools.cache
def failing(rock) -> np.ndarray:
    """Stresses that just fail, from tension on all sides to a pressure of some strengths."""
    angles = np.radians(np.concatenate([np.linspace(-130.0, 40.0, 60), np.linspace(-134.0, -130.0, 20)]))
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1) * rock.ucs
    rays = np.stack([rays.max(axis=1), rays.min(axis=1)], axis=1)
    factors = np.array([factor(rock, *ray) for ray in rays])
    found = rays[np.isfinite(factors)] * factors[np.isfinite(factors), None]
    assert len(found) > 50
    return found


@pytest.fixture
def at_failure(rock) -> np.ndarray:
    return failing(rock)


def test_failure_comes_exactly_at_the_curve(rock, at_failure):
    margin = 1e-5  # of the search along the circle
    inside, beyond = answers(rock, at_failure * (1.0 - margin)), answers(rock, at_failure * (1.0 + margin))
    np.testing.assert_array_equal(inside[:, :2], INTACT)
    np.testing.assert_array_equal(beyond[:, 1], 1)
    by_tension = at_failure[:, 0] * (1.0 + 2.0 * margin) >= rock.tensile_strength
    assert by_tension.any() and not by_tension.all()
    np.testing.assert_array_equal(beyond[:, 0], np.where(by_tension, TENSION, SHEAR))


def test_load_factor_is_what_the_strength_is_to_the_stress(rock, at_failure):
    by_shear = at_failure[at_failure[:, 0] * (1.0 + 1e-4) < rock.tensile_strength]
    for part in (0.01, 0.5, 0.9, 1.0, 3.0):
        np.testing.assert_allclose(answers(rock, part * by_shear)[:, 2], part, rtol=1e-4)


def test_more_of_a_load_never_heals(rock, at_failure):
    for more in (1.1, 3.0, 100.0):
        assert (answers(rock, at_failure * more)[:, 0] != INTACT).all()


def test_nothing_and_pressure_on_all_sides_leave_rock_intact(rock):
    found = answers(rock, np.array([[0.0, 0.0], [-1e3, -1e3], [-1e9, -1e9]]))
    np.testing.assert_array_equal(found[:, :2], 0.0)
    assert (found[:, 2] < 1e-6).all()


def test_strength_under_pressure_is_where_the_kernels_fail(rock):
    for pressure in (0.0, 0.1 * rock.ucs, rock.ucs):
        axial = rock.strength(pressure)
        states = np.array([[-pressure, -axial * (1.0 - 1e-9)], [-pressure, -axial * (1.0 + 1e-9)]])
        assert answers(rock, states)[:, 0].tolist() == [INTACT, SHEAR]


def test_griffith_is_the_parabola_of_eight_tensile_strengths():
    """Griffith (1924): (sigma_1 - sigma_3)^2 = 8 T (sigma_1 + sigma_3), compression positive, where 3 sigma_3 +
    sigma_1 > 0 (Jaeger, Cook & Zimmerman 2007, sec. 10.9)."""
    for least in (-1e6, 0.0, 3e6, 20e6):
        most = GRIFFITH.strength(least)
        assert (most - least) ** 2 == pytest.approx(8.0 * 2e6 * (most + least), rel=1e-12)


def test_intact_rock_mass_is_intact_rock():
    assert rock_mass(GSI=100.0, m_i=17.0) == pytest.approx({"m": 17.0, "s": 1.0, "a": 0.5}, abs=1e-4)


@pytest.mark.parametrize(
    "make_it, said",
    [
        (lambda: HoekBrown(intact_strength=100e6, m=10.0, tensile_strength=11e6), "s sigma_ci/m = 1e+07 Pa"),
        (lambda: Fairhurst(compressive_strength=20e6, tensile_strength=7e6), "compressive_strength/3"),
        (lambda: rock_mass(GSI=145.0, m_i=10.0), "GSI = 145.0 is refused"),
    ],
)
def test_impossible_curve_is_refused(make_it, said):
    with pytest.raises(SceneError, match=said.replace("+", r"\+")):
        make_it()


def test_directional_asks_for_mohr_coulomb():
    lab = lab_rock()
    curved = Rock(density=2600.0, elasticity=lab.elasticity, criterion=SANDSTONE, after_failure=lab.after_failure)
    with pytest.raises(SceneError, match="MohrCoulomb beside after_failure = Directional"):
        make(rock=curved)
    assert isinstance(lab.criterion, MohrCoulomb)


def test_direct_shear_asks_for_mohr_coulomb():
    curved = Rock(density=2600.0, elasticity=lab_rock().elasticity, criterion=SANDSTONE)
    with pytest.raises(SceneError, match="cohesion and friction"):
        shear_test(title="shear", rock=curved, dx=1e-3, normal_stress=1e6, displacement_end=1e-4)
