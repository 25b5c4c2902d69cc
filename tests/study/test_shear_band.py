"""The direction of a shear band, from where rock failed in shear: bands drawn on purpose."""

import numpy as np
import pytest

from rsmpm_ti.study.shear_band import COULOMB, DILATION, FRICTION, WIDTH, arthur, bands, fullest_strip, roscoe

MM = 1e-3


def drawn_band(angle: float, middle: tuple[float, float], length: float, count: int, seed: int) -> np.ndarray:
    """`count` places scattered evenly over a band 3 mm wide, [count, 2] [m]."""
    random = np.random.default_rng(seed)
    along, across = random.uniform(-0.5, 0.5, (2, count)) * np.array([[length], [3.0 * MM]])
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    return np.array(middle) + np.stack([along * c - across * s, along * s + across * c], axis=1)


@pytest.mark.parametrize("angle", [40.0, 55.0, 65.0, 72.5])
def test_direction_of_a_band_is_found_among_branches_and_its_conjugate(angle):
    main = drawn_band(180.0 - angle, (20.0 * MM, 40.0 * MM), 60.0 * MM, 900, 1)
    conjugate = drawn_band(angle, (35.0 * MM, 30.0 * MM), 40.0 * MM, 500, 2)
    branch = drawn_band(90.0, (10.0 * MM, 70.0 * MM), 20.0 * MM, 150, 3)
    specks = np.random.default_rng(4).uniform((0.0, 0.0), (50.0 * MM, 100.0 * MM), (300, 2))
    x = np.concatenate([main, conjugate, branch, specks])
    first, second = bands(x)
    # a strip 4 mm wide holds all of a band 3 mm wide while it is within atan(1/60), atan(1/40) = 1.0, 1.4 degrees of it
    assert first.angle == pytest.approx(180.0 - angle, abs=1.5)
    assert second.angle == pytest.approx(angle, abs=2.0)
    assert first.inside[:900].mean() > 0.98 and second.inside[900:1400].mean() > 0.98
    assert first.inside.sum() > second.inside.sum()


def test_strip_lies_where_the_band_is():
    """Its middle line passes through the middle of the band: its place is that point's distance along the normal."""
    x = drawn_band(60.0, (30.0 * MM, 50.0 * MM), 60.0 * MM, 2000, 1)
    strip = fullest_strip(x, 20.0, 85.0)
    normal = np.array([-np.sin(np.radians(strip.angle)), np.cos(np.radians(strip.angle))])
    spare = 0.5 * (WIDTH - 3.0 * MM)  # the strip is wider than the band by this much on each side
    assert strip.position == pytest.approx(normal @ (30.0 * MM, 50.0 * MM), abs=2.0 * spare)


def critical_hardening(angle: float, psi: float) -> float:
    """Hardening modulus over mu below which rock may band at an angle from the horizontal under axial compression.

    Where the acoustic tensor of the flow is singular, (Q:D.n) A^-1 (n.D:P) - Q:D:P with flow P and normal Q of
    Mohr-Coulomb: Rudnicki & Rice (1975), J. Mech. Phys. Solids 23:371. E = 17 GPa, nu = 0.14.
    """
    mu, lam = 1.0, 2.0 * 0.14 / (1.0 - 2.0 * 0.14)

    def stiffness(e):
        return lam * np.trace(e) * np.eye(3) + 2.0 * mu * e

    flow, normal = (np.diag([0.5 * (1.0 + s), -0.5 * (1.0 - s), 0.0]) for s in np.sin(np.radians([psi, FRICTION])))
    n = np.array([-np.sin(np.radians(angle)), np.cos(np.radians(angle)), 0.0])
    acoustic = (lam + mu) * np.outer(n, n) + mu * np.eye(3)
    across = (stiffness(normal) @ n) @ np.linalg.solve(acoustic, stiffness(flow) @ n)
    return float(across - (normal * stiffness(flow)).sum())


@pytest.mark.parametrize("psi", DILATION)
def test_arthurs_angle_is_where_rock_bands_first_and_roscoes_and_coulombs_end_the_range(psi):
    angles = np.arange(roscoe(psi), COULOMB, 0.05)
    critical = np.array([critical_hardening(angle, psi) for angle in angles])
    assert critical_hardening(roscoe(psi), psi) == pytest.approx(0.0, abs=1e-12)
    assert critical_hardening(COULOMB, psi) == pytest.approx(0.0, abs=1e-12)
    assert (critical[1:] > 0.0).all() and abs(angles[critical.argmax()] - arthur(psi)) < 0.7
    # this rock softens from its first slip on, by c^2 h/(2 G_f_II) cos(phi) = 0.15 mu, h = 2 mm: it may band beyond
    assert critical_hardening(roscoe(psi) - 7.0, psi) > -0.15 and critical_hardening(COULOMB + 10.0, psi) > -0.15
