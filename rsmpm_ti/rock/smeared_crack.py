"""The law of cracked rock with a direction: no tension across the crack, friction on it, compression kept.

Smeared crack (Rots 1988): the strain of a failed particle is elastic strain plus opening of its crack and of a second
one at right angles, the crack strains e = (e_n, e_t) >= 0, plus slip. Crack strain is kept for each direction, so that
a crack carries nothing until its faces meet again. In the frame of the crack (n across it, t along it) stress follows

    s_nn = a - M e_n - lam e_t,    s_tt = b - lam e_n - M e_t,    s_zz = c - lam_z (e_n + e_t),

where a, b, c are what the stresses would be if the cracks were closed. The stress of a step: broken/crack_return.py,
and crushed_rock.py beside it for rock that has failed in shear.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import ByType, Positive, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.after_failure import AfterFailure, Variable
from rsmpm_ti.rock.broken.crack_return import (
    MIN_CRACK_STRAIN,
    crack_return,
    has_failed,
    spring_energy,
    strength_left,
)
from rsmpm_ti.rock.criteria import MohrCoulomb, strengths
from rsmpm_ti.rock.softening import Brittle, ExponentialSoftening, LinearSoftening
from rsmpm_ti.units import Angle, Length


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Directional(AfterFailure):
    """Release across the crack only; residual friction in shear; the stress along the crack stays.

    A particle that failed in tension has a crack with its normal along sigma_1 at failure: it carries no tension, or
    what softening leaves of it, across; compression when its faces have met; shear up to c' + |s_nn| tan(phi_r). If
    the rest of it reaches the Mohr-Coulomb criterion it fails in shear as well. One that failed in shear is crushed: it
    keeps Mohr-Coulomb with what is left of its cohesion and residual_friction_angle phi_r [degrees] on every plane, and
    no tension; what it is open by is pores, which must close before it bears pressure. While it slides with pores shut
    it dilates by `dilation_angle` [degrees], at most phi_r, which falls by e over a slip of `dilation_slip` [m].
    `rotating`: the crack turns with the principal stress, so that no shear acts on it; otherwise it is fixed in the
    rock and turns only with it.
    """

    residual_friction_angle: Annotated[Angle, Interval(ge=0.0, le=89.0)] = 30.0
    dilation_angle: Annotated[Angle, Interval(ge=0.0, le=89.0)] = 0.0
    dilation_slip: Annotated[Length, Positive] = 1e-3
    rotating: bool = False
    softening: Annotated[Brittle | LinearSoftening | ExponentialSoftening, ByType] = Brittle()

    history = (
        Variable(
            name="crack_normal",
            unit="1",
            per_axis=True,
            about="unit normal of the crack, 0 where there is none; turns with the rock",
        ),
        Variable(
            name="crack_strain",
            unit="1",
            per_axis=True,
            about="strain by opening, across the crack and along it; of crushed rock: by pores, and 0",
        ),
        Variable(name="crack_strain_max", unit="1", per_axis=True, about="the largest crack strains so far"),
        Variable(name="slip", unit="1", about="shear strain by slip, summed"),
        Variable(name="dissipated", unit="J/m^3", about="energy dissipated so far, per stress-free volume"),
        Variable(
            name="failed", unit="1", whole=True, about="mode by which it opened or slipped by half its strength, 0 none"
        ),
    )
    dimensions = (2,)
    oriented = True
    max_events = 2  # what failed in tension may fail in shear later

    def __post_init__(self):
        if self.dilation_angle > self.residual_friction_angle:
            allowed = f"at most residual_friction_angle = {self.residual_friction_angle:g} degrees"
            raise refuse("after_failure.dilation_angle", self.dilation_angle, allowed, "more would make energy")

    @property
    def softens(self) -> bool:
        return not isinstance(self.softening, Brittle)

    @property
    def tan_residual(self) -> float:
        return math.tan(math.radians(self.residual_friction_angle))

    @property
    def sin_residual(self) -> float:
        return math.sin(math.radians(self.residual_friction_angle))

    @ti.func
    def sin_dilation(self, slip, band):
        """Sine of the dilation angle that a slip [-] over a crack band [m] has left."""
        found = 0.0
        if ti.static(self.dilation_angle > 0.0):
            found = ti.static(math.sin(math.radians(self.dilation_angle))) * ti.exp(-slip * band / self.dilation_slip)
        return found

    def check(self, rock, shape, dx: float) -> None:
        """Refuse a criterion without cohesion, which slip takes, and a crack band that loses strength faster than the
        rock in it unloads: Bazant & Oh (1983), eq. 34."""
        if not isinstance(rock.criterion, MohrCoulomb):
            remedy = "its rock loses cohesion by slip; curved criteria go with CompressionOnly, Clipped and Void"
            raise refuse("rock.criterion", rock.criterion, "MohrCoulomb beside after_failure = Directional", remedy)
        if self.dilation_angle > 0.0 and rock.elasticity.plane_stress:
            raise refuse("after_failure.dilation_angle", self.dilation_angle, "0 in plane stress", "a plate bulges")
        pairs = (
            ("G_f_I", rock.criterion.tensile_strength, rock.elasticity.E),
            ("G_f_II", rock.criterion.cohesion, rock.elasticity.mu),
        )
        width = shape.crack_band * dx
        for name, strength, modulus in pairs:
            energy = getattr(self.softening, name)
            fall = self.softening.steepest(strength, energy) * width
            if not fall < modulus:
                remedy = f"use a dx below {modulus / fall * dx:.4g} m, or more energy"
                allowed = f"large enough that a crack band of {1e3 * width:.4g} mm does not snap back"
                raise refuse(f"after_failure.softening.{name}", energy, allowed, remedy)

    def aperture(self, history: dict[str, np.ndarray], band: float) -> np.ndarray:
        return band * history["crack_strain"].max(axis=1)

    @ti.func
    def crack_strain(self, closed, tension, largest, modulus):
        """Crack strain of one direction from the stress `closed` that it would carry if the crack were closed.

        `tension` is what is left of its strength, `largest` the largest crack strain so far. Up to that the crack opens
        and closes along the secant; beyond it its stress is `tension`, of the step before: a step opens it little.
        """
        secant = closed * largest / ti.max(modulus * largest + tension, 1e-30)
        return ti.max(ti.min(secant, largest), (closed - tension) / modulus, 0.0)

    @ti.func
    def begin(self, sim: ti.template(), p, mode, normal):
        """From now on the particle loses strength; nothing is lost yet."""
        h = sim.particles.history
        h.crack_normal[p] = normal
        if mode == 1:
            h.crack_strain_max[p] = ti.Vector([MIN_CRACK_STRAIN, 0.0])
            sim.rock.nonlocal_mean.begin_crack(sim, p, MIN_CRACK_STRAIN)
        else:
            h.slip[p] = ti.max(h.slip[p], MIN_CRACK_STRAIN)
            sim.rock.nonlocal_mean.begin_slip(sim, p, MIN_CRACK_STRAIN)
        return 0.0

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        sigma, dissipated = crack_return(sim, p, G)
        dissipated *= sim.rock.elasticity.solid_ratio(sigma)
        h = sim.particles.history
        h.dissipated[p] = h.dissipated[p] + dissipated
        mode = sim.particles.mode[p]
        if mode != h.failed[p] and has_failed(sim, p, mode):
            h.failed[p] = mode
        return sigma, dissipated

    @ti.func
    def stored(self, sim: ti.template(), p):
        energy = sim.rock.elasticity.energy(sim.particles.sigma[p]) + spring_energy(sim, p)
        return self.carrying_ratio(sim, p) * energy

    @ti.func
    def carrying_ratio(self, sim: ti.template(), p):
        """That of the solid: what cracks and pores are open by carries nothing."""
        particles = sim.particles
        solid = sim.rock.elasticity.solid_ratio(particles.sigma[p])
        return ti.select(particles.mode[p] == 0, particles.J[p], solid)

    @ti.func
    def damage(self, sim: ti.template(), p):
        """Where it has lost most: no more than of cohesion, since slip costs tensile strength too."""
        left, full = strength_left(sim, p), strengths(sim, p)
        return 1.0 - ti.min(left[0], left[1]) / full[0]

    @ti.func
    def failed_mode(self, sim: ti.template(), p):
        """At once without fracture energy; else when it has opened or slipped by what costs half of the strength."""
        return sim.particles.history.failed[p]

    @ti.func
    def released(self, sim: ti.template(), p, dissipated):
        return sim.particles.history.dissipated[p]
