"""The closed forms of several rocks, held to what they must be: continuous, and those of one rock or of a hole."""

import numpy as np
import pytest

from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.verify.elastic.closed_forms import kirsch
from rsmpm_ti.verify.interfaces.closed_forms import RoundInclusion, across_layers, along_free_layers, along_layers

STIFF, SOFT = Hooke(E=60e9, nu=0.2), Hooke(E=5e9, nu=0.35)


@pytest.mark.parametrize("inside, around", [(STIFF, SOFT), (SOFT, STIFF), (SOFT, SOFT)])
def test_tractions_and_displacements_are_those_of_both_on_the_circle(inside, around):
    """Muskhelishvili (1953), sec. 41: 2 mu (u + i v) = kappa phi - z conj(phi') - conj(psi). The displacements, which
    the code does not use, tell whether the stress of the inclusion is right."""
    field = RoundInclusion(inside=inside, around=around, radius=1.0)
    t = np.linspace(0.0, 2.0 * np.pi, 37)
    normal = np.stack([np.cos(t), np.sin(t)], axis=1)
    outside = np.einsum("nij,nj->ni", field.stress_around((1.0 + 1e-12) * normal), normal)
    assert outside == pytest.approx(normal * field.stress, abs=1e-10)

    s_xx, s_yy = field.stress
    a, b = 0.25 * (s_xx + s_yy), 0.5 * (s_yy - s_xx)
    A, B = b - 0.5, 2.0 * a - 0.5
    z, kappa_i, kappa_m = np.exp(1j * t), 3.0 - 4.0 * inside.nu, 3.0 - 4.0 * around.nu
    within = (kappa_i * a * z - a * z - b * np.conj(z)) / inside.mu
    phi, slope = 0.25 * z + A / z, 0.25 - A / z**2
    psi = 0.5 * z + B / z + A / z**3
    beyond = (kappa_m * phi - z * np.conj(slope) - np.conj(psi)) / around.mu
    assert beyond * around.mu == pytest.approx(within * around.mu, abs=1e-12)


def test_an_inclusion_of_nothing_is_a_hole_and_of_the_same_rock_is_none():
    x = np.random.default_rng(1).uniform(1.0, 3.0, (50, 2))
    nothing = RoundInclusion(inside=Hooke(E=1e-3, nu=0.2), around=STIFF, radius=1.0)
    assert nothing.stress_around(x) == pytest.approx(kirsch(x, 1.0), abs=1e-9)
    same = RoundInclusion(inside=STIFF, around=STIFF, radius=1.0)
    assert same.stress == pytest.approx((0.0, 1.0), abs=1e-15)
    assert same.stress_around(x) == pytest.approx(np.broadcast_to(np.diag([0.0, 1.0]), (50, 2, 2)), abs=1e-15)


def test_layers_of_one_rock_are_that_rock():
    rocks, halves = (STIFF, STIFF), (0.5, 0.5)
    for modulus in (across_layers, along_layers):
        assert modulus(rocks, halves) == pytest.approx(STIFF.lam + 2.0 * STIFF.mu)
    assert along_free_layers(rocks, halves) == pytest.approx(STIFF.E / (1.0 - STIFF.nu**2))


def test_layers_along_hold_to_equilibrium():
    """The strains of both layers by two equations in two unknowns: equal stress across, and no strain across in sum."""
    rocks, f = (STIFF, SOFT), np.array([0.3, 0.7])
    M, lam = (np.array([getattr(rock, name) for rock in rocks]) for name in ("p_wave_modulus", "lam"))
    across = np.linalg.solve([[M[0], -M[1]], f], [lam[1] - lam[0], 0.0])
    assert along_layers(rocks, tuple(f)) == pytest.approx(f @ (M + lam * across))
