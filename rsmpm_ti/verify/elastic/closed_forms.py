"""Elastic stress fields in closed form. NumPy only; tension positive, lengths in any one unit, angles in radians."""

import math

import numpy as np

ATKINSON_I = (1.135551, 0.533477, 0.391640, 0.393835, 0.325033)
"""T_i of the cracked disc with a/R = 0.3.  Atkinson, Smelser & Sanchez (1982), Int. J. Fract. 18:279."""

ATKINSON_II = (1.089702, 0.522272, 0.386086, 0.387518, 0.320834)
"""S_i, likewise."""

CRACK_SHARE = 0.3
"""a/R for which those hold."""


def hondros(arc: float, fraction: np.ndarray, loaded: bool) -> tuple[np.ndarray, np.ndarray]:
    """(s_xx, s_yy) over s0 = P/(pi R B) on a diameter of a disc pressed along y by uniform radial pressure.

    arc: half-angle of the two pressed arcs; share: distance from the centre over R; loaded: on the diameter along y,
    else on the one along x.  Hondros (1959), Austral. J. Appl. Sci. 10:243: the tangential and radial stresses of his
    closed forms for the two diameters, with p = P/(2 arc R B).
    """
    q, sign = fraction**2, -1.0 if loaded else 1.0
    a = (1.0 - q) * math.sin(2.0 * arc) / (1.0 + sign * 2.0 * q * math.cos(2.0 * arc) + q**2)
    b = np.arctan2((1.0 - sign * q) * math.tan(arc), 1.0 + sign * q)
    return (a - b) / arc, -(a + b) / arc


def pressed_disc(x: np.ndarray, radius: float, offsets: np.ndarray, forces: np.ndarray) -> np.ndarray:
    """Stress [n, 2, 2] in a disc about the origin, squeezed along y by pairs of opposite forces per thickness.

    Pair i presses inward on both ends of the chord at x = offsets[i].  Each force makes Flamant's radial stress
    -2 F cos(theta)/(pi r); two of them leave on the rim a uniform pressure, which an isotropic tension of
    F h/(pi R^2), h the half chord, removes.  Timoshenko & Goodier (1970), Theory of Elasticity, sec. 41.
    """
    sigma = np.zeros((len(x), 2, 2))
    for offset, force in zip(offsets, forces, strict=True):
        half = math.sqrt(radius**2 - offset**2)
        for end in (-half, half):
            d = x - np.array([offset, end])
            r2 = np.sum(d**2, axis=1)
            depth = -np.sign(end) * d[:, 1]
            sigma -= (2.0 * force / math.pi * depth / r2**2)[:, None, None] * d[:, :, None] * d[:, None, :]
        sigma += force * half / (math.pi * radius**2) * np.eye(2)
    return sigma


def kirsch(x: np.ndarray, radius: float) -> np.ndarray:
    """Stress [n, 2, 2] over s around a hole about the origin of an infinite plate that s pulls along y.

    Kirsch (1898), Z. VDI 42:797; Timoshenko & Goodier (1970), eq. 61, with theta from the axis of the load.
    """
    r, t = np.hypot(x[:, 0], x[:, 1]), np.arctan2(x[:, 0], x[:, 1])
    q = (radius / r) ** 2
    rr = 0.5 * (1.0 - q) + 0.5 * (1.0 - 4.0 * q + 3.0 * q**2) * np.cos(2.0 * t)
    tt = 0.5 * (1.0 + q) - 0.5 * (1.0 + 3.0 * q**2) * np.cos(2.0 * t)
    rt = -0.5 * (1.0 + 2.0 * q - 3.0 * q**2) * np.sin(2.0 * t)
    radial, tangent = x / r[:, None], np.stack([np.cos(t), -np.sin(t)], axis=1)
    cross = radial[:, :, None] * tangent[:, None, :]
    return (
        rr[:, None, None] * radial[:, :, None] * radial[:, None, :]
        + tt[:, None, None] * tangent[:, :, None] * tangent[:, None, :]
        + rt[:, None, None] * (cross + np.swapaxes(cross, 1, 2))
    )


def williams(order: int, r: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Terms r^(order/2 - 1) of modes I and II of the stress about a crack tip; each (s_xx, s_yy, s_xy), [3, n].

    The crack lies along t = pi; order 1: K_I = sqrt(2 pi) and K_II = -sqrt(2 pi); order 2, mode I: T = 4.
    Williams (1957), J. Appl. Mech. 24:109, in the form of Ayatollahi & Nejati (2011), Fatigue Fract. Engng Mater.
    Struct. 34:159, eq. 1. Order 0, which the form leaves out, is a force at the tip: a radial stress cos(t)/r along
    the crack, sin(t)/r across it (Michell's wedge of half a turn either side).
    """
    h, even, c, s = 0.5 * order, (-1.0) ** order, np.cos, np.sin
    if order == 0:
        radial = np.stack([c(t) ** 2, s(t) ** 2, s(t) * c(t)]) / r
        return radial * c(t), radial * s(t)
    c_1, c_3, s_1, s_3 = c((h - 1.0) * t), c((h - 3.0) * t), s((h - 1.0) * t), s((h - 3.0) * t)
    one = (
        (2.0 + h + even) * c_1 - (h - 1.0) * c_3,
        (2.0 - h - even) * c_1 + (h - 1.0) * c_3,
        (h - 1.0) * s_3 - (h + even) * s_1,
    )
    two = (
        (2.0 + h - even) * s_1 - (h - 1.0) * s_3,
        (2.0 - h + even) * s_1 + (h - 1.0) * s_3,
        (h - even) * c_1 - (h - 1.0) * c_3,
    )
    size = h * r ** (h - 1.0)
    return size * np.stack(one), -size * np.stack(two)


def cracked_disc(theta: float) -> tuple[float, float]:
    """N_I, N_II of a central crack with a/R = CRACK_SHARE at theta to the line of two opposite point loads.

    K = N s0 sqrt(pi a), s0 = P/(pi R B).  The five-term form of Atkinson, Smelser & Sanchez (1982).
    """
    s2, c2 = math.sin(theta) ** 2, math.cos(theta) ** 2
    q = 1.0 - 2.0 * c2
    a = (
        1.0 - 4.0 * s2,
        8.0 * s2 * (1.0 - 4.0 * c2),
        -4.0 * s2 * (3.0 - 36.0 * c2 + 48.0 * c2**2),
        -16.0 * s2 * (-1.0 + 24.0 * c2 - 80.0 * c2**2 + 64.0 * c2**3),
        -20.0 * s2 * (1.0 - 40.0 * c2 + 240.0 * c2**2 - 448.0 * c2**3 + 256.0 * c2**4),
    )
    b = (
        1.0,
        -5.0 + 8.0 * c2,
        -3.0 + 8.0 * q * (2.0 - 3.0 * c2),
        3.0 + 16.0 * q - 12.0 * q**2 - 32.0 * q**3,
        5.0 - 16.0 * q - 60.0 * q**2 + 32.0 * q**3 + 80.0 * q**4,
    )
    powers = CRACK_SHARE ** (2.0 * np.arange(5))
    return float(np.dot(ATKINSON_I, powers * a)), float(2.0 * math.sin(2.0 * theta) * np.dot(ATKINSON_II, powers * b))
