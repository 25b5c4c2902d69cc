"""Hoek-Brown: strength that rises less and less with pressure, with a tension cut-off."""

import math
from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Positive, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import Pressure

NEWTON = 12
"""Steps to the load factor of a rock mass; each about doubles its digits, and the first guess is within a factor."""


@ti.data_oriented
@checked("criterion")
@dataclass(frozen=True, kw_only=True)
class HoekBrown:
    """Tension cut-off first, then Hoek-Brown, on the extremes of all three principal stresses.

    tension: sigma_1 >= sigma_t.  shear: sigma_1 - sigma_3 >= sigma_ci (s - m sigma_1/sigma_ci)^a, tension positive, for
    Hoek, Carranza-Torres & Corkum (2002), Proc. NARMS-TAC 1:267, eq. 2. intact_strength sigma_ci and tensile_strength
    [Pa]. Intact rock has m = m_i, s = 1, a = 0.5 (Hoek & Brown 1980, J. Geotech. Eng. Div. ASCE 106:1013); m_i is
    fitted to triaxial tests, since charts of it by rock type agree poorly with tests (Read & Richards 2011, 12th ISRM
    Congress, paper 139). A rock mass has m, s, a from its GSI: `rock_mass`. Fails where rock becomes ductile under
    pressure. It is for the paper's laws after failure; `Directional` keeps Mohr-Coulomb's.
    """

    intact_strength: Annotated[Pressure, Positive]
    m: Annotated[float, Interval(ge=1e-3, le=100.0)]
    s: Annotated[float, Interval(gt=0.0, le=1.0)] = 1.0
    a: Annotated[float, Interval(ge=0.5, le=0.7)] = 0.5
    tensile_strength: Annotated[Pressure, Positive]

    breaks = True

    def __post_init__(self):
        if self.tensile_strength > self.apex:
            raise refuse(
                "criterion.tensile_strength",
                self.tensile_strength,
                f"at most where the Hoek-Brown curve ends, s sigma_ci/m = {self.apex:.6g} Pa for intact_strength = "
                f"{self.intact_strength:g} Pa, m = {self.m:g} and s = {self.s:g}",
                "beyond it the cut-off would never govern",
            )

    @property
    def apex(self) -> float:
        """Tension at which the curve ends [Pa]."""
        return self.s * self.intact_strength / self.m

    @property
    def ucs(self) -> float:
        """Uniaxial compressive strength sigma_ci s^a [Pa]."""
        return self.intact_strength * self.s**self.a

    def strength(self, confinement: float) -> float:
        """Axial stress at failure under a lateral pressure, at least -s sigma_ci/m [Pa]."""
        inside = max(self.s + self.m * confinement / self.intact_strength, 0.0)
        return confinement + self.intact_strength * inside**self.a

    @ti.func
    def _difference(self, sigma_1):
        """sigma_1 - sigma_3 at failure [Pa]."""
        inside = ti.max(self.s - self.m / self.intact_strength * sigma_1, 0.0)
        difference = ti.sqrt(inside)
        if ti.static(self.a != 0.5):
            difference = ti.pow(inside, self.a)
        return self.intact_strength * difference

    @ti.func
    def mode(self, sigma_1, sigma_3):
        """0 intact, 1 tension, 2 shear."""
        mode = 0
        if sigma_1 >= self.tensile_strength:
            mode = 1
        elif sigma_1 - sigma_3 >= self._difference(sigma_1):
            mode = 2
        return mode

    @ti.func
    def reached(self, sigma_1, sigma_3):
        """1 where `mode` is not 0, else 0; without branches."""
        shear = ti.select(sigma_1 - sigma_3 >= self._difference(sigma_1), 1, 0)
        return ti.select(sigma_1 >= self.tensile_strength, 1, shear)

    @ti.func
    def shear_load(self, sigma_1, sigma_3):
        """How near to the curve: the factor f by which the stress divided would lie on it; 1 on it, less inside.

        With a = 1/2, q = sigma_1 - sigma_3 and t = m sigma_1/sigma_ci: (q/sigma_ci)^2 = s f^2 - t f. For other a
        Newton's method on (q/(sigma_ci f))^(1/a) = s - t/f, which is convex in 1/f.
        """
        q, t = (sigma_1 - sigma_3) / self.intact_strength, self.m / self.intact_strength * sigma_1
        load = (t + ti.sqrt(t * t + 4.0 * self.s * q * q)) / (2.0 * self.s)
        if ti.static(self.a != 0.5):
            # the larger of what makes the power twice either term: beyond the root, from where the steps only fall
            q = ti.max(q, 1e-9)
            x = ti.static((2.0 * self.s) ** self.a) / q
            deep = ti.pow(2.0 * ti.max(-t, 0.0), ti.static(self.a / (1.0 - self.a)))
            x = ti.max(x, deep / ti.pow(q, ti.static(1.0 / (1.0 - self.a))))
            for _ in range(NEWTON):
                power = ti.pow(q * x, ti.static(1.0 / self.a))
                x -= (power + t * x - self.s) / (ti.static(1.0 / self.a) * power / x + t)
            load = 1.0 / x
        return load


def rock_mass(*, GSI: float, m_i: float, D: float = 0.0) -> dict[str, float]:
    """m, s and a of a rock mass: geological strength index, m_i of its intact rock, disturbance D in [0, 1].

    Hoek, Carranza-Torres & Corkum (2002), eq. 3 to 5.
    """
    for name, value, least, most in (("GSI", GSI, 5.0, 100.0), ("m_i", m_i, 1.0, 50.0), ("D", D, 0.0, 1.0)):
        if not least <= value <= most:
            raise refuse(name, value, f"within [{least:g}, {most:g}]")
    return {
        "m": m_i * math.exp((GSI - 100.0) / (28.0 - 14.0 * D)),
        "s": math.exp((GSI - 100.0) / (9.0 - 3.0 * D)),
        "a": 0.5 + (math.exp(-GSI / 15.0) - math.exp(-20.0 / 3.0)) / 6.0,
    }
