"""Stress intensities and T of the tables in `study/gmts.py`, solved again by complex potentials and collocation.

docs/references.md, sections 7 and 8, has the derivation. NumPy only; nothing of the solver.
"""

import math

import numpy as np
import pytest

from rsmpm_ti.study.gmts import CUBE_SIF, DISC_T
from rsmpm_ti.verify.elastic.closed_forms import cracked_disc, pressed_disc

TERMS, POINTS = 20, 120
"""Terms of each series, and points on each side where tractions are asked for: twice as many change no digit here."""


def columns(z: np.ndarray, a: float) -> tuple[np.ndarray, np.ndarray]:
    """(s_xx + s_yy, s_yy - i s_xy) of every real unknown, [n, 4 TERMS]: real parts of c and d, then imaginary ones."""
    k = np.arange(TERMS)

    def series(z):
        s, z = (np.sqrt(z - a) * np.sqrt(z + a))[:, None], z[:, None]
        odd, even = z * s ** (2 * k - 1.0), z ** (2 * k)
        slopes = s ** (2 * k - 1.0) + (2 * k - 1.0) * z**2 * s ** (2 * k - 3.0), 2 * k * z ** np.maximum(2 * k - 1, 0)
        return np.hstack([odd, even]), np.hstack(slopes), np.hstack([odd, -even])

    (F, slope, _), (_, _, W) = series(z), series(z.conj())
    gap = (z - z.conj())[:, None]
    total = [4.0 * (unit * F).real for unit in (1.0, 1j)]
    lift = [unit * (F + W) + gap * (unit * slope).conj() for unit in (1.0, 1j)]
    return np.hstack(total), np.hstack(lift)


def traction(total: np.ndarray, lift: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """t_x + i t_y on a boundary with this normal (complex, [n, 1])."""
    yy, xy = lift.real, -lift.imag
    xx = total - yy
    return xx * normal.real + xy * normal.imag + 1j * (xy * normal.real + yy * normal.imag)


def solve(rows: np.ndarray, wanted: np.ndarray, a: float) -> tuple[float, float, float]:
    """(K_I, K_II over sqrt(pi a), regular part of T) of the series with these tractions, complex [n]."""
    matrix, right = np.vstack([rows.real, rows.imag]), np.concatenate([wanted.real, wanted.imag])
    size = np.maximum(np.linalg.norm(matrix, axis=0), 1e-13)
    found = np.linalg.lstsq(matrix / size, right, rcond=1e-14)[0] / size
    assert np.abs(matrix @ found - right).max() < 2e-3  # what is left of a traction of 1, in the corners
    c_0, d = found[0] + 1j * found[2 * TERMS], found[TERMS : 2 * TERMS]
    return 2.0 * c_0.real, -2.0 * c_0.imag, 4.0 * float(d @ a ** (2.0 * np.arange(TERMS)))


def plate(angle: float, a: float = 0.3, height: float = 2.0) -> tuple[float, float, float]:
    """A crack at `angle` [degrees] in a plate of half width 1, pressed along its height by 1."""
    turn = np.exp(-1j * math.radians(angle))  # the plate in the frame of the crack
    spread = np.cos(math.pi * (np.arange(POINTS) + 0.5) / POINTS)
    rows, wanted = [], []
    for points, normal, stress in ((1.0 + 1j * height * spread, 1.0, 0.0), (spread + 1j * height, 1j, -1.0)):
        rows.append(traction(*columns(points * turn, a), np.full((POINTS, 1), normal * turn)) / turn)
        wanted.append(np.full(POINTS, stress * normal))
    return solve(np.vstack(rows), np.concatenate(wanted), a)


def disc(angle: float, a: float = 0.3, degree: int = 10) -> tuple[float, float, float]:
    """A crack at `angle` [degrees] to the line of two point loads on a disc of radius 1; s0 = 1."""
    turn = np.exp(1j * (0.5 * math.pi - math.radians(angle)))  # the load lies along y

    def uncracked(z):
        position, axes = z * turn, np.array([[turn.real, turn.imag], [-turn.imag, turn.real]])
        sigma = pressed_disc(np.stack([position.real, position.imag], 1), 1.0, np.zeros(1), np.full(1, math.pi))
        return axes @ sigma @ axes.T

    x, power = a * np.cos(math.pi * (np.arange(60) + 0.5) / 60), 2 * np.arange(degree)
    sigma = uncracked(x.astype(complex))
    faces = sigma[:, 1, 1] - 1j * sigma[:, 0, 1]
    t = np.linalg.lstsq(((x[:, None] / a) ** power).astype(complex), faces, rcond=None)[0]
    z = np.exp(2j * math.pi * (np.arange(2 * POINTS) + 0.5) / (2 * POINTS))

    def polynomial(z):
        return (z[:, None] / a) ** power @ t

    slope = power * (z[:, None] / a) ** np.maximum(power - 1, 0) / a @ t
    total = -2.0 * polynomial(z).real
    lift = -0.5 * (polynomial(z) + polynomial(z.conj())) - 0.5 * (z - z.conj()) * slope.conj()
    rim = traction(*columns(z, a), z[:, None])
    mode_1, mode_2, regular = solve(rim, -traction(total, lift, z), a)
    tip = uncracked(np.array([a + 0j]))[0]
    return mode_1, mode_2, float(tip[0, 0] - tip[1, 1]) + regular


@pytest.mark.parametrize("row", CUBE_SIF, ids=lambda row: f"{row[0]:g}")
def test_table_of_the_cube_is_that_of_complex_potentials(row):
    """Four digits were kept of K and three after the point of T."""
    mode_1, mode_2, parallel = plate(row[0])
    assert (mode_1, abs(mode_2)) == pytest.approx(row[1:3], abs=6e-5)
    assert parallel == pytest.approx(row[3], abs=6e-4)


def test_the_method_gives_what_isida_published():
    """A crack of half the plate's width in tension, height twice the width: 1.187 (Isida 1971)."""
    assert -plate(0.0, a=0.5)[0] == pytest.approx(1.187, abs=1e-3)


@pytest.mark.parametrize("angle, parallel", DISC_T)
def test_table_of_the_disc_is_that_of_complex_potentials(angle, parallel):
    mode_1, mode_2, found = disc(angle)
    assert found == pytest.approx(parallel, abs=6e-4)
    # Atkinson's five terms are a truncated series: they are off by 0.07 % of the largest
    assert (mode_1, abs(mode_2)) == pytest.approx(cracked_disc(math.radians(angle)), abs=1e-3)
