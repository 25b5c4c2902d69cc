"""Shape functions: what a particle and a background node mean to each other.

Each is a tensor product of one function of distance; `weights` and `gradients` return a [width, dim] matrix, one
column per axis, for the nodes base, base + 1, ... with local coordinate r = x/dx - base. All reproduce linear fields.
At a wall (a plane of nodes that a platen holds) `fold_at_walls` keeps that true without nodes beyond the wall.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Remedy, checked


@ti.data_oriented
@checked("shape")
@dataclass(frozen=True, kw_only=True)
class Linear:
    """Linear hat, support dx.  Sulsky, Chen & Schreyer (1994), eq. 20."""

    width = 2  # nodes per axis
    shift = 0.0  # base node = floor(x/dx - shift)
    stable_cfl = 1.37  # smallest limit of musl/usf with free edges at any offset, in units of dx/c_p
    affine_cfl = 0.8  # the same with an affine transfer while no particle crosses; then none holds
    crack_band = 1.0  # width of the band that a crack opens over [cells]
    overhang = 0.0  # integral of the function beyond one cell on one side [cells]
    variance = 1.0 / 6.0  # second moment of the function [cells^2]

    @ti.func
    def weights(self, r):
        return ti.Matrix.rows([1.0 - r, r])

    @ti.func
    def gradients(self, r):
        return ti.Matrix.rows([0.0 * r - 1.0, 0.0 * r + 1.0])

    def profile(self, d: np.ndarray) -> np.ndarray:
        """The function itself against distance in cells, in NumPy: for checks made before anything compiles."""
        return np.maximum(1.0 - np.abs(d), 0.0)


@ti.data_oriented
@checked("shape")
@dataclass(frozen=True, kw_only=True)
class Gimp:
    """uGIMP: the hat averaged over a particle of fixed half-width [cells].  Bardenhagen & Kober (2004), eq. 35.

    Good value: 1/(2 x particles per axis), so that particle domains tile the body.
    """

    half_width: Annotated[float, Interval(gt=0.0, le=0.5), Remedy("use 0.25 for 2 particles per axis")] = 0.25

    width = 3
    shift = 0.5
    stable_cfl = 1.65
    affine_cfl = 0.85
    crack_band = 1.5

    @ti.func
    def weights(self, r):
        return ti.Matrix.rows([self.value(r), self.value(r - 1.0), self.value(r - 2.0)])

    @ti.func
    def gradients(self, r):
        return ti.Matrix.rows([self.slope(r), self.slope(r - 1.0), self.slope(r - 2.0)])

    @property
    def variance(self) -> float:
        return 1.0 / 6.0 + self.half_width**2 / 3.0

    @property
    def overhang(self) -> float:
        return self.half_width**2 / 12.0

    @ti.func
    def value(self, r):
        d, l = abs(r), self.half_width
        outer = ti.max(1.0 + l - d, 0.0)
        near = 1.0 - (d * d + l * l) / (2.0 * l)
        return ti.select(d < l, near, ti.select(d < 1.0 - l, 1.0 - d, outer * outer / (4.0 * l)))

    @ti.func
    def slope(self, r):
        d, l = abs(r), self.half_width
        sign = ti.select(r < 0.0, -1.0, 1.0)
        outer = ti.max(1.0 + l - d, 0.0)
        return ti.select(d < l, -r / l, ti.select(d < 1.0 - l, -sign, -sign * outer / (2.0 * l)))

    def profile(self, d: np.ndarray) -> np.ndarray:
        d, l = np.abs(d), self.half_width
        far = np.maximum(1.0 + l - d, 0.0) ** 2 / (4.0 * l)
        return np.where(d < l, 1.0 - (d**2 + l**2) / (2.0 * l), np.where(d < 1.0 - l, 1.0 - d, far))


@ti.data_oriented
@checked("shape")
@dataclass(frozen=True, kw_only=True)
class QuadraticBSpline:
    """Quadratic B-spline, support 1.5 dx.  Steffen, Kirby & Berzins (2008), eq. 14."""

    width = 3
    shift = 0.5
    stable_cfl = 1.7
    affine_cfl = 1.2
    crack_band = 2.0
    overhang = 1.0 / 48.0
    variance = 0.25

    @ti.func
    def weights(self, r):
        return ti.Matrix.rows([0.5 * (1.5 - r) ** 2, 0.75 - (r - 1.0) ** 2, 0.5 * (r - 0.5) ** 2])

    @ti.func
    def gradients(self, r):
        return ti.Matrix.rows([r - 1.5, -2.0 * (r - 1.0), r - 0.5])

    def profile(self, d: np.ndarray) -> np.ndarray:
        d = np.abs(d)
        return np.where(d < 0.5, 0.75 - d**2, 0.5 * np.maximum(1.5 - d, 0.0) ** 2)


@ti.func
def fold_at_walls(w: ti.template(), base, lower: ti.template(), upper: ti.template()):
    """Give the node one beyond a wall to the two inside it: w_0 += 2 w_-1, w_1 -= w_-1, so v_-1 = 2 v_0 - v_1.

    Partition of unity and linear reproduction survive, and the wall's node alone decides the velocity at the wall:
    for the quadratic B-spline this is the boundary-modified function of Steffen, Kirby & Berzins (2008), sec. 3.4.
    Plain ones extend past a platen and break rock artificially beside it. `lower`, `upper`: wall node per axis.
    """
    folded = w
    if ti.static(w.n == 3):
        for d in ti.static(range(w.m)):
            if base[d] == lower[d] - 1:
                folded[1, d] += 2.0 * w[0, d]
                folded[2, d] -= w[0, d]
                folded[0, d] = 0.0
            if base[d] == upper[d] - 1:
                folded[1, d] += 2.0 * w[2, d]
                folded[0, d] -= w[2, d]
                folded[2, d] = 0.0
    return folded
