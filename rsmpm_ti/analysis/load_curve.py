"""The load on the specimen as a function of time, read from history rows. NumPy only."""

import numpy as np

from rsmpm_ti.records.history_table import nominal_stress


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
