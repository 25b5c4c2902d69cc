"""Cohesion and friction angle of a triaxial set, against the line that made its peaks."""

import math

import numpy as np
import pytest

from rsmpm_ti import Rock
from rsmpm_ti.lab.compression import envelope

GRANITE = dict(density=2650.0, E=55e9, nu=0.25, UCS=160e6, sigma_t=9e6, phi=50.0, G_f=40.0, G_f_II=4000.0)
PRESSURE = np.array([0.0, 10e6, 20e6, 40e6])


def test_peaks_on_a_line_give_its_cohesion_and_angle():
    rock = Rock.from_lab(**GRANITE)
    peak = np.array([rock.criterion.strength(p) for p in PRESSURE])
    cohesion, phi = envelope(rock, PRESSURE, peak)
    assert cohesion.value == pytest.approx(rock.criterion.cohesion, rel=1e-9) and cohesion.error < 1e-6 * cohesion.value
    assert phi.value == pytest.approx(50.0, rel=1e-9) and phi.error < 1e-6


def test_confidence_covers_what_made_scattered_peaks():
    """95 % of the intervals hold the true value: of 200 sets of seven, at least 180."""
    rock, random = Rock.from_lab(**GRANITE), np.random.default_rng(1)
    pressure = np.linspace(0.0, 60e6, 7)
    held = 0
    for _ in range(200):
        peak = np.array([rock.criterion.strength(p) for p in pressure]) + random.normal(0.0, 8e6, len(pressure))
        _, phi = envelope(rock, pressure, peak)
        held += abs(phi.value - 50.0) <= phi.error
    assert 180 <= held <= 199


def test_one_peak_makes_no_line():
    rock = Rock.from_lab(**GRANITE)
    cohesion, phi = envelope(rock, PRESSURE, np.array([160e6, np.nan, np.nan, np.nan]))
    assert math.isnan(cohesion.value) and math.isnan(phi.value)
