"""The load on the specimen as a function of time, read from history rows. NumPy only."""

import math
from collections import deque

import numpy as np

from rsmpm_ti.records.history_table import PEAK_DROP, nominal_stress
from rsmpm_ti.spec.scene import Scene

FILTER_TRANSITS = 0.25
"""The load is filtered over so many wave transits of the specimen.

What lasts less is a wave in a part of it and no load on the whole. A running median passes a load that rises steadily,
and takes from a peak that breaks off at once half of its width: an eighth of a transit of loading, rho c v/8 for
platens that close at v, less than the wave rho c v that they themselves send."""

MIN_FILTER_ROWS = 3
"""The least that has a median other than a mean: it takes out what is in one row alone."""


def filter_rows(scene: Scene) -> int:
    """Rows, an odd number, over which the load of a scene is filtered."""
    loading, rows = scene.loading, 0.0
    if loading.ends is not None:
        interval = scene.dt * scene.row_steps
        rows = FILTER_TRANSITS * loading.height / scene.wave_speed / interval
    return max(MIN_FILTER_ROWS, 2 * math.floor(0.5 * rows) + 1)


class FilteredLoad:
    """The running median of a load, row by row: its largest so far, and how far it has fallen since.

    Sizes are without the confining pressure, which is there before the test begins. A value belongs to the middle of
    its rows, so the latest half of them has none yet.
    """

    def __init__(self, scene: Scene):
        self._rows, self.pressure = filter_rows(scene), scene.loading.confinement
        self._stress: deque[float] = deque(maxlen=self._rows)
        self._strain: deque[float] = deque(maxlen=self._rows)
        self.largest, self.now, self.least_since = 0.0, 0.0, 0.0  # sizes [Pa]
        self.peak, self.peak_strain = math.nan, math.nan  # whole stress, with its sign

    def see(self, stress: float, strain: float) -> None:
        """The next row: nominal stress [Pa] and strain."""
        self._stress.append(stress)
        self._strain.append(strain)
        if len(self._stress) < self._rows or not np.isfinite(self._stress).all():
            return
        median = float(np.median(self._stress))
        self.now = abs(median - self.pressure)
        self.least_since = min(self.least_since, self.now)
        if self.now > self.largest:
            self.largest = self.least_since = self.now
            self.peak, self.peak_strain = median, self._strain[len(self._strain) // 2]

    def see_all(self, history: np.ndarray) -> "FilteredLoad":
        """All rows of a history."""
        _, stress, strain = loading_curve(history)
        for row in zip(stress.tolist(), strain.tolist(), strict=True):
            self.see(*row)
        return self

    @property
    def fraction(self) -> float:
        """Of the largest so far that is there now; 1 before there is any."""
        return self.now / self.largest if self.largest > 0.0 else 1.0

    @property
    def passed(self) -> bool:
        """Whether the largest so far was a peak: the load has fallen after it."""
        return self.least_since < (1.0 - PEAK_DROP) * self.largest


def loading_curve(history: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Times [s], nominal stress (mean of both sides) [Pa] and strain [1], compression positive, each [rows].

    A row's stress is the mean since the row before, so it belongs to the middle of that interval; the times and strains
    returned are those of the middles.
    """
    time, strain = history["time_s"], history["axial_strain"]
    middle = time - 0.5 * np.diff(time, prepend=0.0)
    return middle, nominal_stress(history), strain - 0.5 * np.diff(strain, prepend=0.0)


def load_at(history: np.ndarray, time: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
    """Nominal stress [Pa] and strain [1] at times [s], shape [e], linear between rows; NaN where none is defined."""
    middle, stress, strain = loading_curve(history)
    out = []
    for value in (stress, strain):
        finite = np.isfinite(value)
        none = np.full(np.shape(time), np.nan)
        out.append(np.interp(time, middle[finite], value[finite]) if finite.any() else none)
    return out[0], out[1]
