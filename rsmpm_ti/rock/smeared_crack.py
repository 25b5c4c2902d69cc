"""The law of cracked rock with a direction: no tension across the crack, friction on it, compression kept.

Smeared crack (Rots 1988): the strain of a failed particle is elastic strain plus opening of its crack and of a second
one at right angles, e = (e_n, e_t) >= 0, plus slip. Opening is kept for each direction, so that a crack carries
nothing until its faces meet again. In the frame of the crack (n across it, t along it) stress follows

    s_nn = a - M e_n - lam e_t,    s_tt = b - lam e_n - M e_t,    s_zz = c - lam_z (e_n + e_t),

where a, b, c are what the stresses would be if the cracks were shut.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import ByType, checked
from rsmpm_ti.rock.softening import Brittle, ExponentialSoftening, LinearSoftening
from rsmpm_ti.units import Angle

FRESH = 1e-12
"""Crack strain that marks a direction as cracked: with it a brittle law has no strength left, others have all."""

NO_DIRECTION = 1e-5
"""Radius of in-plane stress over tensile strength below which a rotating crack stays: round-off has no direction."""


SWEEPS = 4
"""Sweeps over the two openings; each leaves (lam/M)^2 of the error, 3 % for nu = 0.14 and 11 % for nu = 0.25."""


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Directional:
    """Release across the crack only; residual friction in shear; the stress along the crack stays.

    A particle that failed in tension has a crack with its normal along sigma_1 at failure: it carries no tension, or
    what softening leaves of it, across; compression when its faces have met; shear up to c' + |s_nn| tan(phi_r). If
    the rest of it reaches the Mohr-Coulomb criterion it fails in shear as well. One that failed in shear keeps
    Mohr-Coulomb with what is left of its cohesion and residual_friction_angle phi_r [degrees] on every plane, without
    dilation, and no tension. `rotating`: the crack turns with the principal stress, so that no shear acts on it;
    otherwise it is fixed in the rock and turns only with it.
    """

    residual_friction_angle: Annotated[Angle, Interval(ge=0.0, le=89.0)] = 30.0
    rotating: bool = False
    softening: Annotated[Brittle | LinearSoftening | ExponentialSoftening, ByType] = Brittle()

    directional = True

    @property
    def tan_residual(self) -> float:
        return math.tan(math.radians(self.residual_friction_angle))

    @property
    def sin_residual(self) -> float:
        return math.sin(math.radians(self.residual_friction_angle))

    @ti.func
    def opening(self, shut, tension, largest, modulus):
        """Crack strain of one direction from the stress `shut` that it would carry if the crack were shut.

        `tension` is what is left of its strength, `largest` the largest opening so far. Up to that the crack opens
        and closes along the secant; beyond it its stress is `tension`, of the step before: a step opens it little.
        """
        secant = shut * largest / ti.max(modulus * largest + tension, 1e-30)
        return ti.max(ti.min(secant, largest), (shut - tension) / modulus, 0.0)
