"""Criteria made of a few measured strengths, which then are inputs and judge nothing."""

import numpy as np
from scipy.optimize import minimize_scalar

from rsmpm_ti.rock.curved.fairhurst import Fairhurst
from rsmpm_ti.validate.data.tables import Strength


def ends_and_middle(points: tuple[Strength, ...]) -> tuple[Strength, ...]:
    """Of the lowest, the highest and the middle pressure of the measured range, every repeat: one rule for all rocks.

    The middle one is that nearest to half of the range.
    """
    pressures = sorted({p.sigma_3 for p in points})
    half = 0.5 * (pressures[0] + pressures[-1])
    middle = min(pressures, key=lambda p: abs(p - half))
    return tuple(p for p in points if p.sigma_3 in (pressures[0], middle, pressures[-1]))


def mohr_coulomb(points: tuple[Strength, ...]) -> tuple[float, float]:
    """Cohesion [Pa] and friction angle [degrees] of the line through some strengths, by least squares: sigma_1 = UCS +
    N sigma_3, N = tan^2(45 + phi/2), UCS = 2 c sqrt(N) (Jaeger, Cook & Zimmerman 2007, sec. 4.5)."""
    slope, ucs = np.polyfit([p.sigma_3 for p in points], [p.sigma_1 for p in points], 1)
    return float(ucs / (2.0 * np.sqrt(slope))), float(np.degrees(2.0 * np.arctan(np.sqrt(slope))) - 90.0)


def hoek_brown(points: tuple[Strength, ...]) -> tuple[float, float]:
    """sigma_ci [Pa] and m_i of intact rock: (sigma_1 - sigma_3)^2 = m_i sigma_ci sigma_3 + sigma_ci^2 is a line in
    sigma_3, fitted by least squares (Hoek & Brown 1980, J. Geotech. Eng. Div. ASCE 106:1013)."""
    slope, intercept = np.polyfit([p.sigma_3 for p in points], [(p.sigma_1 - p.sigma_3) ** 2 for p in points], 1)
    strength = float(np.sqrt(intercept))
    return strength, float(slope) / strength


def fairhurst_strength(points: tuple[Strength, ...], tensile_strength: float) -> float:
    """Compressive strength [Pa] of Fairhurst's parabola with this tensile strength [Pa]: the least squares of sigma_1
    at the measured sigma_3."""

    def misfit(strength: float) -> float:
        criterion = Fairhurst(compressive_strength=strength, tensile_strength=tensile_strength)
        return sum((criterion.strength(p.sigma_3) - p.sigma_1) ** 2 for p in points)

    highest = 2.0 * max(p.sigma_1 for p in points)
    return float(minimize_scalar(misfit, bounds=(3.0 * tensile_strength, highest), method="bounded").x)
