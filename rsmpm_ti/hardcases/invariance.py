"""What a run must not depend on: its mirror image, its units, its scale, and single precision."""

from dataclasses import replace

import numpy as np
import taichi as ti

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.cases.case import Case, Outcome, at_least, at_most
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.hardcases.pieces import C_P, DENSITY, DX, ELASTIC, NU, E, Piece, breaking, scene_of
from rsmpm_ti.hardcases.steps import block
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Schedule

MIDDLE = 6.5
"""Of the block of 5 x 5 cells, on both axes [cells]."""

IMAGES = {
    "mirrored": np.diag([-1.0, 1.0]),
    "half a turn": -np.eye(2),
    "quarter of a turn": np.array([[0, -1.0], [1, 0]]),
}
"""Maps that carry the block onto itself."""


def _twin(x: np.ndarray, image: np.ndarray) -> np.ndarray:
    """For each particle, the one that lies where its image does."""
    position = (x - MIDDLE) @ image.T + MIDDLE
    return np.argmin(np.linalg.norm(position[:, None] - x[None], axis=2), axis=1)


def _carried(sigma: np.ndarray, image: np.ndarray) -> np.ndarray:
    """Packed stresses [n, 4] as their image has them."""
    full = np.stack([sigma[:, [0, 3]], sigma[:, [3, 1]]], axis=1)
    turned = image @ full @ image.T
    return np.stack([turned[:, 0, 0], turned[:, 1, 1], sigma[:, 2], turned[:, 0, 1]], axis=1)


def symmetry(full: bool) -> Outcome:
    """16: a run and its mirror image, or turned: the same to round-off while elastic, the same failures after it."""
    piece = Piece.of(block(rock=breaking()))
    x, rows = piece.x, []
    noise = np.random.default_rng(5).standard_normal(x.shape)
    for size, phase in ((1e-6, "elastic"), (2e-4, "failing")):
        velocity = size * C_P * noise
        piece.start(0.5, velocity)
        piece.drive.advance(200)
        sigma, mode = piece.by_id("sigma"), piece.by_id("mode")
        for name, image in IMAGES.items():
            twin = _twin(x, image)
            turned = np.zeros_like(velocity)
            turned[twin] = velocity @ image.T
            piece.start(0.5, turned)
            piece.drive.advance(200)
            why = "node sums in another order: round-off of 200 steps"
            if phase == "elastic":
                off = np.abs(piece.by_id("sigma")[twin] - _carried(sigma, image)).max() / np.abs(sigma).max()
                rows.append(at_most(f"{name}, elastic: difference of stress", float(off), 1e-11, why))
            else:
                other = int(np.sum(piece.by_id("mode")[twin] != mode))
                why = "no principal stress is within round-off of its strength in these 200 steps"
                rows.append(at_most(f"{name}, failing: particles with another label", other, 0.0, why))
    rows.append(at_least("particles that fail", int((mode > 0).sum()), 10, "enough to compare"))
    return Outcome(tuple(rows))


SCALES = {
    "mm, ms, g": (1e3, 1e-6, 1e-6),
    "stress x 100": (1.0, 100.0, 1.0),
    "length x 1000": (1e3, 1.0, 1.0),
    "density / 10": (1.0, 1.0, 0.1),
}
"""Factors on the numbers of length, stress and density."""


def _scaled(length: float, stress: float, density: float) -> tuple[np.ndarray, np.ndarray]:
    """(displacement over the cell, stress over its factor) of a block after 200 steps from random velocities."""
    dx = length * DX
    rock = replace(ELASTIC, density=density * DENSITY, elasticity=Hooke(E=stress * E, nu=NU))
    domain = Domain(lower=(0.0, 0.0), upper=(14 * dx, 14 * dx), dx=dx)
    body = Body(region=Box(lower=(4 * dx, 4 * dx), upper=(9 * dx, 9 * dx)))
    scene = block(rock=rock, domain=domain, bodies=(body,), schedule=Schedule(t_end=LONGER * dx / rock.wave_speed()))
    drive = set_up(scene)
    particles = drive.sim.particles
    velocity = 1e-4 * np.random.default_rng(6).standard_normal((particles.count, 2))
    particles.v.from_numpy(scene.wave_speed * velocity)
    drive.advance(200)
    order = np.argsort(particles.id.to_numpy())
    return particles.u.to_numpy()[order] / dx, particles.sigma.to_numpy()[order] / stress


LONGER = 1e4
"""An end of the schedule that no run reaches, in dx/c_p."""


def scaling(full: bool) -> Outcome:
    """17: other units, other scales: the same numbers without dimension."""
    u, sigma = _scaled(1.0, 1.0, 1.0)
    why, rows = "round-off of 200 steps, and a factor of a thousand that differences cost", []
    for name, factors in list(SCALES.items())[: 4 if full else 1]:
        other_u, other_sigma = _scaled(*factors)
        off = max(np.abs(other_u - u).max() / np.abs(u).max(), np.abs(other_sigma - sigma).max() / np.abs(sigma).max())
        rows.append(at_most(f"{name}: difference of motion and stress", float(off), 1e-10, why))
    return Outcome(tuple(rows))


BAR, SPEED, STEPS = (2, 8), 5e-3, 100_000


def _pushed(precision: str) -> tuple[np.ndarray, np.ndarray]:
    """(displacement along the bar [n] [m], stress along it [n] [Pa]) after STEPS steps of the platens."""
    start_taichi(precision, "cpu", 1)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=0.0),
        Platen(axis=1, side="upper", position=BAR[1] * DX, speed=-SPEED),
    )
    loading = Loading(boundaries=platens, start=Affine(), width=BAR[0] * DX)
    scene = scene_of(
        (BAR[0] + 6, BAR[1]), (3, 0), (3 + BAR[0], BAR[1]), loading=loading, schedule=Schedule(t_end=1.0, cfl=0.1)
    )
    piece = Piece.of(scene, ti.f32 if precision == "f32" else ti.f64)
    piece.drive.advance(STEPS)
    return piece.by_id("u")[:, 1].astype(float), piece.by_id("sigma")[:, 1].astype(float)


def single_precision(full: bool) -> Outcome:
    """A platen moves by a ten-millionth of a cell a step, 100 000 times: float32 against float64."""
    (u, sigma), (u_32, sigma_32) = (_pushed(precision) for precision in ("f64", "f32"))
    why = "6e-8 a step were 0.6 % in 100 000 if all were rounded one way; a sum from zero loses 0.05 %"
    return Outcome(
        (
            at_most(
                "difference of displacement over the largest", np.abs(u_32 - u).max() / np.abs(u).max(), 0.005, why
            ),
            at_most("difference of the mean stress", abs(sigma_32.mean() / sigma.mean() - 1.0), 0.005, why),
        )
    )


CASES = (
    Case("symmetry", "16: a run mirrored, and turned by a quarter and a half", symmetry, quick=False),
    Case("scaling", "17: other units and scales", scaling, quick=False),
    Case("single_precision", "float32 against float64 over 100 000 small steps", single_precision, quick=False),
)
