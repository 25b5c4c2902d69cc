"""Moduli, Poisson's ratio and crack stresses, read from the curve of a compression test.

ISRM (1979), Suggested methods for determining the uniaxial compressive strength and deformability of rock materials,
Int. J. Rock Mech. Min. Sci. 16:135: tangent modulus at half of the strength, secant modulus to it, average modulus of
the straight part. Crack stresses by volumetric strain: Martin & Chandler (1994), Int. J. Rock Mech. Min. Sci. 31:643.

A plate in plane strain is stiffer than a cylinder. With q the stress added along the axis,

    e_1 = q (1 - nu^2)/E,    e_3 = -q nu (1 + nu)/E,

so slopes are E/(1 - nu^2) and -e_3/e_1 = nu/(1 - nu). E and nu here are those of the rock, with that taken out.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.load_curve import loading_curve

TANGENT = (0.4, 0.6)
"""Fractions of the peak between which the tangent at half of it is fitted."""

STRAIGHT = (0.2, 0.8)
"""The same of the average modulus: before cracks, and after what platens bed in."""

ELASTIC = (0.1, 0.35)
"""The same of the elastic volumetric strain: cracks begin at 0.4 of the peak or later (Martin & Chandler 1994)."""

NOTICED = 0.01
"""Crack volumetric strain over the elastic volumetric strain at the peak from which cracks are noticed, as a strain
gauge of a laboratory, accurate to a per cent, would."""


@dataclass(frozen=True, kw_only=True)
class Curve:
    """Up to its peak: stress added along the axis q [Pa], axial, lateral and volumetric strain, each [rows]."""

    q: np.ndarray
    axial: np.ndarray
    lateral: np.ndarray
    volumetric: np.ndarray
    plane_stress: bool

    @property
    def peak(self) -> float:
        return float(self.q.max())

    def _part(self, between: tuple[float, float]) -> np.ndarray:
        """Rows between two fractions of the peak."""
        return (self.q >= between[0] * self.peak) & (self.q <= between[1] * self.peak)

    def _slope(self, x: np.ndarray, y: np.ndarray, between: tuple[float, float]) -> float:
        rows = self._part(between) & np.isfinite(x) & np.isfinite(y)
        return float(np.polyfit(x[rows], y[rows], 1)[0]) if rows.sum() >= 3 else math.nan

    @property
    def nu(self) -> float:
        """Poisson's ratio over the straight part."""
        ratio = -self._slope(self.axial, self.lateral, STRAIGHT)
        return ratio if self.plane_stress else ratio / (1.0 + ratio)

    def _young(self, slope: float) -> float:
        return slope if self.plane_stress else slope * (1.0 - self.nu**2)

    @property
    def tangent(self) -> float:
        """Young's modulus by the tangent at half of the peak [Pa]."""
        return self._young(self._slope(self.axial, self.q, TANGENT))

    @property
    def average(self) -> float:
        """Young's modulus by the straight part [Pa]."""
        return self._young(self._slope(self.axial, self.q, STRAIGHT))

    @property
    def secant(self) -> float:
        """Young's modulus by the line from the start to half of the peak [Pa]."""
        half = 0.5 * self.peak
        return self._young(half / float(np.interp(half, self.q, self.axial)))

    def crack_strain(self) -> np.ndarray:
        """Volumetric strain that is not elastic, dilation negative, [rows]."""
        return self.volumetric - self.q / self._slope(self.volumetric, self.q, ELASTIC)

    def initiation(self) -> float:
        """Stress from which crack volumetric strain grows for good [Pa]; NaN where it never does before the peak."""
        crack = self.crack_strain()
        limit = NOTICED * abs(self.q[-1] / self._slope(self.volumetric, self.q, ELASTIC))
        quiet = np.flatnonzero(~(crack < -limit))
        return math.nan if not len(quiet) or quiet[-1] == len(crack) - 1 else float(self.q[quiet[-1]])

    def damage(self) -> float:
        """Stress at which the volumetric strain turns round [Pa]; NaN where it does not before the peak."""
        known = np.isfinite(self.volumetric)
        if not known.any():
            return math.nan
        turn = int(np.nanargmax(self.volumetric))
        return math.nan if turn >= np.flatnonzero(known)[-1] - 1 else float(self.q[turn])


def curve_of(history: np.ndarray, *, pressure: float, peak: float, plane_stress: bool) -> Curve:
    """From the start to the first row at or above the peak [Pa], the whole axial stress; pressure: of the jacket."""
    _, stress, axial = loading_curve(history)
    reached = np.flatnonzero(stress >= peak * (1.0 - 1e-9))
    rows = slice(0, (reached[0] if len(reached) else int(np.nanargmax(stress))) + 1)
    middle = [0.5 * (history[name] + np.concatenate([history[name][:1], history[name][:-1]])) for name in
              ("lateral_strain", "volumetric_strain")]  # fmt: skip
    return Curve(
        q=np.maximum.accumulate(stress[rows] - pressure), axial=axial[rows], lateral=middle[0][rows],
        volumetric=middle[1][rows], plane_stress=plane_stress,
    )  # fmt: skip
