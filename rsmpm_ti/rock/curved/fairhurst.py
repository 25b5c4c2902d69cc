"""Fairhurst: a parabola that meets the tension cut-off without a corner, for hybrid fractures between both."""

import math
from dataclasses import dataclass
from typing import Annotated

import taichi as ti

from rsmpm_ti.checks import Positive, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import Pressure


@ti.data_oriented
@checked("criterion")
@dataclass(frozen=True, kw_only=True)
class Fairhurst:
    """Tension cut-off first, then a parabola of Mohr's plane that touches it, tau^2 = k (sigma_t - sigma_n).

    Fairhurst (1964), Int. J. Rock Mech. Min. Sci. 1:535, the generalised Griffith criterion; tension positive, so that
    sigma_n <= sigma_t. With the extremes of all three principal stresses, C = (sigma_1 + sigma_3)/2 and r =
    (sigma_1 - sigma_3)/2, a circle touches the parabola where

        r^2 = k (sigma_t - k/4 - C)    if    sigma_t - C >= k/2,

    and else the cut-off sigma_1 = sigma_t. k = sigma_t (m - 1)^2, m^2 = 1 + compressive_strength/tensile_strength, is
    such that the uniaxial compressive strength is the one given; Griffith's (1924) is that of 8 tensile_strength [Pa].
    Good for brittle rock from tension to about its compressive strength; beyond it the parabola is flatter than rock.
    A fracture by the parabola with sigma_n > 0 is a hybrid one; it is labelled shear. It is for the paper's laws after
    failure; `Directional` keeps Mohr-Coulomb's.
    """

    compressive_strength: Annotated[Pressure, Positive]
    tensile_strength: Annotated[Pressure, Positive]

    breaks = True

    def __post_init__(self):
        if not self.compressive_strength >= 3.0 * self.tensile_strength:
            raise refuse(
                "criterion.tensile_strength",
                self.tensile_strength,
                f"at most compressive_strength/3 = {self.compressive_strength / 3.0:.6g} Pa",
                "of rock it is about a tenth of it",
            )

    @property
    def ucs(self) -> float:
        return self.compressive_strength

    @property
    def k(self) -> float:
        """Of the parabola [Pa]."""
        return self.tensile_strength * (math.sqrt(1.0 + self.compressive_strength / self.tensile_strength) - 1.0) ** 2

    def strength(self, confinement: float) -> float:
        """Axial stress at failure under a lateral pressure, above -tensile_strength [Pa].

        r^2 = k (sigma_t - k/4 + p + r) for r, p the pressure. Where the circle meets the cut-off that has p =
        -sigma_t, and any axial stress up to the tangent.
        """
        k = self.k
        return confinement + k + 2.0 * math.sqrt(max(k * (self.tensile_strength + confinement), 0.0))

    @ti.func
    def _excess(self, sigma_1, sigma_3):
        """r^2 less that of the parabola [Pa^2]; negative where the cut-off is nearer."""
        k = ti.static(self.k)
        centre, r = 0.5 * (sigma_1 + sigma_3), 0.5 * (sigma_1 - sigma_3)
        reach = self.tensile_strength - centre
        return ti.select(reach >= 0.5 * k, r * r - k * (reach - 0.25 * k), -1.0)

    @ti.func
    def mode(self, sigma_1, sigma_3):
        """0 intact, 1 tension, 2 shear."""
        mode = 0
        if sigma_1 >= self.tensile_strength:
            mode = 1
        elif self._excess(sigma_1, sigma_3) >= 0.0:
            mode = 2
        return mode

    @ti.func
    def reached(self, sigma_1, sigma_3):
        """1 where `mode` is not 0, else 0; without branches."""
        shear = ti.select(self._excess(sigma_1, sigma_3) >= 0.0, 1, 0)
        return ti.select(sigma_1 >= self.tensile_strength, 1, shear)

    @ti.func
    def shear_load(self, sigma_1, sigma_3):
        """How near to the parabola: the factor f by which the stress divided would lie on it; 1 on it, less inside.

        r^2 + k C f = k (sigma_t - k/4) f^2, of its roots the one nearer to the whole rock's side; 0 on a ray that
        meets the cut-off instead.
        """
        k = ti.static(self.k)
        end = ti.static(self.tensile_strength - 0.25 * self.k)
        centre, r = 0.5 * (sigma_1 + sigma_3), 0.5 * (sigma_1 - sigma_3)
        root = k * k * centre * centre + 4.0 * r * r * k * end
        inverse = (-k * centre + ti.sqrt(ti.max(root, 0.0))) / ti.max(2.0 * r * r, 1e-30)  # 1/f
        meets = root >= 0.0 and inverse > 0.0 and self.tensile_strength - inverse * centre >= 0.5 * k
        return ti.select(meets, 1.0 / ti.max(inverse, 1e-30), 0.0)
