"""What rock does: elasticity, failure criteria, laws after failure, artificial viscosity.

Sign convention, stated once: tension positive, sigma is Cauchy stress [Pa], sigma_1 >= sigma_3. A pressure p is
compression positive. J = det F is tracked from the start of the run, so an opened crack carries nothing until its
faces meet again.
"""

import math
from dataclasses import dataclass

import taichi as ti

from rsmpm_ti.averaging import Local, Nonlocal
from rsmpm_ti.directional import Directional
from rsmpm_ti.errors import refuse
from rsmpm_ti.heterogeneity import Uniform, Weibull
from rsmpm_ti.kinds import LARGEST, check_kinds, check_positive
from rsmpm_ti.tensors import double_contraction, hughes_winget, isotropic, trace

MOST_VISCOUS = 1e3
"""Largest constant of artificial viscosity; useful ones are about 1."""


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Hooke:
    """Isotropic linear elasticity with objective rotation.  E [Pa], nu [-].

    `plane_stress` (2D only): the thickness strain is the one that keeps sigma_zz = 0, d_eps_zz = -nu/(1 - nu)
    (d_eps_xx + d_eps_yy); otherwise 2D is plane strain.

    sigma <- R sigma R^T + lambda tr(d_eps) 1 + 2 mu d_eps, R of Hughes & Winget (1980): the invariants of a spinning
    stressed particle stay constant, where the explicit Jaumann form grows them by exp(8 pi^2/n) per turn of n steps.
    """

    E: float
    nu: float
    plane_stress: bool = False

    def __post_init__(self):
        check_kinds("elasticity", self)
        check_positive("elasticity.E", self.E, "stiffness in Pa")
        if not -1.0 < self.nu < 0.5:
            raise refuse("elasticity.nu", self.nu, "in (-1, 0.5)", "at 0.5 the wave speed is infinite; use 0.499")

    @property
    def lam(self) -> float:
        return self.E * self.nu / ((1.0 + self.nu) * (1.0 - 2.0 * self.nu))

    @property
    def mu(self) -> float:
        return self.E / (2.0 * (1.0 + self.nu))

    @property
    def bulk(self) -> float:
        return self.E / (3.0 * (1.0 - 2.0 * self.nu))

    @property
    def crack_stiffness(self) -> tuple[float, float, float]:
        """Stress lost across a crack, along it and out of the plane per opening strain of the crack [Pa]."""
        if self.plane_stress:
            return self.p_wave_modulus, self.nu * self.p_wave_modulus, 0.0
        return self.p_wave_modulus, self.lam, self.lam

    @property
    def p_wave_modulus(self) -> float:
        """rho c^2 of the fastest wave [Pa]: lambda + 2 mu, or E/(1 - nu^2) in a plate that is free to thicken."""
        return self.E / (1.0 - self.nu**2) if self.plane_stress else self.lam + 2.0 * self.mu

    def uniaxial_modulus(self, dim: int) -> float:
        """Axial stress over axial strain of a free-sided specimen [Pa]: E/(1 - nu^2) in plane strain, else E."""
        return self.E / (1.0 - self.nu**2) if dim == 2 and not self.plane_stress else self.E

    def lateral_ratio(self, dim: int) -> float:
        """Lateral over axial strain of a free-sided specimen: nu/(1 - nu) in plane strain, else nu."""
        return self.nu / (1.0 - self.nu) if dim == 2 and not self.plane_stress else self.nu

    @ti.func
    def stress(self, sigma, G):
        """New packed stress from the step's displacement gradient G = dt grad v, dim x dim."""
        rotated, d_eps = hughes_winget(sigma, G)
        if ti.static(self.plane_stress):
            d_eps[2] = -self.nu / (1.0 - self.nu) * (d_eps[0] + d_eps[1])
        return rotated + isotropic(self.lam * trace(d_eps), sigma.n) + 2.0 * self.mu * d_eps

    @ti.func
    def volume_ratio(self, G):
        """Ratio by which the step changes a particle's volume: det(1 + G), and in plane stress the thickness ratio.

        That ratio is det(1 + G)^(-nu/(1 - nu)), reversible, as a crack that opens and closes needs.
        """
        ratio = (ti.Matrix.identity(float, G.n) + G).determinant()
        if ti.static(self.plane_stress):
            ratio = ratio ** ((1.0 - 2.0 * self.nu) / (1.0 - self.nu))
        return ratio

    @ti.func
    def energy(self, sigma):
        """Strain energy per volume [J/m^3]: sigma:sigma/(4 mu) - nu tr(sigma)^2/(2 E)."""
        return double_contraction(sigma, sigma) / (4.0 * self.mu) - self.nu * trace(sigma) ** 2 / (2.0 * self.E)


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class MohrCoulomb:
    """Tension cut-off first, then Mohr-Coulomb, on the extremes of all three principal stresses (paper eq. 11, 12).

    tension: sigma_1 >= sigma_t.  shear: (sigma_1 - sigma_3)/2 + (sigma_1 + sigma_3)/2 sin(phi) >= c cos(phi).
    cohesion, tensile_strength [Pa]; friction_angle [degrees].
    """

    cohesion: float
    friction_angle: float
    tensile_strength: float

    breaks = True

    def __post_init__(self):
        check_kinds("criterion", self)
        check_positive("criterion.cohesion", self.cohesion, "stress in Pa")
        check_positive("criterion.tensile_strength", self.tensile_strength, "stress in Pa")
        if not 0.0 <= self.friction_angle <= 89.0:
            raise refuse("criterion.friction_angle", self.friction_angle, "in [0, 89] degrees", "at 90 nothing breaks")
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


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class CompressionOnly:
    """Choice 1 of the paper, sec. 3.2: a failed particle is a fluid without tension, p = max(K (1 - J), 0)."""

    directional = False

    @ti.func
    def pressure(self, bulk, J):
        return ti.max(bulk * (1.0 - J), 0.0)


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Void:
    """Choice 2 of the paper, sec. 3.2: a failed particle carries nothing; only its mass stays."""

    directional = False

    @ti.func
    def pressure(self, bulk, J):
        return 0.0 * J


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Clipped:
    """Choice 3 of the paper, sec. 3.2: p = clip(K (1 - J), -tension_limit, compression_limit), both limits [Pa]."""

    tension_limit: float
    compression_limit: float

    directional = False

    def __post_init__(self):
        check_kinds("after_failure", self)
        for name in ("tension_limit", "compression_limit"):
            if not 0.0 <= getattr(self, name) <= LARGEST:
                raise refuse(f"after_failure.{name}", getattr(self, name), f"in [0, {LARGEST:g}] Pa")

    @ti.func
    def pressure(self, bulk, J):
        return ti.min(ti.max(bulk * (1.0 - J), -self.tension_limit), self.compression_limit)


@ti.func
def pressure_energy(p, bulk, J):
    """Energy stored by a pressure p(J) that is K (1 - J) up to a cap and the cap beyond it, per initial volume."""
    return p * (1.0 - J) - 0.5 * p * p / bulk


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


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class NoViscosity:
    """No artificial viscosity: the particles then hold no field for it."""

    acts = False


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Rock:
    """One rock: density [kg/m^3], the four laws it is made of, and how its strength varies from place to place."""

    density: float
    elasticity: Hooke
    criterion: MohrCoulomb | Unbreakable
    after_failure: CompressionOnly | Void | Clipped | Directional = CompressionOnly()
    viscosity: BulkViscosity | NoViscosity = BulkViscosity()
    averaging: Local | Nonlocal = Local()
    heterogeneity: Uniform | Weibull = Uniform()

    def __post_init__(self):
        check_kinds("rock", self)
        check_positive("rock.density", self.density, "density in kg/m^3")

    def wave_speed(self, time_scale: float = 1.0) -> float:
        """Speed of the fastest wave, c_p unless in plane stress [m/s], with the density scaled by time_scale^2."""
        return math.sqrt(self.elasticity.p_wave_modulus / self.density) / time_scale
