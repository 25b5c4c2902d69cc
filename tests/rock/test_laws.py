"""Laws of rock against closed forms: elasticity, failure envelope, what failed rock does, viscosity, refusals."""

import typing

import numpy as np
import pytest
import taichi as ti
from exact import (
    bulk_modulus,
    cone_apex,
    failure_factor,
    lame,
    p_wave_speed,
    plane_strain_modulus,
    uniaxial_strength,
)
from harness import build, matrix, name_of, on_rows, variants, vector

from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.after_failure import Clipped, pressure_energy
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.tensors import PACKED_LENGTH, extreme_principals
from rsmpm_ti.rock.viscosity import BulkViscosity

pytestmark = pytest.mark.usefixtures("taichi_f64")

E, NU, C, PHI, SIGMA_T = 17e9, 0.14, 5.95e6, 40.0, 2e6
ROCK = MohrCoulomb(cohesion=C, friction_angle=PHI, tensile_strength=SIGMA_T)
INTACT, TENSION, SHEAR = 0, 1, 2
PLACES = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
both_dims = pytest.mark.parametrize("dim", [2, 3])


def packed(full, dim: int) -> np.ndarray:
    return np.stack([full[:, a, b] for a, b in PLACES[: PACKED_LENGTH[dim]]], axis=1)


def turned(sxx: float, syy: float, szz: float, sxy: float, dim: int) -> np.ndarray:
    """A stress state [MPa] along 20 turned sets of axes, packed [20, 4 or 6] in Pa."""
    full = np.array([[sxx, sxy, 0.0], [sxy, syy, 0.0], [0.0, 0.0, szz]]) * 1e6
    t = np.linspace(0.0, np.pi, 20)
    zero, one = np.zeros_like(t), np.ones_like(t)
    R = np.stack([np.cos(t), -np.sin(t), zero, np.sin(t), np.cos(t), zero, zero, zero, one], axis=1).reshape(-1, 3, 3)
    if dim == 3:
        R = np.linalg.qr(np.random.default_rng(1).normal(size=(20, 3, 3)))[0]
    return packed(R @ full @ R.transpose(0, 2, 1), dim)


def modes(states, dim: int, criterion=ROCK) -> np.ndarray:
    """Mode of each state; `reached`, by which a step decides whom to look at, must name the same states."""
    length = PACKED_LENGTH[dim]

    @ti.func
    def mode(a: ti.template(), p):
        s = extreme_principals(vector(a, p, 0, length))
        return ti.Vector([ti.cast(criterion.mode(s[0], s[1]), float), ti.cast(criterion.reached(s[0], s[1]), float)])

    found, reached = on_rows(mode, states, 2).astype(int).T
    np.testing.assert_array_equal(reached, found != INTACT)
    return found


# sxx, syy, szz, sxy in MPa, tension positive; every strength lies between two rows 0.02 MPa apart
ENVELOPE = [
    (0.0, 1.99, 0.0, 0.0, INTACT),
    (0.0, 2.01, 0.0, 0.0, TENSION),
    (0.0, -25.51, 0.0, 0.0, INTACT),
    (0.0, -25.53, 0.0, 0.0, SHEAR),
    (0.0, -25.51, -3.57, 0.0, INTACT),  # plane strain: the intermediate stress counts for nothing
    (0.0, -25.53, -3.57, 0.0, SHEAR),
    (1.0, -20.91, 0.0, 0.0, INTACT),
    (1.0, -20.93, 0.0, 0.0, SHEAR),
    (2.001, -16.32, 0.0, 0.0, TENSION),  # the corner of the envelope: both, and tension is asked first
    (2.001, -40.0, 0.0, 0.0, TENSION),
    (0.0, 0.0, 0.0, 1.99, INTACT),
    (0.0, 0.0, 0.0, 2.01, TENSION),
    (-5.0, -48.50, -10.0, 0.0, INTACT),
    (-5.0, -48.53, -10.0, 0.0, SHEAR),
    (-50.0, -50.0, -14.0, 0.0, INTACT),  # plane strain
    (-50.0, -50.0, 0.0, 0.0, SHEAR),  # plane stress: biaxial strength is the uniaxial one
    (-20.0, -107.7, -0.14 * 127.7, 0.0, INTACT),  # confined plane strain: out-of-plane stress is the least
    (-20.0, -107.9, -0.14 * 127.9, 0.0, SHEAR),  # (in the plane alone it would take 117.5)
    (0.0, 0.0, 2.01, 0.0, TENSION),
    (2.01, 2.01, 2.01, 0.0, TENSION),  # apex side
    (1.99, 1.99, 1.99, 0.0, INTACT),
    (-1e4, -1e4, -1e4, 0.0, INTACT),
]


