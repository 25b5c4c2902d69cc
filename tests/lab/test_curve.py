"""Moduli and crack stresses are read back from curves that are made of them."""

import math

import numpy as np
import pytest

from rsmpm_ti.lab.curve import curve_of

E, NU, PEAK, PRESSURE = 40e9, 0.25, 120e6, 10e6


def history_of(q: np.ndarray, axial: np.ndarray, lateral: np.ndarray, pressure: float = 0.0) -> np.ndarray:
    """Rows as a run writes them: a row's stress is the mean since the row before."""
    middle = 0.5 * (q + np.concatenate([[0.0], q[:-1]])) + pressure
    columns = {
        "time_s": np.arange(len(q), dtype=float), "axial_strain": axial, "lateral_strain": lateral,
        "volumetric_strain": axial + lateral, "stress_top_Pa": middle, "stress_bottom_Pa": middle,
    }  # fmt: skip
    rows = np.zeros(len(q), dtype=[(name, np.float64) for name in columns])
    for name, values in columns.items():
        rows[name] = values
    return rows


def elastic(count: int = 401, plane_stress: bool = False):
    """Hooke's law in plane strain, or plane stress, up to the peak."""
    q = np.linspace(0.0, PEAK, count)
    axial = q / E * (1.0 if plane_stress else 1.0 - NU**2)
    lateral = -q / E * (NU if plane_stress else NU * (1.0 + NU))
    return q, axial, lateral


@pytest.mark.parametrize("plane_stress", [False, True])
@pytest.mark.parametrize("pressure", [0.0, PRESSURE])
def test_moduli_of_an_elastic_specimen_are_those_of_its_rock(plane_stress, pressure):
    history = history_of(*elastic(plane_stress=plane_stress), pressure=pressure)
    curve = curve_of(history, pressure=pressure, peak=PEAK + pressure, plane_stress=plane_stress)
    for modulus in (curve.tangent, curve.average, curve.secant):
        assert modulus == pytest.approx(E, rel=1e-6)
    assert curve.nu == pytest.approx(NU, rel=1e-6)
    assert math.isnan(curve.initiation()) and math.isnan(curve.damage()), "nothing cracks before the peak"


def test_crack_stresses_are_where_the_volume_begins_to_grow():
    """Cracks open sideways from 60 MPa on, as the square of what is above it."""
    q, axial, lateral = elastic()
    begun = 60e6
    opened = 3e-3 * np.maximum(q - begun, 0.0) ** 2 / PEAK**2
    curve = curve_of(history_of(q, axial, lateral - opened), pressure=0.0, peak=PEAK, plane_stress=False)
    # a hundredth of the elastic volume at the peak is noticed, (q - begun)^2 = 0.01 slope peak^3/3e-3
    noticed = begun + math.sqrt(0.01 * (1.0 - NU**2 - NU * (1.0 + NU)) / E * PEAK**3 / 3e-3)
    assert curve.initiation() == pytest.approx(noticed, rel=0.01)
    slope = (1.0 - NU**2 - NU * (1.0 + NU)) / E
    turn = begun + slope * PEAK**2 / (2.0 * 3e-3)  # where 2 a (q - begun)/peak^2 is the elastic slope
    assert curve.damage() == pytest.approx(turn, rel=0.02)


def test_lateral_strain_that_is_not_known_leaves_the_axial_moduli():
    q, axial, lateral = elastic(plane_stress=True)
    history = history_of(q, axial, np.full_like(lateral, np.nan))
    curve = curve_of(history, pressure=0.0, peak=PEAK, plane_stress=True)
    assert curve.tangent == pytest.approx(E, rel=1e-6)
    assert math.isnan(curve.nu) and math.isnan(curve.damage())
