"""Instants of a run by their names: start, first failure, peak, end, or a strain."""

import math

import numpy as np

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.history_table import nominal_stress

NAMES = ("start", "first failure", "peak", "end")


def time_of(at: str | float, history: np.ndarray, events: EventTable) -> float:
    """The time of an instant [s]: 0 at the start, infinite at the end, that of the largest load at the peak, and at a
    strain that of the row nearest to it, the first of several.

    Raises SceneError for an instant that the run has not, as a peak without a load.
    """
    if isinstance(at, str):
        if at not in NAMES:
            raise refuse("at", at, f"one of {', '.join(NAMES)}, or a strain")
        if at == "first failure" and not len(events):
            raise SceneError("nothing failed in this run, so it has no first failure")
        if at == "first failure":
            return float(events.time[0])
        if at != "peak":
            return 0.0 if at == "start" else math.inf
        load = np.abs(nominal_stress(history))
        if not np.isfinite(load).any():
            raise SceneError("no load was recorded in this run, so it has no peak")
        return float(history["time_s"][np.nanargmax(load)])
    return _time_of_strain(at, history)


def _time_of_strain(at: float, history: np.ndarray) -> float:
    if isinstance(at, bool | np.bool_) or not isinstance(at, int | float | np.integer | np.floating):
        raise refuse("at", at, f"one of {', '.join(NAMES)}, or a strain")
    strain = history["axial_strain"]
    if not np.isfinite(strain).any():
        raise SceneError("no strain was recorded in this run; ask for a moment by its name")
    low, high = min(0.0, float(np.nanmin(strain))), max(0.0, float(np.nanmax(strain)))
    slack = 1e-3 * (high - low)
    if not low - slack <= at <= high + slack:
        raise refuse("at", at, f"a strain that the run had, {low:.4g} to {high:.4g}", "0.001 is 0.1 %")
    return float(history["time_s"][np.nanargmin(np.abs(strain - at))])