@both_dims
@pytest.mark.parametrize("sxx, syy, szz, sxy, expected", ENVELOPE)
def test_failure_envelope(dim, sxx, syy, szz, sxy, expected):
    assert (modes(turned(sxx, syy, szz, sxy, dim), dim) == expected).all()


@both_dims
def test_failure_comes_exactly_at_the_strength_and_never_heals_under_more_load(dim):
    states = np.random.default_rng(3).normal(size=(400, PACKED_LENGTH[dim])) * 1e7
    full = np.zeros((400, 3, 3))
    for k in range(states.shape[1]):
        a, b = PLACES[k]
        full[:, a, b] = full[:, b, a] = states[:, k]
    values = np.linalg.eigvalsh(full)
    factor, by_tension = failure_factor(values[:, 2], values[:, 0], C, PHI, SIGMA_T)
    fails = np.isfinite(factor)
    assert by_tension[fails].any() and not by_tension[fails].all()
    states, factor, expected = states[fails], factor[fails, None], np.where(by_tension[fails], TENSION, SHEAR)
    assert (modes(states * factor * (1.0 - 1e-6), dim) == INTACT).all()
    np.testing.assert_array_equal(modes(states * factor * (1.0 + 1e-6), dim), expected)
    for more in (1.1, 3.0, 100.0):
        assert (modes(states * factor * more, dim) != INTACT).all()


def test_tie_of_tension_and_shear_is_tension():
    corner = np.array([[SIGMA_T, -16.4e6]])  # beyond Mohr-Coulomb too, and sigma_1 exactly at the strength

    @ti.func
    def mode(a: ti.template(), p):
        return ti.Vector([ti.cast(ROCK.mode(a[p, 0], a[p, 1]), float)])

    assert on_rows(mode, corner, 1)[0, 0] == TENSION


def test_frictionless_rock_fails_at_the_cohesion_in_shear():
    clay = MohrCoulomb(cohesion=1e6, friction_angle=0.0, tensile_strength=50e6)
    found = modes(np.array([[0.0, 0.0, 0.0, 0.99e6], [0.0, 0.0, 0.0, 1.01e6]]), 2, clay)
    assert found.tolist() == [INTACT, SHEAR]


@pytest.mark.parametrize("criterion", variants(Rock, "criterion"), ids=name_of)
def test_every_criterion_leaves_unloaded_rock_intact_and_says_whether_it_breaks(criterion):
    states = np.concatenate([np.zeros((1, 4)), np.random.default_rng(2).normal(size=(50, 4)) * 1e12])
    found = modes(states, 2, criterion)
    assert found[0] == INTACT
    assert set(found) <= {INTACT, TENSION, SHEAR}
    assert (found != INTACT).any() == criterion.breaks


def test_strengths_are_the_closed_forms():
    assert ROCK.ucs == pytest.approx(uniaxial_strength(C, PHI), rel=1e-12)
    assert ROCK.apex == pytest.approx(cone_apex(C, PHI), rel=1e-12)


def test_moduli_and_wave_speed_are_the_closed_forms():
    rock = Rock(density=2600.0, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable())
    elasticity = rock.elasticity
    assert (elasticity.lam, elasticity.mu) == pytest.approx(lame(E, NU), rel=1e-12)
    assert elasticity.bulk == pytest.approx(bulk_modulus(E, NU), rel=1e-12)
    assert elasticity.uniaxial_modulus(2) == pytest.approx(plane_strain_modulus(E, NU), rel=1e-12)
    assert rock.wave_speed() == pytest.approx(p_wave_speed(E, NU, 2600.0), rel=1e-12)
    assert rock.wave_speed(5.0) == pytest.approx(p_wave_speed(E, NU, 2600.0 * 25.0), rel=1e-12)


def elastic(sigma, middle, dim: int, elasticity) -> np.ndarray:
    """Stress after a step whose gradient at mid-step is `middle` = G (1 + G/2)^-1, so G = middle (1 - middle/2)^-1."""
    length = PACKED_LENGTH[dim]
    G = middle @ np.linalg.inv(np.eye(dim) - 0.5 * np.asarray(middle))

    @ti.func
    def stress(a: ti.template(), p):
        return elasticity.stress(vector(a, p, 0, length), matrix(a, p, length, dim))

    return on_rows(stress, np.concatenate([sigma, G.reshape(len(G), -1)], axis=1), length)


