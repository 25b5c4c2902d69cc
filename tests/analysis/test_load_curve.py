"""The filtered load: what is a peak, and what is a row alone or a load that has not fallen yet."""

from dataclasses import replace

import numpy as np
import pytest
from small_scene import make

from rsmpm_ti.analysis.load_curve import FILTER_TRANSITS, FilteredLoad, filter_rows
from rsmpm_ti.spec.scene import Schedule

SCENE = make()


def followed(stress, scene=SCENE) -> FilteredLoad:
    load = FilteredLoad(scene)
    for k, value in enumerate(stress):
        load.see(float(value), 1e-5 * k)
    return load


@pytest.mark.parametrize("rows", [20, 1000, 20_000])
def test_filter_spans_a_quarter_of_a_wave_transit_and_three_rows_at_least(rows):
    scene = make(schedule=Schedule(strain_end=1e-3, rows=rows))
    interval = scene.dt * max(1, scene.steps // rows)
    transit = 0.1 / scene.wave_speed
    found = filter_rows(scene)
    assert found % 2 == 1 and found >= 3
    assert found == 3 or abs(found * interval / transit - FILTER_TRANSITS) <= interval / transit


def test_load_that_only_rises_has_no_peak_and_its_largest_is_half_a_filter_behind():
    half = filter_rows(SCENE) // 2
    load = followed(np.arange(50.0))
    assert not load.passed and load.peak == 49.0 - half and load.fraction == 1.0


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_load_that_falls_had_a_peak(sign):
    rise, half = np.linspace(0.0, 100.0, 101), filter_rows(SCENE) // 2
    load = followed(sign * np.concatenate([rise, rise[::-1][:30]]))
    assert load.passed and load.peak == pytest.approx(sign * 100.0, rel=0.02 * (half + 1))
    assert load.peak_strain == pytest.approx(1e-3, abs=1e-5 * (half + 1))
    assert load.fraction == pytest.approx(0.7, abs=0.02 * (half + 1))


def test_swing_of_less_than_a_tenth_is_no_fall():
    assert not followed(100.0 + 4.0 * np.sin(np.arange(100.0))).passed


def test_row_alone_is_no_peak():
    spiked = np.linspace(0.0, 10.0, 101)
    spiked[50] = 1e3
    load = followed(spiked)
    assert load.largest <= 10.0 and not load.passed


def test_fall_is_counted_without_the_confining_pressure():
    scene = replace(SCENE, loading=replace(SCENE.loading, confinement=10.0))
    load = followed(10.0 + np.concatenate([np.linspace(0.0, 20.0, 50), np.full(20, 2.0)]), scene)
    assert load.fraction == pytest.approx(0.1, abs=0.01) and load.peak == pytest.approx(30.0, abs=1.5)


def test_where_nothing_is_measured_there_is_no_peak():
    load = followed(np.full(20, np.nan))
    assert not load.passed and load.fraction == 1.0 and np.isnan(load.peak)
