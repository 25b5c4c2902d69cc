"""Time steps: up to the limit, past it, and where a limit of another order would vanish, at nodes of small mass."""

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, difference, seen
from rsmpm_ti.errors import SceneError, UnstableRun
from rsmpm_ti.hardcases.pieces import C_P, Piece, scene_of
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.time_step import stable_cfl
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.solver.history import History
from rsmpm_ti.spec.scene import Scene


def block(**changes) -> Scene:
    """A free block of 5 x 5 cells."""
    return scene_of((14, 14), (4, 4), (9, 9), **changes)


STRAIN = 1e-5
"""Amplitude of the motion that runs start with; the guard looks from 1e-6 on."""

BEAT = "velocity and stress are half a step apart: sin(w dt/2) for the block's mode, and a fifth for the others"


def beat(cfl: float) -> float:
    """Share by which kinetic + elastic energy of the mode of 10 cells per wave exceeds that of its start."""
    return np.sin(0.5 * cfl * 2.0 * np.pi / 10.0)


WATCHED = 4000
"""Steps within which an unstable run must be found: growth by 1 % a step takes round-off to anything in 3500."""


def breathing(x: np.ndarray) -> np.ndarray:
    """Velocity [m/s] of a block about (6.5, 6.5) that swells along both axes: its lowest mode, or nearly."""
    return STRAIN * C_P * np.sin(np.pi * (x - 6.5) / 5.0)


def flying(x: np.ndarray) -> np.ndarray:
    """Velocity [m/s] of a block that flies, and a thousandth of noise: no mode of it beats."""
    return STRAIN * C_P * (1.0 + 1e-3 * np.random.default_rng(1).standard_normal(x.shape))


def watch(piece: Piece, cfl: float, velocity: np.ndarray) -> tuple[int, float, str]:
    """A block at a CFL number: (steps until it is found unstable or WATCHED, largest energy created, message)."""
    piece.start(cfl, velocity)
    drive = piece.drive
    history, created, message = History(drive.sim, drive.clock, drive.survey), 0.0, ""
    start = piece.energy
    try:
        while not message and piece.clock.step < WATCHED:
            drive.advance(20)
            created = max(created, 1.0 - start / piece.energy)
            history.record(drive.survey)
    except UnstableRun as error:
        message = str(error)
    return piece.clock.step, created, message


OFFSETS = (0.0, 1e-4, 0.01, 0.05, 0.1, 0.2, 0.249, 0.2501, 0.26, 0.3, 0.4, 0.499, 0.501, 0.6, 0.7, 0.749, 0.7501, 0.9)
"""Where the block sits in its cells: among them just before and after particles of the edge reach a new node."""

CROSSING = 0.25
"""Offset at which the first particles leave the cells that they were seeded in."""


def holds(piece: Piece, cfl: float, offset: float) -> bool:
    """Whether noise, so small that nothing leaves its place, does not grow thirtyfold within 800 steps."""
    noise = 1e-7 * np.random.default_rng(1).standard_normal((piece.particles.count, 2))
    piece.start(cfl, noise, shift=(offset, offset))
    try:
        piece.drive.advance(20)
        start = piece.energy
        for _ in range(8):
            piece.drive.advance(100)
            if not piece.energy < 30.0 * start:
                return False
    except UnstableRun:
        return False
    return True


def largest_cfl(piece: Piece, offsets: tuple[float, ...] = OFFSETS) -> float:
    """The smallest limit over offsets, to 0.02."""
    limit = 3.0
    for offset in offsets:
        low, high = 0.0, limit
        if holds(piece, limit, offset):
            continue
        while high - low > 0.02:
            middle = 0.5 * (low + high)
            low, high = (middle, high) if holds(piece, middle, offset) else (low, middle)
        limit = low
    return limit


SHAPES = (Linear(), Gimp(), QuadraticBSpline())


def _limits() -> list[Row]:
    """The limit found of every shape function, transfer and order, against what the solver states."""
    rows = []
    for transfer in (PicFlip(), Apic()):
        for order in ("musl", "usf", "usl"):
            for shape in SHAPES:
                if order == "usl" and (isinstance(shape, Linear) or transfer.affine):
                    continue
                scene = block(shape=shape, order=order, transfer=transfer)
                name = f"limit, {type(shape).__name__}, {type(transfer).__name__}, {order}"
                piece, offsets, why = Piece.of(scene), OFFSETS, "what the solver states"
                if isinstance(shape, Linear) and transfer.affine:
                    none = "none holds: a node of mass m r takes a speed of 1/r, and C keeps its gradient"
                    crossed = tuple(offset for offset in OFFSETS if offset > CROSSING)
                    rows.append(seen(f"{name}, crossed", largest_cfl(piece, crossed), none))
                    name, offsets = f"{name}, none crossed", tuple(o for o in OFFSETS if o < CROSSING)
                rows.append(at_least(name, largest_cfl(piece, offsets), stable_cfl(scene), why))
    return rows