@pytest.mark.parametrize("elasticity", variants(Rock, "elasticity"), ids=name_of)
def test_unconfined_confined_and_free_sided_strains_give_their_moduli(elasticity):
    E, nu = elasticity.E, elasticity.nu
    e, (lam, mu), side = 1e-4, lame(E, nu), nu / (1.0 - nu)
    plane = np.array([[[-side * e, 0.0], [0.0, e]], [[0.0, 0.0], [0.0, e]]])
    found = elastic(np.zeros((2, 4)), plane, 2, elasticity)
    axial = plane_strain_modulus(E, nu) * e
    expected = [[0.0, axial, nu * axial, 0.0], [lam * e, (lam + 2 * mu) * e, lam * e, 0.0]]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-14 * E * e)
    space = np.array([np.diag([-nu * e, e, -nu * e]), np.diag([0.0, 0.0, e]), [[0, e, 0], [e, 0, 0], [0, 0, 0]]])
    found = elastic(np.zeros((3, 6)), space, 3, elasticity)
    expected = [
        [0.0, E * e, 0.0, 0.0, 0.0, 0.0],
        [lam * e, lam * e, (lam + 2 * mu) * e, 0.0, 0.0, 0.0],
        [0.0, 0.0, 0.0, 2 * mu * e, 0.0, 0.0],
    ]
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-14 * E * e)


@both_dims
@pytest.mark.parametrize("elasticity", variants(Rock, "elasticity"), ids=name_of)
def test_energy_is_half_of_stress_times_strain(elasticity, dim):
    length, (lam, mu) = PACKED_LENGTH[dim], lame(elasticity.E, elasticity.nu)
    eps = np.zeros((100, 3, 3))
    eps[:, :dim, :dim] = np.random.default_rng(7).normal(size=(100, dim, dim)) * 1e-3
    eps = 0.5 * (eps + eps.transpose(0, 2, 1))
    sigma = lam * np.trace(eps, axis1=1, axis2=2)[:, None, None] * np.eye(3) + 2.0 * mu * eps

    @ti.func
    def energy(a: ti.template(), p):
        return ti.Vector([elasticity.energy(vector(a, p, 0, length))])

    expected = 0.5 * np.sum(sigma * eps, axis=(1, 2))
    np.testing.assert_allclose(on_rows(energy, packed(sigma, dim), 1)[:, 0], expected, rtol=1e-12)
    # and the law itself puts that stress there
    np.testing.assert_allclose(
        elastic(np.zeros((100, length)), eps[:, :dim, :dim], dim, elasticity), packed(sigma, dim), rtol=1e-9, atol=1.0
    )


