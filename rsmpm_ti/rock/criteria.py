"""When rock fails: tension cut-off first, then Mohr-Coulomb. And what kernels ask of any criterion.

A criterion answers `mode`, `reached` and `shear_load` of the extreme principal stresses in kernels, and `breaks`,
`tensile_strength`, `ucs` and `strength(confinement)` outside of them. Others: `curved/`.
"""

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


@ti.func
def strength_factor(sim: ti.template(), p):
    """What multiplies a particle's cohesion and tensile strength: 1 in uniform rock."""
    k = 1.0
    if ti.static(sim.particles.varied):
        k = sim.particles.strength[p]
    return k


@ti.func
def tensile_strength(sim: ti.template(), p):
    """Of a particle's rock before it cracked [Pa]."""
    return sim.rock.criterion.tensile_strength * strength_factor(sim, p)


@ti.func
def strengths(sim: ti.template(), p):
    """Tensile strength and cohesion of a particle's rock before it cracked [Pa]."""
    k = strength_factor(sim, p)
    return ti.Vector([sim.rock.criterion.tensile_strength * k, sim.rock.criterion.cohesion * k])


@ti.func
def load_factors(sim: ti.template(), p, extremes):
    """Extreme principal stresses as the criterion sees them: dividing by k is multiplying both strengths by it."""
    return extremes / strength_factor(sim, p)


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
