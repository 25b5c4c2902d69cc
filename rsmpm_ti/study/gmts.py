"""Where, at which angle and at which load an open flaw cracks: the generalised maximum tangential stress criterion.

NumPy and SciPy only. Stress intensities are K = N s sqrt(pi a), T = T* s, in one unit of stress and one of length; s is
the nominal compressive stress of the cube or s0 = P/(pi R B) of the disc, a half the flaw's length. Angles in degrees.
"""

import math

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq, minimize_scalar

from rsmpm_ti.verify.elastic.closed_forms import cracked_disc

CUBE_SIF = np.array(
    (
        (0.0, -1.0583, 0.0, 1.073),
        (15.0, -0.9904, 0.2527, 0.939),
        (30.0, -0.8025, 0.4417, 0.568),
        (45.0, -0.5406, 0.5162, 0.054),
        (60.0, -0.2730, 0.4521, -0.469),
        (75.0, -0.0736, 0.2631, -0.857),
        (90.0, 0.0, 0.0, -1.0),
    )
)
"""Angle of the flaw from the platens, N_I, N_II, T* of an open crack of 15 mm in 50 x 100 mm, uniform end stress.

By complex potentials and boundary collocation: docs/references.md, section 7. Rigid platens change them by 0.0013 at
most. A crack along the load, 90 degrees, changes nothing.
"""

DISC_T = np.array(
    (
        (0.0, -4.566),
        (10.0, -4.115),
        (15.0, -3.592),
        (20.0, -2.928),
        (27.217, -1.826),
        (30.0, -1.384),
        (45.0, 0.829),
        (60.0, 2.404),
        (75.0, 3.275),
        (90.0, 3.547),
    )
)
"""Angle of the flaw from the line of the load, T* of a central crack with a/R = 0.3 in a disc: docs/references.md,
section 8."""

MIN_DISTANCE, MAX_DISTANCE = 1e-4, 1.0
"""A critical distance is looked for between these fractions of a."""


def even_spline(angle: np.ndarray, value: np.ndarray) -> CubicSpline:
    """Through values that are mirrored about both ends, 0 and 90 degrees."""
    return CubicSpline(angle, value, bc_type="clamped")


CUBE_I, CUBE_T = (even_spline(CUBE_SIF[:, 0], CUBE_SIF[:, k]) for k in (1, 3))
CUBE_II = CubicSpline(CUBE_SIF[:, 0], CUBE_SIF[:, 2], bc_type="natural")  # changes sign about both ends
DISC_T_STAR = even_spline(*DISC_T.T)


def sif_cube(angle: float) -> tuple[float, float, float]:
    """N_I, N_II, T* of a flaw at `angle` in [0, 90] from the platens, interpolated in CUBE_SIF."""
    return float(CUBE_I(angle)), float(CUBE_II(angle)), float(CUBE_T(angle))


def sif_disc(angle: float) -> tuple[float, float, float]:
    """N_I, N_II, T* of a flaw at `angle` in [0, 90] from the load: series of Atkinson et al. (1982), T* from DISC_T."""
    return *cracked_disc(math.radians(angle)), float(DISC_T_STAR(angle))


def tangential_stress(theta, K_I: float, K_II: float, T: float, r: float):
    """Stress across the ray at `theta` [rad] from an open crack's continuation, at distance r from its tip.

    s_tt = cos(t/2)^2 [K_I cos(t/2) - 3 K_II sin(t/2)] / sqrt(2 pi r) + T sin(t)^2.
    Williams (1957), J. Appl. Mech. 24:109; Smith, Ayatollahi & Pavier (2001), Fatigue Fract. Engng Mater. Struct.
    24:137, eq. 2, whose first two terms these are.
    """
    c, s = np.cos(0.5 * theta), np.sin(0.5 * theta)
    return c**2 * (K_I * c - 3.0 * K_II * s) / math.sqrt(2.0 * math.pi * r) + T * np.sin(theta) ** 2


def initiation(K_I: float, K_II: float, T: float, r_c: float) -> tuple[float, float]:
    """(angle [degrees], stress): direction of the largest tangential stress at r_c from the tip, and that stress.

    The angle is from the crack's continuation, in [0, 180], to the side that K_II opens; NaN where no direction is in
    tension, and for an r_c of NaN. Smith et al. (2001); with r_c -> 0 Erdogan & Sih (1963), J. Basic Eng. 85:519.
    """
    if math.isnan(r_c):
        return math.nan, math.nan
    theta = np.linspace(-math.pi, math.pi, 3601)
    stress = tangential_stress(theta, K_I, K_II, T, r_c)
    best, step = theta[stress.argmax()], theta[1] - theta[0]
    found = minimize_scalar(
        lambda t: -tangential_stress(t, K_I, K_II, T, r_c),
        bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9},
    )  # fmt: skip
    if -found.fun <= 1e-12 * np.abs(stress).max():  # pressed everywhere: the largest stress is the free face's nought
        return math.nan, 0.0
    return abs(math.degrees(found.x)), -float(found.fun)


def critical_distance(sif: tuple[float, float, float], a: float, factor: float) -> float:
    """r_c, in the unit of a, at which the largest tangential stress is `factor` times the nominal stress.

    sif: N_I, N_II, T*. NaN unless that stress falls from above `factor` to below it between MIN_DISTANCE and
    MAX_DISTANCE, in a.
    """

    def excess(fraction: float) -> float:
        return tip(sif, fraction)[1] - factor

    if not excess(MIN_DISTANCE) > 0.0 > excess(MAX_DISTANCE):
        return math.nan
    return a * brentq(excess, MIN_DISTANCE, MAX_DISTANCE, rtol=1e-10)


def tip(sif: tuple[float, float, float], fraction: float) -> tuple[float, float]:
    """`initiation` of a crack with sif = (N_I, N_II, T*), over the nominal stress, with r_c = share a."""
    return initiation(*(n * math.sqrt(math.pi) for n in sif[:2]), sif[2], fraction)


def inglis(position: float, fraction: float, load: float) -> float:
    """Stress along the face of an elliptic hole over the stress s that pulls an infinite plate.

    place: the point (a cos, b sin) of the face, share = b/a, load: angle between pull and major axis, [degrees].
    s_tt = s [sinh 2x + cos 2load - e^(2x) cos 2(load - place)]/(cosh 2x - cos 2place), tanh x = b/a.
    Inglis (1913), Trans. Inst. Naval Arch. 55:219, as in Jaeger, Cook & Zimmerman (2007), eq. 8.202.
    """
    x, e, b = math.atanh(fraction), math.radians(position), math.radians(load)
    top = math.sinh(2.0 * x) + math.cos(2.0 * b) - math.exp(2.0 * x) * math.cos(2.0 * (b - e))
    return top / (math.cosh(2.0 * x) - math.cos(2.0 * e))


def mid_face_cube(angle: float, fraction: float) -> float:
    """Stress along the flaw in the middle of its face over s: Inglis, so of an infinite plate; 1 at 0 degrees.

    share: width over length of the flaw. No mean over a length is taken: inwards of a flat flaw across the load it is
    s (1 - sin(t) + sin(t) cos(t)^2), tan(t) = depth/a, level at the face. Beside a slot it falls sooner.
    """
    return -inglis(90.0, fraction, 90.0 - angle)


def mid_face_disc(angle: float, fraction: float) -> float:
    """The same in the disc over s0, as if its centre's stress, 1 across the load and -3 along it, were everywhere."""
    return inglis(90.0, fraction, 90.0 - angle) - 3.0 * inglis(90.0, fraction, angle)