@both_dims
@pytest.mark.parametrize("elasticity", variants(Rock, "elasticity"), ids=name_of)
def test_ten_turns_keep_the_invariants_and_bring_the_stress_home(elasticity, dim):
    """The explicit Jaumann step would grow the deviator by exp(8 pi^2/360) = 25 % in every turn."""
    length, per_turn, turns = PACKED_LENGTH[dim], 360, 10
    t = 2.0 * np.pi / per_turn
    axis = np.array([0.0, 0.0, 1.0]) if dim == 2 else np.array([1.0, 2.0, 2.0]) / 3.0
    K = np.cross(np.eye(3), -axis)

    def rotation(angle):
        return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K

    @ti.func
    def spin(a: ti.template(), p):
        s, G = vector(a, p, 0, length), matrix(a, p, length, dim)
        for _ in range(ti.cast(a[p, length + dim * dim], int)):
            s = elasticity.stress(s, G)
        return s

    full = np.random.default_rng(4).normal(size=(3, 3)) * 1e7
    full = full + full.T
    if dim == 2:
        full[2, :2] = full[:2, 2] = 0.0
    start = packed(full[None], dim)[0]
    gradient = (rotation(t) - np.eye(3))[:dim, :dim].ravel()
    quarter = packed((rotation(np.pi / 2) @ full @ rotation(np.pi / 2).T)[None], dim)[0]
    steps = [per_turn // 4, per_turn, per_turn * turns]
    found = on_rows(spin, [[*start, *gradient, n] for n in steps], length)
    # a gradient of a rotation has a strain of one round-off, so each step may add E x 2e-16
    atol = 4.0 * E * np.finfo(float).eps * np.array(steps)[:, None]
    assert (np.abs(found - np.array([quarter, start, start])) < atol).all()


# bulk modulus K and volume ratio J -> pressure of failed rock, by class
PRESSURES = {
    "CompressionOnly": lambda law, K, J: np.maximum(K * (1.0 - J), 0.0),
    "Void": lambda law, K, J: np.zeros_like(J),
    "Clipped": lambda law, K, J: np.clip(K * (1.0 - J), -law.tension_limit, law.compression_limit),
}
AFTER_FAILURE = [
    *(
        build(kind)
        for kind in typing.get_args(typing.get_type_hints(Rock)["after_failure"])
        if not kind.oriented  # those have the closed forms of test_cracked_cell
    ),
    Clipped(tension_limit=0.0, compression_limit=5e6),
]
VOLUME_PATH = np.concatenate([np.linspace(1.0, 0.99, 41), np.linspace(0.99, 1.02, 121), np.linspace(1.02, 0.995, 101)])
"""Closing, opening, closing again."""


@pytest.mark.parametrize("law", AFTER_FAILURE, ids=name_of)
def test_failed_rock_follows_its_pressure_curve_on_closing_opening_and_reclosing(law):
    assert type(law).__name__ in PRESSURES, f"give the formula of the new law {law} in PRESSURES of this file"
    K = bulk_modulus(E, NU)

    @ti.func
    def respond(a: ti.template(), p):
        pressure = law.pressure(K, a[p, 0])
        return ti.Vector([pressure, pressure_energy(pressure, K, a[p, 0])])

    pressure, energy = on_rows(respond, VOLUME_PATH[:, None], 2).T
    expected = PRESSURES[type(law).__name__](law, K, VOLUME_PATH)
    np.testing.assert_allclose(pressure, expected, rtol=0.0, atol=1e-15 * K)
    # energy stored = work done on the particle from J = 1: -integral of p dJ, here by midpoints of a fine path
    for J, stored in zip(VOLUME_PATH[::20], energy[::20], strict=True):
        edges = np.linspace(1.0, J, 20001)
        middle = 0.5 * (edges[1:] + edges[:-1])
        work = -np.sum(PRESSURES[type(law).__name__](law, K, middle) * np.diff(edges))
        assert stored == pytest.approx(work, rel=1e-6, abs=1e-9 * K)


@pytest.mark.parametrize("law", [law for law in variants(Rock, "viscosity") if law.acts], ids=name_of)
def test_viscosity_resists_compression_only(law):
    density, length, speed = 2600.0, 0.5e-3, 2617.0

    @ti.func
    def pressure(a: ti.template(), p):
        return ti.Vector([law.pressure(a[p, 0], density, length, speed)])

    rates = np.array([-1e4, -10.0, -0.05, 0.0, 0.05, 1e4])
    q = on_rows(pressure, rates[:, None], 1)[:, 0]
    assert (q[:3] > 0.0).all() and not q[3:].any()
    assert isinstance(law, BulkViscosity), f"add the formula of {law}"
    d = np.minimum(rates, 0.0)
    expected = density * length**2 * law.c1 * d**2 - law.c2 * density * length * speed * d
    np.testing.assert_allclose(q, expected, rtol=1e-12)


NAN, INF = float("nan"), float("inf")


@pytest.mark.parametrize(
    "field, make",
    [
        *[("elasticity.nu", lambda v=v: Hooke(E=E, nu=v)) for v in (0.5, 0.7, -1.0, NAN)],
        *[("elasticity.E", lambda v=v: Hooke(E=v, nu=NU)) for v in (0.0, -1.0, NAN, INF)],
        *[
            ("criterion.cohesion", lambda v=v: MohrCoulomb(cohesion=v, friction_angle=PHI, tensile_strength=SIGMA_T))
            for v in (0.0, -C, NAN)
        ],
        *[
            ("criterion.friction_angle", lambda v=v: MohrCoulomb(cohesion=C, friction_angle=v, tensile_strength=1e6))
            for v in (-1.0, 90.0, NAN)
        ],
        *[
            ("criterion.tensile_strength", lambda v=v: MohrCoulomb(cohesion=C, friction_angle=PHI, tensile_strength=v))
            for v in (-2e6, 0.0, 1.001 * cone_apex(C, PHI), NAN)
        ],
        ("after_failure.tension_limit", lambda: Clipped(tension_limit=NAN, compression_limit=1.0)),
        ("after_failure.compression_limit", lambda: Clipped(tension_limit=1.0, compression_limit=-1.0)),
        ("viscosity.c1", lambda: BulkViscosity(c1=-0.1)),
        ("viscosity.c2", lambda: BulkViscosity(c2=NAN)),
        *[
            ("rock.density", lambda v=v: Rock(density=v, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable()))
            for v in (0.0, -2600.0, NAN)
        ],
    ],
)
def test_impossible_rock_is_refused_by_field(field, make):
    with pytest.raises(SceneError, match=rf"^{field} = .* is refused: it must be "):
        make()


def test_strength_at_the_apex_and_nearly_incompressible_rock_are_accepted():
    assert MohrCoulomb(cohesion=C, friction_angle=PHI, tensile_strength=0.999 * cone_apex(C, PHI)).breaks
    assert Hooke(E=E, nu=0.499).p_wave_modulus > 0.0
