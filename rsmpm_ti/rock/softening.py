"""How strength is lost while a crack opens or slips: at once, or over a fracture energy spread over a crack band.

A law gives the ratio of strength that is left after a crack strain. Crack band (Bazant & Oh 1983, Mater. Struct.
16:155): a band of width h opens by w = h x crack strain and must cost G_f per area of crack whatever h is, so the
softening branch is scaled by h. `strength` is the value at which softening starts [Pa], `energy` G_f [J/m^2].
"""

from dataclasses import dataclass
from typing import Annotated

import taichi as ti

from rsmpm_ti.checks import Positive, checked
from rsmpm_ti.units import FractureEnergy


@ti.data_oriented
@checked("softening")
@dataclass(frozen=True, kw_only=True)
class Brittle:
    """All strength is gone at failure: no fracture energy, so results follow the cell size (the paper's assumption)."""

    G_f_I = G_f_II = 0.0

    def steepest(self, strength: float, energy: float) -> float:
        """Largest loss of strength per crack opening [Pa/m]; it is what snap-back is checked against."""
        return 0.0

    @ti.func
    def ratio(self, strain, strength, energy, h):
        return ti.select(strain > 0.0, 0.0, 1.0)


@ti.data_oriented
@checked("softening")
@dataclass(frozen=True, kw_only=True)
class LinearSoftening:
    """Strength falls linearly with the opening: f (1 - w f/(2 G_f)); gone at w = 2 G_f/f.

    G_f_I: energy per crack area in tension; G_f_II: of cohesion lost in shear, friction not counted [J/m^2].
    """

    G_f_I: Annotated[FractureEnergy, Positive]
    G_f_II: Annotated[FractureEnergy, Positive]

    def steepest(self, strength: float, energy: float) -> float:
        return strength**2 / (2.0 * energy)

    @ti.func
    def ratio(self, strain, strength, energy, h):
        return ti.max(1.0 - 0.5 * strain * h * strength / energy, 0.0)


@ti.data_oriented
@checked("softening")
@dataclass(frozen=True, kw_only=True)
class ExponentialSoftening:
    """Strength falls as f exp(-w f/G_f): steep first, then a long tail, as measured on concrete and rock.

    G_f_I: energy per crack area in tension; G_f_II: of cohesion lost in shear, friction not counted [J/m^2].
    """

    G_f_I: Annotated[FractureEnergy, Positive]
    G_f_II: Annotated[FractureEnergy, Positive]

    def steepest(self, strength: float, energy: float) -> float:
        return strength**2 / energy

    @ti.func
    def ratio(self, strain, strength, energy, h):
        return ti.exp(-strain * h * strength / energy)
