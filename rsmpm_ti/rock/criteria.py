"""When rock fails: tension cut-off first, then Mohr-Coulomb."""

import math
from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Positive, Remedy, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import Angle, Pressure


@ti.data_oriented
@checked("criterion")
@dataclass(frozen=True, kw_only=True)
class MohrCoulomb:
    """Tension cut-off first, then Mohr-Coulomb, on the extremes of all three principal stresses (paper eq. 11, 12).

    tension: sigma_1 >= sigma_t.  shear: (sigma_1 - sigma_3)/2 + (sigma_1 + sigma_3)/2 sin(phi) >= c cos(phi).
    cohesion, tensile_strength [Pa]; friction_angle [degrees].
    """

    cohesion: Annotated[Pressure, Positive]
    friction_angle: Annotated[Angle, Interval(ge=0.0, le=89.0), Remedy("at 90 nothing breaks")]
    tensile_strength: Annotated[Pressure, Positive]

    breaks = True

    def __post_init__(self):
        if self.tensile_strength > self.apex:
            raise refuse(
                "criterion.tensile_strength",
                self.tensile_strength,
                f"at most the apex of the Mohr-Coulomb cone, c cot(phi) = {self.apex:.6g} Pa for cohesion = "
                f"{self.cohesion:g} Pa and friction_angle = {self.friction_angle:g} degrees",
                "beyond it the cut-off would never govern",
            )

    @property
    def sin_phi(self) -> float:
        return math.sin(math.radians(self.friction_angle))

    @property
    def c_cos_phi(self) -> float:
        return self.cohesion * math.cos(math.radians(self.friction_angle))

    @property
    def apex(self) -> float:
        return self.c_cos_phi / self.sin_phi if self.sin_phi > 0.0 else math.inf

    @property
    def ucs(self) -> float:
        """Uniaxial compressive strength 2 c cos(phi)/(1 - sin(phi)) [Pa]."""
        return 2.0 * self.c_cos_phi / (1.0 - self.sin_phi)

    def strength(self, confinement: float) -> float:
        """Axial stress at failure under a lateral pressure [Pa]: UCS + (1 + sin(phi))/(1 - sin(phi)) confinement."""
        return self.ucs + (1.0 + self.sin_phi) / (1.0 - self.sin_phi) * confinement

    @ti.func
    def mode(self, sigma_1, sigma_3):
        """0 intact, 1 tension, 2 shear."""
        mode = 0
        if sigma_1 >= self.tensile_strength:
            mode = 1
        elif 0.5 * (sigma_1 - sigma_3) + 0.5 * (sigma_1 + sigma_3) * self.sin_phi >= self.c_cos_phi:
            mode = 2
        return mode

    @ti.func
    def reached(self, sigma_1, sigma_3):
        """1 where `mode` is not 0, else 0; without branches."""
        shear = 0.5 * (sigma_1 - sigma_3) + 0.5 * (sigma_1 + sigma_3) * self.sin_phi
        return ti.select(sigma_1 >= self.tensile_strength, 1, ti.select(shear >= self.c_cos_phi, 1, 0))

    @ti.func
    def shear_load(self, sigma_1, sigma_3):
        """How near to Mohr-Coulomb: 1 on the envelope, less inside."""
        return (0.5 * (sigma_1 - sigma_3) + 0.5 * (sigma_1 + sigma_3) * self.sin_phi) / self.c_cos_phi


@ti.data_oriented
@checked("criterion")
@dataclass(frozen=True, kw_only=True)
class Unbreakable:
    """No failure: for verification against elastic solutions (`--elastic`)."""

    breaks = False

    @ti.func
    def mode(self, sigma_1, sigma_3):
        return 0

    @ti.func
    def reached(self, sigma_1, sigma_3):
        return 0
