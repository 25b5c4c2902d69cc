"""Means over seeds, and how numbers are shown."""

import math

import numpy as np
import pytest

from rsmpm_ti.lab.quantity import Quantity, over_seeds
from rsmpm_ti.lab.tension import tension_in_the_middle


def one(value: float, error: float = math.nan) -> Quantity:
    return Quantity(name="UCS", unit="Pa", value=value, about="peak", error=error)


def test_mean_of_seeds_has_the_interval_of_students_t():
    """Of three values 1, 2, 3: 2 and t(0.975, 2) s/sqrt(3) = 4.3027/sqrt(3)."""
    (mean,) = over_seeds([[one(1e6)], [one(2e6)], [one(3e6)]])
    assert mean.value == pytest.approx(2e6) and mean.values == (1e6, 2e6, 3e6)
    assert mean.error == pytest.approx(4.302653e6 / math.sqrt(3.0), rel=1e-6)


def test_one_seed_keeps_the_error_of_its_fit():
    (same,) = over_seeds([[one(1e6, error=1e4)]])
    assert same.error == 1e4 and same.values == (1e6,)


def test_seed_without_a_value_is_left_out():
    (mean,) = over_seeds([[one(1e6)], [one(math.nan)], [one(3e6)]])
    assert mean.value == pytest.approx(2e6)
    (none,) = over_seeds([[one(math.nan)], [one(math.nan)]])
    assert math.isnan(none.value) and math.isnan(none.error)


@pytest.mark.parametrize(
    ("quantity", "shown"),
    [
        (one(25.5e6, 0.3e6), ("25.5 ± 0.3", "MPa")),
        (Quantity(name="E", unit="Pa", value=17e9, about=""), ("17", "GPa")),
        (Quantity(name="nu", unit="1", value=0.25, about=""), ("0.25", "")),
        (Quantity(name="K_Ic", unit="Pa m^0.5", value=1.4e6, about=""), ("1.4", "MPa m^0.5")),
        (Quantity(name="opening", unit="m", value=2.5e-5, about=""), ("0.025", "mm")),
        (Quantity(name="CD", unit="Pa", value=math.nan, about=""), ("not defined", "")),
    ],
)
def test_numbers_are_shown_in_the_units_of_a_laboratory(quantity, shown):
    assert quantity.shown() == shown


def test_tension_in_the_middle_of_a_disc_is_hertzs_for_a_narrow_load_and_hondros_for_an_arc():
    assert tension_in_the_middle(1e-3) == pytest.approx(1.0, abs=1e-6)
    assert tension_in_the_middle(90.0) == pytest.approx(-1.0)  # pressed all round: the pressure is P/D, all of it
    # of many pairs of line loads, each at an angle t: cos(t)^2 of its tension 1, sin(t)^2 of its pressure 3
    t = np.radians(10.0) * (np.arange(1000) + 0.5) / 1000
    exact = float(np.mean(np.cos(t) ** 2 - 3.0 * np.sin(t) ** 2))
    assert tension_in_the_middle(10.0) == pytest.approx(exact, rel=1e-6)
