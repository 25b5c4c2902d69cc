"""Plane stress: the moduli of a plate, no stress through it, and a volume that counts its thickness."""

import numpy as np
import pytest
import taichi as ti
from harness import matrix, on_rows, vector

from rsmpm_ti.rock.elasticity import Hooke

E, NU = 17e9, 0.14


@pytest.fixture(autouse=True, scope="module")
def running(taichi_f64):
    """Taichi functions need a running Taichi."""


def elastic(middle, law) -> np.ndarray:
    """Stress after one step from rest whose gradient at mid-step is `middle` = G (1 + G/2)^-1."""
    G = middle @ np.linalg.inv(np.eye(2) - 0.5 * np.asarray(middle))

    @ti.func
    def stress(a: ti.template(), p):
        return law.stress(vector(a, p, 0, 4), matrix(a, p, 4, 2))

    return on_rows(stress, np.concatenate([np.zeros((len(G), 4)), G.reshape(len(G), -1)], axis=1), 4)


def test_plane_stress_has_the_moduli_of_a_plate_and_no_stress_through_it():
    """Free sides: E and nu. Held sides: E/(1 - nu^2). Shear: mu. Timoshenko & Goodier, art. 17."""
    plate, e = Hooke(E=E, nu=NU, plane_stress=True), 1e-4
    plane = np.array([[[-NU * e, 0.0], [0.0, e]], [[0.0, 0.0], [0.0, e]], [[0.0, e], [e, 0.0]]])
    held = E / (1.0 - NU**2) * e
    expected = [[0.0, E * e, 0.0, 0.0], [NU * held, held, 0.0, 0.0], [0.0, 0.0, 0.0, 2.0 * plate.mu * e]]
    np.testing.assert_allclose(elastic(plane, plate), expected, rtol=0.0, atol=1e-14 * E * e)
    assert plate.p_wave_modulus == pytest.approx(E / (1.0 - NU**2), rel=1e-12)
    assert (plate.uniaxial_modulus(2), plate.lateral_ratio(2)) == (E, NU)


@pytest.mark.parametrize("plane_stress", [False, True])
def test_volume_ratio_counts_the_thickness_and_returns_after_a_cycle(plane_stress):
    """Small uniaxial strain e, free sides: plane strain e (1 - nu/(1 - nu)); plane stress e (1 - 2 nu)."""
    law, e = Hooke(E=E, nu=NU, plane_stress=plane_stress), 1e-6
    G = np.array([[[-law.lateral_ratio(2) * e, 0.0], [0.0, e]], [[0.5, 0.1], [0.0, 0.2]]])
    rows = np.concatenate([G, np.linalg.inv(np.eye(2) + G) - np.eye(2)]).reshape(4, 4)

    @ti.func
    def ratio(a: ti.template(), p):
        return ti.Vector([law.volume_ratio(matrix(a, p, 0, 2))])

    found = on_rows(ratio, rows, 1)[:, 0]
    expected = 1.0 - 2.0 * NU if plane_stress else 1.0 - NU / (1.0 - NU)
    assert (found[0] - 1.0) / e == pytest.approx(expected, rel=1e-5)  # e^2 terms
    np.testing.assert_allclose(found[:2] * found[2:], 1.0, rtol=1e-13)
