"""Nearly incompressible rock: stable, exact where strain is uniform, and how stiff bending becomes."""

import math
from dataclasses import replace

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative, seen
from rsmpm_ti.hardcases.pieces import DENSITY, DX, ELASTIC, E, Piece, scene_of
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.rock.elasticity import Hooke

BEAM = (32, 4)
"""Length and height of a free beam [cells]."""

BLOCK = (8, 8)
"""Of a block that is thick enough for particles whose B-splines see no node with rock on one side only [cells]."""

DEEP = {2: 1.0, 3: 2.5}
"""How far from the surface such particles lie, by the width of the shape function [cells]."""

SMALL = 1e-7
"""Displacement rates over the wave speed: small motion."""


def free_block(nu: float, shape, cells: tuple[int, int]) -> Piece:
    rock = replace(ELASTIC, elasticity=Hooke(E=E, nu=nu))
    size, upper = (cells[0] + 8, cells[1] + 8), (cells[0] + 4, cells[1] + 4)
    return Piece.of(scene_of(size, (4, 4), upper, rock=rock, shape=shape))


def _patch(piece: Piece, nu: float, cells: tuple[int, int]) -> float:
    """One step from an affine velocity field: error of the stress well inside the block over the stress."""
    gradient = SMALL * piece.sim.wave_speed / DX * np.array([[1.0, 0.4], [-0.2, -0.5]])
    half = np.array(cells) / 2
    position = piece.x - (4.0 + half)
    piece.start(0.5, DX * position @ gradient.T)
    piece.drive.advance(1)
    step = gradient * piece.clock.dt
    step = step @ np.linalg.inv(np.eye(2) + 0.5 * step)  # the increment referred to mid-step, Hughes & Winget (1980)
    strain = 0.5 * (step + step.T)
    lam, mu = E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))
    exact = np.array([*(lam * np.trace(strain) + 2.0 * mu * np.diag(strain)), 2.0 * mu * strain[0, 1]])
    inside = (np.abs(position) < half - DEEP[piece.sim.shape.width]).all(axis=1)
    return float(np.abs(piece.by_id("sigma")[inside][:, [0, 1, 3]] - exact).max() / np.abs(exact).max())


ROOT = 4.730041
"""k L of the first bending mode of a free beam: cos(kL) cosh(kL) = 1."""


def thin_beam(nu: float) -> float:
    """Frequency of the first bending mode by Euler and Bernoulli, in plane strain [1/s]."""
    speed = math.sqrt(E / (1.0 - nu**2) / DENSITY)
    return ROOT**2 / (2.0 * math.pi) * speed * BEAM[1] / (math.sqrt(12.0) * BEAM[0] ** 2 * DX)


def _bending(piece: Piece) -> tuple[float, float]:
    """(Frequency of the first bending mode [1/s], fraction of energy created over a period)."""
    x = (piece.x[:, 0] - 4.0) / BEAM[0]
    k = ROOT * x
    shape = (
        np.cosh(k)
        + np.cos(k)
        - (np.cosh(ROOT) - np.cos(ROOT)) / (np.sinh(ROOT) - np.sin(ROOT)) * (np.sinh(k) + np.sin(k))
    )
    piece.start(0.5, SMALL * piece.sim.wave_speed * np.stack([0.0 * shape, shape], axis=1))
    start, created, times, motion = piece.energy, 0.0, [0.0], [1.0]
    while motion[-1] > 0.0 or len(times) < 3:  # the velocity of the mode vanishes after a quarter of a period
        piece.drive.advance(20)
        times.append(piece.clock.time)
        motion.append(float(piece.by_id("v")[:, 1] @ shape))
        created = max(created, 1.0 - start / piece.energy)
    fraction = motion[-2] / (motion[-2] - motion[-1])
    return 0.25 / (times[-2] + fraction * (times[-1] - times[-2])), created


def nearly_incompressible(full: bool) -> Outcome:
    """5: nu up to 0.499, where volume resists a thousand times as much as shape."""
    rows: list[Row] = []
    for shape in (Linear(), QuadraticBSpline())[: 2 if full else 1]:
        for nu in (0.3, 0.45, 0.49, 0.499) if full else (0.499,):
            piece, name = free_block(nu, shape, BEAM), f"{type(shape).__name__}, nu {nu:g}"
            block, cells = (piece, BEAM) if shape.width == 2 else (free_block(nu, shape, BLOCK), BLOCK)
            why = "round-off of the strain, magnified by lambda/mu"
            rows.append(at_most(f"{name}: uniform strain, error of the stress", _patch(block, nu, cells), 1e-9, why))
            frequency, created = _bending(piece)
            why = "bending is slow against the step: its energy does not beat"
            rows.append(at_most(f"{name}: fraction of energy created in bending", created, 0.02, why))
            why = "a real beam of this height is a few per cent below thin-beam theory; what is above it is locking"
            rows.append(seen(f"{name}: bending frequency over thin-beam theory", frequency / thin_beam(nu), why))
            why = "c_p = 4980, 10578 and 33055 m/s"
            if nu in WAVE_SPEEDS:
                rows.append(relative(f"{name}: c_p [m/s]", WAVE_SPEEDS[nu], piece.sim.wave_speed, 1e-3, why))
    return Outcome(tuple(rows))


WAVE_SPEEDS = {0.45: 4980.0, 0.49: 10578.0, 0.499: 33055.0}
"""sqrt((lambda + 2 mu)/rho) [m/s]: docs/references.md, section 1."""

CASES = (Case("incompressible", "5: Poisson's ratio of 0.45, 0.49, 0.499", nearly_incompressible),)
