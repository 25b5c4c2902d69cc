"""How strength varies from place to place: a factor for each particle, on cohesion and tensile strength. No Taichi.

A factor k leaves the friction angle and the elasticity as they are: the failure envelope of a particle is the rock's,
k times as large. Elastic stress therefore is that of the uniform rock until the first particle fails.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval

from rsmpm_ti.checks import Remedy, Seed, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import AreaOrVolume, Length

MODES = 1000
"""Random waves of a correlated field. Over seeds its covariance is exact; within one seed points far apart keep a
chance correlation of about 1/sqrt(2 MODES) = 0.02, and the kurtosis is 3/(2 MODES) below that of a normal number."""

SCALES = (1e-3, 1e3)
"""Smallest and largest scale of the factors; beyond them the strengths given are not those of the rock that is run."""

ROWS = 256
"""Particles whose waves are summed at a time: 2 MB, which a cache holds; twice as fast as 32 MB."""


@checked("heterogeneity")
@dataclass(frozen=True, kw_only=True)
class Uniform:
    """The same strength everywhere: particles then hold no field for it."""

    varies = False

    def factors(self, x: np.ndarray, volume: np.ndarray) -> np.ndarray:
        """Ones, [n]."""
        return np.ones(len(x))


@checked("heterogeneity")
@dataclass(frozen=True, kw_only=True)
class Weibull:
    """Weibull strengths that know the size of the particles: k = (V_ref/V)^(1/m) (-ln(1 - U))^(1/m), U in (0, 1).

    `shape` is the Weibull modulus m: 2 scatters widely, 20 is nearly uniform. A sample of volume V, which is as strong
    as its weakest part, survives the factor s with probability exp(-(V/V_ref) s^m), however many particles it is made
    of: Weibull (1939), IVA Handlingar 151; (1951), J. Appl. Mech. 18:293. So the rock's cohesion and tensile strength
    are the scale of the distribution in samples of `reference_volume` [m^dim; in 2D the area, per metre of thickness];
    the mean there is Gamma(1 + 1/m) of it, and both fall with size as (V_ref/V)^(1/m). `seed` fixes the draw.

    `correlation_length` l [m]: 0 draws every particle by itself. Otherwise U = Phi(g) with g a stationary Gaussian
    field of covariance exp(-(r/l)^2): a Gaussian copula (Nelsen 2006, An Introduction to Copulas, sec. 2.3), which
    keeps the distribution of each particle. g is a sum of random waves (Shinozuka & Deodatis 1991, Appl. Mech. Rev.
    44:191), so a function of place and seed that every mesh sees alike. Particles smaller than the volume over which
    the field is of a piece, V_c = integral of exp(-(r/l)^2) = pi^(dim/2) l^dim (Vanmarcke 1983, Random Fields), are no
    further samples of it: they take V_c in place of V, and refinement leaves their strength alone.

    When it fails: the scaling keeps the weakest link of a volume, not its mean. With l = 0 the mean factor grows as
    V^(-1/m) with refinement, and with it any strength that needs many particles to fail, such as the peak in
    compression; with l > 0 and V < V_c nothing does. The weakest of a correlated sample many V_c large follows the
    closed form only about: there is no exact one.
    Good values: m 3 to 15; V_ref the volume on which the strength was measured with l = 0, about V_c with l > 0.
    """

    shape: Annotated[float, Interval(ge=0.5, le=1000.0), Remedy("rock has a modulus of 3 to 15")]
    reference_volume: Annotated[AreaOrVolume, Interval(ge=1e-18, le=1e9)]
    seed: Seed = 1
    correlation_length: Length = 0.0

    varies = True

    def __post_init__(self):
        if not (self.correlation_length == 0.0 or 1e-9 <= self.correlation_length <= 1e9):
            raise refuse("heterogeneity.correlation_length", self.correlation_length, "0 or in [1e-9, 1e9] m")

    def factors(self, x: np.ndarray, volume: np.ndarray) -> np.ndarray:
        """Strength factor k of each particle, [n].  x: initial positions [m], [n, dim]; volume [m^dim], [n]."""
        from scipy.special import log_ndtr

        g = self._gaussian(x)
        # -ln(1 - Phi(g)) = -ln Phi(-g), which is exact far into both tails: never 0, never infinite
        return (-log_ndtr(-g) * self.reference_volume / self.weakest_of(volume, x.shape[1])) ** (1.0 / self.shape)

    def weakest_of(self, volume, dim: int):
        """Volume [m^dim] whose strength a particle of a volume has: correlation leaves no smaller one its own."""
        return np.maximum(volume, math.pi ** (0.5 * dim) * self.correlation_length**dim)

    def _gaussian(self, x: np.ndarray) -> np.ndarray:
        """Standard normal numbers, [n]: independent, or sqrt(2/N) sum_j cos(k_j x + phase_j).

        exp(-(r/l)^2) is the characteristic function of normal wave numbers of standard deviation sqrt(2)/l (Bochner).
        """
        random = np.random.default_rng(self.seed)
        if self.correlation_length == 0.0:
            return random.standard_normal(len(x))
        waves = random.normal(scale=math.sqrt(2.0) / self.correlation_length, size=(x.shape[1], MODES))
        phase = random.uniform(0.0, 2.0 * math.pi, MODES)
        sums = [np.cos(x[k : k + ROWS] @ waves + phase).sum(axis=1) for k in range(0, len(x), ROWS)]
        return math.sqrt(2.0 / MODES) * np.concatenate(sums)


def check_scale(heterogeneity, volume: float, dim: int) -> None:
    """Raises SceneError where particles of a volume [m^dim] would be stronger or weaker than any rock."""
    if not isinstance(heterogeneity, Weibull):
        return
    ratio = heterogeneity.reference_volume / heterogeneity.weakest_of(volume, dim)
    scale = float(ratio ** (1.0 / heterogeneity.shape))
    if not SCALES[0] <= scale <= SCALES[1]:
        allowed = f"such that the scale of strength is in [{SCALES[0]:g}, {SCALES[1]:g}], not {scale:.3g}"
        remedy = "it follows from reference_volume, shape, correlation_length and dx"
        raise refuse("heterogeneity.reference_volume", heterogeneity.reference_volume, allowed, remedy)
