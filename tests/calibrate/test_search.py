"""The search itself: how few evaluations it needs, and whether its intervals hold what they promise."""

from dataclasses import replace

import numpy as np
import pytest
from fake_laboratory import GRANITE, FakeLaboratory, measured, wanted

from rsmpm_ti.calibrate.calibration import calibrate
from rsmpm_ti.calibrate.targets.parameter import own_value, with_values

BOUNDS = {"E": (20e9, 90e9), "UCS": (60e6, 300e6), "sigma_t": (2e6, 20e6), "G_f": (10.0, 200.0)}
NAMES = [
    ("ucs", "E tangent"), ("ucs", "UCS"), ("tension", "tensile strength"), ("bend", "K_Ic by the work of fracture"),
    ("brazilian", "BTS"),
]  # fmt: skip


@pytest.fixture(autouse=True)
def no_picture(monkeypatch):
    monkeypatch.setattr("rsmpm_ti.calibrate.calibration.draw", lambda *_: None)


def test_a_third_of_the_evaluations_of_a_simplex_are_needed(tmp_path):
    from scipy.optimize import minimize

    asked = wanted(BOUNDS, measured(replace(GRANITE, E=38e9, UCS=210e6, sigma_t=6e6, G_f=100.0), *NAMES), 60)
    ours, theirs = FakeLaboratory(), FakeLaboratory()
    found = calibrate(GRANITE, asked, measure=ours, out=tmp_path)

    def misfit(place):
        values = {p.key: p.at(u) for p, u in zip(asked.parameters, place, strict=True)}
        residuals = asked.residuals(theirs(with_values(GRANITE, values), tmp_path))
        return residuals @ residuals

    start = [p.place(own_value(GRANITE, p.key)) for p in asked.parameters]
    least = max(found.best.misfit, 0.05)
    minimize(misfit, start, method="Nelder-Mead", bounds=[(0.0, 1.0)] * 4,
             callback=lambda intermediate_result: _stop(intermediate_result.fun < least))  # fmt: skip
    assert 3 * len(ours.calls) <= len(theirs.calls)


def _stop(reached: bool) -> None:
    if reached:
        raise StopIteration


def test_intervals_hold_the_truth_in_95_of_100_calibrations(tmp_path):
    """Measurements that scatter by their errors: 25 calibrations of three parameters, of 75 intervals 71 expected."""
    random, held = np.random.default_rng(5), 0
    truth = replace(GRANITE, E=38e9, UCS=150e6, sigma_t=7e6)
    bounds = {key: BOUNDS[key] for key in ("E", "UCS", "sigma_t")}
    for k in range(25):
        targets = [replace(t, value=t.value + t.error * random.standard_normal()) for t in measured(truth, *NAMES[:3])]
        found = calibrate(GRANITE, wanted(bounds, targets), measure=FakeLaboratory(), out=tmp_path / str(k))
        intervals = found.uncertainty.intervals
        held += sum(intervals[key].lower <= getattr(truth, key) <= intervals[key].upper for key in bounds)
    assert 66 <= held <= 74
