"""What rock that has failed still carries, by the three choices of the paper (sec. 3.2)."""

from dataclasses import dataclass
from typing import Annotated

import taichi as ti

from rsmpm_ti.checks import NotNegative, checked
from rsmpm_ti.units import Pressure


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class CompressionOnly:
    """Choice 1 of the paper, sec. 3.2: a failed particle is a fluid without tension, p = max(K (1 - J), 0)."""

    directional = False

    @ti.func
    def pressure(self, bulk, J):
        return ti.max(bulk * (1.0 - J), 0.0)


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Void:
    """Choice 2 of the paper, sec. 3.2: a failed particle carries nothing; only its mass stays."""

    directional = False

    @ti.func
    def pressure(self, bulk, J):
        return 0.0 * J


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Clipped:
    """Choice 3 of the paper, sec. 3.2: p = clip(K (1 - J), -tension_limit, compression_limit), both limits [Pa]."""

    tension_limit: Annotated[Pressure, NotNegative]
    compression_limit: Annotated[Pressure, NotNegative]

    directional = False

    @ti.func
    def pressure(self, bulk, J):
        return ti.min(ti.max(bulk * (1.0 - J), -self.tension_limit), self.compression_limit)


@ti.func
def pressure_energy(p, bulk, J):
    """Energy stored by a pressure p(J) that is K (1 - J) up to a cap and the cap beyond it, per initial volume."""
    return p * (1.0 - J) - 0.5 * p * p / bulk
