"""A lateral extensometer: how far the sides of the specimen have moved towards each other, across the load.

Its feet stand on the outermost particles of both sides, over the middle half of the height, where ends hold nothing
back. The displacement u of the feet is fitted by u_d = a + sum_e G_de X_e in their positions X at the start, and the
strain across axis d is -G_dd: exact for uniform strain, tilt and turning do not count, and two halves that part by w
show w over the width, as an extensometer around the specimen would.
"""

import numpy as np
import taichi as ti

from rsmpm_ti.fields.state import Simulation

MIDDLE = 0.5
"""Fraction of the extent along every other axis over which feet stand."""

GRIP = 0.25
"""Fraction of a side's feet that must stand on rock that has not begun to crack; with fewer nothing is read."""


@ti.kernel
def read_feet(
    sim: ti.template(),
    foot: ti.types.ndarray(dtype=ti.i32, ndim=1),
    u: ti.types.ndarray(dtype=ti.f64, ndim=2),
):
    """Displacement of the particles that are feet, by their number, where they are there and not cracked."""
    particles = sim.particles
    for p in particles.id:
        k = foot[particles.id[p]]
        sound = k >= 0 and particles.volume[p] != 0.0
        if ti.static(particles.breaks):
            sound = sound and particles.mode[p] == 0
        if sound:
            for d in ti.static(range(sim.dim)):
                u[k, d] = ti.cast(particles.u[p][d], ti.f64)


class Extensometer:
    """On the specimen of a simulation that has not begun; it reads nothing where there is no axis of the load."""

    def __init__(self, sim: Simulation):
        self._sim, cell = sim, sim.scene.loading.load_cell
        self._axes = () if cell is None else tuple(d for d in range(sim.dim) if d != cell.axis)
        reference, ids = sim.particles.reference.to_numpy().astype(np.float64), sim.particles.id.to_numpy()
        x = np.empty_like(reference)
        x[ids] = reference
        self._sides = [sides(x, axis, sim.scene.domain.dx) for axis in self._axes]
        feet = np.unique(np.concatenate([np.zeros(0, dtype=int), *(side for pair in self._sides for side in pair)]))
        self._x, self._sides = x[feet], [tuple(np.searchsorted(feet, side) for side in pair) for pair in self._sides]
        self._foot = np.full(len(x), -1, dtype=np.int32)
        self._foot[feet] = np.arange(len(feet))
        self._sound: np.ndarray | None = None  # which feet were, at the latest fit
        self._fits: list[np.ndarray | None] = []

    def read(self) -> tuple[float, ...]:
        """Strain across each lateral axis [1], compression positive; NaN where it is not known."""
        if not self._axes:
            return (np.nan,)
        u = np.full((len(self._x), self._sim.dim), np.nan)
        read_feet(self._sim, self._foot, u)
        sound = np.isfinite(u).all(axis=1)
        if not np.array_equal(self._sound, sound):
            pairs = zip(self._axes, self._sides, strict=True)
            self._sound, self._fits = sound, [weights(self._x, axis, *pair, sound) for axis, pair in pairs]
        fits = zip(self._axes, self._fits, strict=True)
        return tuple(np.nan if w is None else -float(w @ u[sound, axis]) for axis, w in fits)


def sides(x: np.ndarray, axis: int, dx: float) -> tuple[np.ndarray, np.ndarray]:
    """Rows of x [n, dim] that lie outermost along an axis, on its lower and its upper side, one in every strip of a
    cell's breadth dx [m] over the middle of the other axes; none where a strip is no wider than a cell."""
    others = [d for d in range(x.shape[1]) if d != axis]
    low, high = x.min(axis=0), x.max(axis=0)
    from_middle = np.abs(x - 0.5 * (low + high))[:, others]
    middle = np.flatnonzero((from_middle <= 0.5 * MIDDLE * (high - low)[others]).all(axis=1))
    strips = np.floor((x[middle][:, others] - low[others]) / dx).astype(int)
    _, strip = np.unique(strips, axis=0, return_inverse=True)
    order = np.lexsort((x[middle, axis], strip.ravel()))
    ends = np.flatnonzero(np.diff(strip.ravel()[order], prepend=-1, append=-1))
    first, last = middle[order[ends[:-1]]], middle[order[ends[1:] - 1]]
    wide = x[last, axis] - x[first, axis] > dx
    return first[wide], last[wide]


def weights(x: np.ndarray, axis: int, lower: np.ndarray, upper: np.ndarray, sound: np.ndarray) -> np.ndarray | None:
    """w of G_dd = w . u for the sound feet, of which those of the other axes have no weight; None where too few are
    left. x: positions of all feet [m], [n, dim]; lower, upper: rows of the feet on each side; sound: bool [n]."""
    if not all(len(side) and sound[side].mean() >= GRIP for side in (lower, upper)):
        return None
    used = np.intersect1d(np.concatenate([lower, upper]), np.flatnonzero(sound))
    centred = x[used] - x[used].mean(axis=0)
    scale = np.abs(centred).max()
    fit = np.linalg.pinv(np.column_stack([np.ones(len(used)), centred / scale]))
    if np.linalg.matrix_rank(fit) <= x.shape[1]:
        return None
    whole = np.zeros(len(x))
    whole[used] = fit[1 + axis] / scale
    return whole[sound]
