"""Artificial bulk viscosity, which smooths shocks over a few cells."""

from dataclasses import dataclass

import taichi as ti

from rsmpm_ti.checks import check_kinds
from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.tensors import isotropic

MOST_VISCOUS = 1e3
"""Largest constant of artificial viscosity; useful ones are about 1."""


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class BulkViscosity:
    """q = rho L^2 c1 d^2 - c2 rho L c d in compression (d = tr grad v < 0), added as -q to the normal stresses.

    von Neumann & Richtmyer (1950) with Landshoff's linear term; constants as in MPM3D. c1 multiplies L^2 directly.
    """

    c1: float = 1.5
    c2: float = 0.06

    def __post_init__(self):
        check_kinds("viscosity", self)
        for name in ("c1", "c2"):
            if not 0.0 <= getattr(self, name) <= MOST_VISCOUS:
                raise refuse(f"viscosity.{name}", getattr(self, name), f"in [0, {MOST_VISCOUS:g}]")

    acts = True

    @ti.func
    def pressure(self, rate, density, length, wave_speed):
        d = ti.min(rate, 0.0)
        return density * length * d * (self.c1 * length * d - self.c2 * wave_speed)

    @ti.func
    def update(self, sim: ti.template(), p, rate, dt):
        """Set the pressure of a step of dt [s], and return the energy that it took [J]. None in failed rock (paper,
        sec. 3.2)."""
        particles, J = sim.particles, sim.particles.J[p]
        q = self.pressure(rate, sim.density / J, sim.grid.dx, sim.wave_speed)
        if ti.static(particles.breaks):
            q = ti.select(particles.mode[p] == 0, q, 0.0)
        particles.q[p] = q
        return -dt * q * rate * particles.volume[p] * J

    @ti.func
    def stop(self, sim: ti.template(), p):
        """The particle has failed."""
        sim.particles.q[p] = 0.0

    @ti.func
    def added_to(self, sim: ti.template(), p, sigma):
        """A packed stress with the viscous one."""
        return sigma - isotropic(sim.particles.q[p], sigma.n)


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class NoViscosity:
    """No artificial viscosity: the particles then hold no field for it."""

    acts = False

    @ti.func
    def update(self, sim: ti.template(), p, rate, dt):
        return 0.0

    @ti.func
    def stop(self, sim: ti.template(), p):
        pass

    @ti.func
    def added_to(self, sim: ti.template(), p, sigma):
        return sigma
