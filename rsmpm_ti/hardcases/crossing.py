"""Particles that cross cells under stress, and velocities that the grid cannot see."""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_least, at_most, seen
from rsmpm_ti.hardcases.pieces import DX, NU, Piece, breaking, scene_of
from rsmpm_ti.hardcases.steps import block, breathing
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import MohrCoulomb

PEAK = 10e6
"""Largest tension of the balanced field [Pa]."""

TENSILE, COHESION, FRICTION = 2.0 * PEAK, 22e6, 40.0
"""Twice what the field needs: its worst point is at 50 % of the cut-off and 49 % of Mohr-Coulomb."""


def balanced_field(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Packed residual stress [..., 4] [Pa] in the square |x|, |y| < 1: no divergence, no traction on its edges.

    From Airy's function (x^2 - 1)^2 (y^2 - 1)^2, scaled to a tension of PEAK in the middle of each edge.
    """
    a, b = x**2 - 1.0, y**2 - 1.0
    xx, yy = a**2 * (12.0 * y**2 - 4.0), b**2 * (12.0 * x**2 - 4.0)
    return PEAK / 8.0 * np.stack([xx, yy, NU * (xx + yy), -16.0 * x * y * a * b], axis=-1)


LOOKS = 60


@dataclass(frozen=True)
class Carried:
    """Stress against what was carried, over its peak: root mean square and worst; particles that failed."""

    scatter: float
    worst: float
    failed: int


def translate(shape, transfer, cells: int, distance: float) -> Carried:
    """Carry a block of cells x cells with the balanced field `way` cells along x at 1 m/s and half of that along y."""
    room, half = math.ceil(distance) + 3, 0.5 * cells
    criterion = MohrCoulomb(cohesion=COHESION, friction_angle=FRICTION, tensile_strength=TENSILE)
    size = (cells + room + 3, cells + room + 3)
    scene = scene_of(size, (3, 3), (3 + cells,) * 2, rock=breaking(criterion), shape=shape, transfer=transfer)
    piece = Piece.of(scene)
    position = (piece.x - 3.0 - half) / half
    field = balanced_field(*position.T)
    piece.start(0.5, np.array([1.0, 0.5]), field)
    total = round(distance * DX / piece.clock.dt)
    misses = []
    for k in range(LOOKS):
        piece.drive.advance(total // LOOKS)
        if k * distance / LOOKS >= 1.0:  # the first particles have crossed
            misses.append(np.abs(piece.by_id("sigma") - field)[:, [0, 1, 3]].max(axis=1) / PEAK)
    return Carried(
        float(np.sqrt(np.mean(np.square(misses)))), float(np.max(misses)), int((piece.by_id("mode") > 0).sum())
    )


def cell_crossing(full: bool) -> Outcome:
    """1: a stressed block is carried over cells; what it carries in itself should not notice."""
    cells, distance, rows = (16, 3.0, []) if full else (8, 2.0, [])
    runs = [(QuadraticBSpline(), PicFlip())]
    if full:
        runs += [(Linear(), PicFlip()), (Gimp(), PicFlip()), (Linear(), PicFlip(flip=0.99))]
        runs += [(QuadraticBSpline(), PicFlip(flip=0.99)), (QuadraticBSpline(), Apic())]
    for shape, transfer in runs:
        carried, name = translate(shape, transfer, cells, distance), type(shape).__name__
        if isinstance(transfer, Apic) or transfer.flip < 1.0:
            name += ", Apic" if isinstance(transfer, Apic) else f", flip {transfer.flip:g}"
        if isinstance(shape, Linear):
            why = "its gradient jumps where a particle crosses, so the forces of a balanced stress do too"
            rows.append(seen(f"{name}: scatter of stress over its peak", carried.scatter, why))
            rows.append(seen(f"{name}: worst particle", carried.worst, why))
            rows.append(seen(f"{name}: particles failed at 50 % of strength", carried.failed, why))
        else:
            why = "smooth gradients: a few per cent, of which a part is the unevenness of 8 cells"
            rows.append(at_most(f"{name}: scatter of stress over its peak", carried.scatter, 0.06, why))
            rows.append(seen(f"{name}: worst particle", carried.worst, "a corner, where the field bends most"))
            why = "nothing reaches more than half of its strength"
            rows.append(at_most(f"{name}: particles failed at 50 % of strength", carried.failed, 0.0, why))
    return Outcome(tuple(rows))


def unseen(piece: Piece, size: float) -> np.ndarray:
    """Velocities [n, 2] of about `size` [m/s] that map to no node: a random field less what its nodes can represent."""
    x, profile = piece.x, piece.sim.shape.profile
    nodes = np.arange(math.floor(x.min()) - 2, math.ceil(x.max()) + 3)
    along = [profile(x[:, d, None] - nodes) for d in range(2)]
    weights = np.einsum("pi,pj->pij", *along).reshape(len(x), -1)
    field = size * np.random.default_rng(2).standard_normal(x.shape)
    return field - weights @ np.linalg.lstsq(weights, field, rcond=None)[0]


RINGING = 10_000
"""Steps of the null-space case."""


def _ring(piece: Piece, steps: int) -> tuple[float, float]:
    """Noise in a breathing block: fraction of it that is left, and change of stress by it over the largest stress."""
    motion = breathing(piece.x)
    noise = unseen(piece, np.abs(motion).max())
    piece.start(0.5, motion)
    piece.drive.advance(steps)
    v, sigma = piece.by_id("v"), piece.by_id("sigma")
    piece.start(0.5, motion + noise)
    piece.drive.advance(steps)
    left = np.linalg.norm(piece.by_id("v") - v) / np.linalg.norm(noise)
    leaked = np.abs(piece.by_id("sigma") - sigma).max() / np.abs(sigma).max()
    return left, leaked


def null_space(full: bool) -> Outcome:
    """2: velocities that no node sees: FLIP keeps them, anything else forgets them, and the grid never learns."""
    rows = []
    for name, transfer in (("FLIP", PicFlip()), ("1 % PIC", PicFlip(flip=0.99)), ("Apic", Apic()))[: 3 if full else 1]:
        left, leaked = _ring(Piece.of(block(transfer=transfer)), RINGING)
        if name == "FLIP":
            why = "nothing acts on it; the block moves by 1e-5 of its size, by which the grid sees it after all"
            rows.append(at_most("FLIP: change of the noise over itself", left - 1.0, 0.01, why))
            rows.append(at_least("FLIP: noise left over itself", left, 0.99, why))
        else:
            why = "0.99^10000 = 2e-44, and Apic takes velocity from nodes alone; what is left is round-off"
            rows.append(at_most(f"{name}: noise left over itself", left, 1e-6, why))
        why = "the block moves by 1e-5 of its size, and so much of the noise reaches the nodes, step by step"
        rows.append(at_most(f"{name}: change of the block's stress by the noise", leaked, 0.01, why))
    return Outcome(tuple(rows))


CASES = (
    Case("cell_crossing", "1: a stressed block carried over cells, by shape function", cell_crossing),
    Case("null_space", "2: velocities of particles that no node sees", null_space),
)
