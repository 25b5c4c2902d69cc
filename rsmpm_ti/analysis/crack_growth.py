"""How a crack lengthens: furthest distance from where it began against time, tip speed, and what bounds it."""

import numpy as np
from scipy.optimize import brentq

WINDOW = 20e-6
"""Tip speed is the growth over this time [s], times the scene's time_scale: particles fail one by one, so over shorter
times the speed would be that of single failures. At the Rayleigh speed of rock a crack grows 30 mm in it."""


def rayleigh_speed(shear_speed: float, wave_speed: float) -> float:
    """Speed of surface waves [m/s], the limit of a crack in tension (Freund 1990, sec. 7.4), from c_s and c_p [m/s].

    xi^3 - 8 xi^2 + 8 xi (3 - 2 k) - 16 (1 - k) = 0, xi = (c_R/c_s)^2, k = (c_s/c_p)^2 (Rayleigh 1885): the left side
    is negative at xi = 0 and 1 at xi = 1, and has one root between.
    """
    k = (shear_speed / wave_speed) ** 2
    xi = brentq(lambda xi: xi**3 - 8.0 * xi**2 + 8.0 * xi * (3.0 - 2.0 * k) - 16.0 * (1.0 - k), 0.0, 1.0, xtol=1e-15)
    return shear_speed * float(np.sqrt(xi))


def growth(time: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Length [m] at each failure, [e]: the furthest distance from the first failure so far.

    time [s], ascending, and distance within the band from the first failure [m], both [e].
    """
    # failures of one instant, which one step records in no physical order, all count from it
    last = np.searchsorted(time, time, side="right") - 1
    return np.maximum.accumulate(distance)[last]


def tip_speed(time: np.ndarray, length: np.ndarray, window: float) -> np.ndarray:
    """Growth over the `window` [s] that ends at each failure, over the window [m/s], [e]; before the first, length 0.

    A crack that runs into one that began elsewhere lengthens at a stroke; that is no speed of a tip, and may exceed
    the Rayleigh speed.
    """
    before = np.searchsorted(time, time - window, side="right") - 1
    return (length - np.where(before >= 0, length[np.maximum(before, 0)], 0.0)) / window
