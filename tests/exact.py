"""Closed forms that tests compare with. Nothing here imports the package; sources stand beside the formulas."""

import numpy as np


def lame(E: float, nu: float) -> tuple[float, float]:
    """(lambda, mu) [Pa]."""
    return E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))


def bulk_modulus(E: float, nu: float) -> float:
    return E / (3.0 * (1.0 - 2.0 * nu))


def plane_strain_modulus(E: float, nu: float) -> float:
    """Axial stress over axial strain of a specimen with free sides in plane strain [Pa]."""
    return E / (1.0 - nu**2)


def p_wave_speed(E: float, nu: float, density: float) -> float:
    """Dilatational wave speed, in 3D and in plane strain alike [m/s]."""
    return np.sqrt(E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu) * density))


def s_wave_speed(E: float, nu: float, density: float) -> float:
    return np.sqrt(E / (2.0 * (1.0 + nu) * density))


def flow_number(friction_angle: float) -> float:
    """N_phi = tan^2(45 + phi/2); friction_angle in degrees."""
    return np.tan(np.radians(45.0 + 0.5 * friction_angle)) ** 2


def uniaxial_strength(cohesion: float, friction_angle: float) -> float:
    """Mohr-Coulomb strength in uniaxial compression, 2 c sqrt(N_phi) [Pa]."""
    return 2.0 * cohesion * np.sqrt(flow_number(friction_angle))


def cone_apex(cohesion: float, friction_angle: float) -> float:
    """Largest isotropic tension of the Mohr-Coulomb cone, c cot(phi) [Pa]."""
    return cohesion / np.tan(np.radians(friction_angle))


def failure_factor(sigma_1, sigma_3, cohesion: float, friction_angle: float, tensile_strength: float):
    """(factor, by tension): by how much a stress state must be multiplied to fail; infinite where it never does.

    Tension sigma_1 >= sigma_t, else Mohr-Coulomb N_phi sigma_1 - sigma_3 >= UCS; tension positive.
    """
    drive = flow_number(friction_angle) * sigma_1 - sigma_3
    with np.errstate(divide="ignore"):
        tension = np.where(sigma_1 > 0.0, tensile_strength / np.maximum(sigma_1, 0.0), np.inf)
        shear = np.where(drive > 0.0, uniaxial_strength(cohesion, friction_angle) / np.maximum(drive, 0.0), np.inf)
    return np.minimum(tension, shear), tension <= shear


def hat(d):
    """Linear shape function and its slope against signed distance in cells: Sulsky, Chen & Schreyer (1994), eq. 20."""
    inside = np.abs(d) < 1.0
    return np.where(inside, 1.0 - np.abs(d), 0.0), np.where(inside, -np.sign(d), 0.0)


def averaged_hat(d, half_width: float):
    """The hat averaged over [d - l, d + l], from the hat's integral: Bardenhagen & Kober (2004), eq. 31-35."""

    def integral(s):
        s = np.clip(s, -1.0, 1.0)
        return np.where(s < 0.0, 0.5 * (1.0 + s) ** 2, 1.0 - 0.5 * (1.0 - s) ** 2)

    ends = d + half_width, d - half_width
    scale = 1.0 / (2.0 * half_width)
    return scale * (integral(ends[0]) - integral(ends[1])), scale * (hat(ends[0])[0] - hat(ends[1])[0])


def quadratic_spline(d):
    """Cardinal quadratic B-spline by the three-term recursion of de Boor, and its slope as a difference of hats."""
    value = (1.5 + d) / 2.0 * hat(d + 0.5)[0] + (1.5 - d) / 2.0 * hat(d - 0.5)[0]
    return value, hat(d + 0.5)[0] - hat(d - 0.5)[0]


SHAPES = {
    "Linear": lambda shape: hat,
    "Gimp": lambda shape: lambda d: averaged_hat(d, shape.half_width),
    "QuadraticBSpline": lambda shape: quadratic_spline,
}
"""Class name of a shape function -> its function of signed distance [cells], returning (value, slope)."""


def shape_function(shape):
    """The closed form of a shape object of the package."""
    name = type(shape).__name__
    assert name in SHAPES, f"give the closed form of the new shape function {name} in SHAPES of tests/exact.py"
    return SHAPES[name](shape)