def past_limit(full: bool) -> Outcome:
    """4: sound up to CFL 1; beyond the limit a run is found unstable, by its energy if by nothing sooner."""
    piece = Piece.of(block())
    x, rows = piece.x, []
    for cfl in (0.5, 1.0):
        _, created, _ = watch(piece, cfl, breathing(x))
        rows.append(at_most(f"CFL {cfl:g}: fraction of energy created", created, 1.2 * beat(cfl), BEAT))
    for cfl in (1.9, 2.5, 100.0):
        steps, _, message = watch(piece, cfl, flying(x))
        why = "1.71 is the largest limit at any offset, so it grows"
        rows.append(at_most(f"CFL {cfl:g}: steps until found", steps if message else np.inf, WATCHED - 1, why))
        why = "step, position, cause and remedy"
        told = all(word in message for word in ("at step", "mm", "likely cause", "lower schedule.cfl"))
        rows.append(difference(f"CFL {cfl:g}: message tells what to do", 1.0, float(told), 0.0, why))
    at_limit = [holds(piece, stable_cfl(piece.sim.scene), offset) for offset in OFFSETS]
    why = "the limit that the solver states, at every place of the block in its cells"
    rows.append(at_least("Linear, musl: fraction of offsets stable at its limit", np.mean(at_limit), 1.0, why))
    return Outcome((*rows, *(_limits() if full else ())))


FRACTIONS = (1e-4, 1e-3, 0.01, 0.05)
"""How far into a new cell the last particles are."""


def _edge(piece: Piece, name: str, fraction: float) -> list[Row]:
    piece.start(0.5, 0.0, shift=(0.25 + fraction, 0.25 + fraction))
    x = piece.x
    velocity = breathing(x - 0.25) * np.array([1.0, 0.0])
    piece.start(0.5, velocity + 0.1 * STRAIN * C_P, shift=(0.25 + fraction, 0.25 + fraction))
    drive, mass = piece.drive, piece.sim.density * piece.particles.volume.to_numpy()[0]
    momentum, scale = mass * piece.by_id("v").sum(axis=0), mass * np.abs(velocity).sum()
    speed, start = np.linalg.norm(velocity, axis=1).max(), piece.energy
    drift = created = fastest = 0.0
    for _ in range(40):
        drive.advance(50)
        created = max(created, 1.0 - start / piece.energy)
        drift = max(drift, np.abs(drive.survey.momentum - momentum).max() / scale)
        fastest = max(fastest, drive.survey.speed / speed)
    at = f"{name}, {fraction:g} of a cell"
    return [
        at_most(f"{at}: fraction of energy created", created, 1.2 * beat(0.5), BEAT),
        at_most(f"{at}: largest speed over the first", fastest, 3.0, "waves of both directions meet at corners"),
        at_most(f"{at}: momentum lost", drift, 1e-12, "round-off of 2000 steps"),
    ]


def small_mass(full: bool) -> Outcome:
    """3: particles that have just entered a cell: a node of small mass and a force that is not small."""
    rows = []
    for order in ("musl", "usf")[: 2 if full else 1]:
        piece = Piece.of(block(order=order))
        for fraction in FRACTIONS if full else FRACTIONS[::3]:
            rows += _edge(piece, order, fraction)
    try:
        block(order="usl")
        refused = 0.0
    except SceneError:
        refused = 1.0
    why = "its limit falls as the root of the fraction: 0.31 at 0.05, 0.014 at 1e-4"
    rows.append(difference("usl with Linear: refused", 1.0, refused, 0.0, why))
    if full:
        piece = Piece.of(block(transfer=Apic()))
        for offset in (0.0, 0.3, 0.26, 0.2501):
            limit = next((cfl for cfl in np.arange(1.0, 0.0, -0.02) if holds(piece, cfl, offset)), 0.0)
            why = "Apic keeps the velocity of the light node in C: no limit holds when a particle has just crossed"
            rows.append(seen(f"Apic with Linear, {offset:g} of a cell: limit", limit, why))
    return Outcome(tuple(rows))


CASES = (
    Case("small_mass", "3: particles that have just entered a new cell", small_mass),
    Case("past_limit", "4: steps up to the limit, and past it", past_limit),
)
