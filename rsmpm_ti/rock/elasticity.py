"""Elasticity of rock."""

from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Positive, Remedy, checked
from rsmpm_ti.rock.tensors import double_contraction, hughes_winget, isotropic, trace
from rsmpm_ti.units import Pressure


@ti.data_oriented
@checked("elasticity")
@dataclass(frozen=True, kw_only=True)
class Hooke:
    """Isotropic linear elasticity with objective rotation.  E [Pa], nu [-].

    `plane_stress` (2D only): the thickness strain is the one that keeps sigma_zz = 0, d_eps_zz = -nu/(1 - nu)
    (d_eps_xx + d_eps_yy); otherwise 2D is plane strain.

    sigma <- R sigma R^T + lambda tr(d_eps) 1 + 2 mu d_eps, R of Hughes & Winget (1980): the invariants of a spinning
    stressed particle stay constant, where the explicit Jaumann form grows them by exp(8 pi^2/n) per turn of n steps.
    """

    E: Annotated[Pressure, Positive]
    nu: Annotated[float, Interval(gt=-1.0, lt=0.5), Remedy("at 0.5 the wave speed is infinite; use 0.499")]
    plane_stress: bool = False

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
    def pore_stiffness(self) -> float:
        """Mean stress per volume given back by pores [Pa]: the bulk modulus; in a plate both are those of its plane."""
        return self.E / (2.0 * (1.0 - self.nu)) if self.plane_stress else self.bulk

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
        return rotated + self.load(d_eps)

    @ti.func
    def load(self, strain):
        """Packed stress of a packed strain; in plane stress whatever its thickness strain."""
        if ti.static(self.plane_stress):
            strain[2] = -self.nu / (1.0 - self.nu) * (strain[0] + strain[1])
        return isotropic(self.lam * trace(strain), strain.n) + 2.0 * self.mu * strain

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
    def solid_ratio(self, sigma):
        """Ratio by which a stress has changed the volume of the rock itself: exp(x), x its trace over 3 K, to which the
        rate form integrates. As a ratio of polynomials, right to x^5/720 and above 0 for any x, it runs as a vector.
        """
        x = trace(sigma) / (3.0 * self.bulk)
        even, odd = 12.0 + x * x, 6.0 * x
        return (even + odd) / (even - odd)

    @ti.func
    def energy(self, sigma):
        """Strain energy per volume [J/m^3]: sigma:sigma/(4 mu) - nu tr(sigma)^2/(2 E)."""
        return double_contraction(sigma, sigma) / (4.0 * self.mu) - self.nu * trace(sigma) ** 2 / (2.0 * self.E)
