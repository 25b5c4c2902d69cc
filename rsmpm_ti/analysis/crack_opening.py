"""Opening and slip of cracks: the jump of displacement across a path, from intact particles on both sides. 2D."""

import numpy as np
from scipy.spatial import cKDTree

INNER, OUTER = 1.5, 4.0
"""Particles between these distances from the path are used, in cells: nearer ones share nodes with the band and with
the other face, so the grid has smoothed the jump there."""

BREADTH = 2.0
"""And within this distance along it, in cells."""

MIN_PARTICLES = 6
"""A plane through fewer particles than this is no fit."""


def jumps(path: np.ndarray, intact: cKDTree, displacement: np.ndarray, dx: float) -> np.ndarray:
    """Opening and slip [m] at each point of a path [k, 2], shape [k, 2]; NaN where a side is missing.

    Opening is positive where the faces are apart, slip where the far face has moved to the right (dextral): neither
    depends on the sense in which the path runs.

    intact: places of intact particles [n, 2], in the same configuration as the path, their displacement [m], [n, 2];
    dx: cell size [m]. On each side u = a + b s + c t is fitted by least squares in the distances s across and t along
    the path, and the jump is the difference of the two a: the linear terms take out the elastic strain of the rock
    beside the crack. A parallel crack within `OUTER` cells counts in.
    """
    found = np.full((len(path), 2), np.nan)
    x = np.asarray(intact.data)
    tangent = np.gradient(path, axis=0)
    tangent /= np.maximum(np.linalg.norm(tangent, axis=1, keepdims=True), 1e-300)
    normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
    close = intact.query_ball_point(path, np.hypot(OUTER, BREADTH) * dx)
    for k, near in enumerate(close):
        d = x[near] - path[k]
        s, t = d @ normal[k], d @ tangent[k]
        used = (np.abs(t) <= BREADTH * dx) & (np.abs(s) >= INNER * dx) & (np.abs(s) <= OUTER * dx)
        s, t, u = s[used], t[used], displacement[near][used]
        sides = [_intercept(s[side], t[side], u[side], dx) for side in (s > 0.0, s < 0.0)]
        if sides[0] is not None and sides[1] is not None:
            jump = sides[0] - sides[1]
            found[k] = jump @ normal[k], jump @ tangent[k]
    return found


def _intercept(s: np.ndarray, t: np.ndarray, u: np.ndarray, dx: float) -> np.ndarray | None:
    """Displacement [2] of a plane through one side's particles, at the path; None for too few or too thin a side."""
    if len(s) < MIN_PARTICLES or np.ptp(s) < dx or np.ptp(t) < dx:
        return None
    plane = np.stack([np.ones_like(s), s / dx, t / dx], axis=1)
    return np.linalg.lstsq(plane, u, rcond=None)[0][0]
