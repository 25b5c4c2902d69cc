"""A column that hits a wall at speeds up to 0.04 of its wave speed."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, relative, seen
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.hardcases.pieces import C_P, DENSITY, DX, ELASTIC, Piece, scene_of
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.solver.history import History
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.scene import Loading

LENGTH = 40
"""Of the column [cells]; two cells wide, walls at its sides, so that its waves are those of c_p alone."""

SPEEDS = (1.0, 10.0, 100.0)
"""Of the impact [m/s]."""


def column(shape, order: str) -> Piece:
    """The column, standing on the wall that it is about to hit, with artificial viscosity."""
    walls = (
        Wall(axis=0, side="lower", position=0.0),
        Wall(axis=0, side="upper", position=2.0 * DX),
        Wall(axis=1, side="lower", position=0.0),
    )
    rock, loading = replace(ELASTIC, viscosity=BulkViscosity()), Loading(boundaries=walls)
    size = (2, LENGTH + 10)
    return Piece.of(scene_of(size, (0, 0), (2, LENGTH), rock=rock, loading=loading, shape=shape, order=order))


@dataclass(frozen=True)
class Impact:
    """Stress behind the shock over rho c v; smallest J; energy at the end and at its worst over the start, less 1."""

    plateau: float
    J: float
    balance: float
    worst: float


def hit(piece: Piece, speed: float) -> Impact:
    """From the first touch until the column has left the wall: three and a half times the way of a wave through it."""
    piece.start(0.5, np.array([0.0, -speed]))
    drive, start, y = piece.drive, piece.energy, piece.x[:, 1]
    history = History(piece.sim, piece.clock, drive.survey)
    drive.advance(round(0.6 * LENGTH / 0.5))
    behind = (y > 4.0) & (y < 0.45 * LENGTH)
    plateau = float(piece.by_id("sigma")[behind, 1].mean()) / (DENSITY * C_P * speed)
    low, balance = 1.0, []
    for _ in range(30):
        drive.advance(round(0.1 * LENGTH / 0.5))
        history.record(drive.survey)
        low = min(low, drive.survey.J_min)
        balance.append((piece.energy + drive.survey.dissipated) / start - 1.0)
    return Impact(plateau, low, balance[-1], max(map(abs, balance)))


def _rows(piece: Piece, name: str, speed: float) -> list[Row]:
    at = f"{name}, {speed:g} m/s"
    try:
        impact = hit(piece, speed)
    except UnstableRun:
        why = "usf and linear functions: the free end's last particles leave their cells while they are pulled"
        return [seen(f"{at}: found unstable", 1.0, why)]
    why = "conservation of momentum; 1.5 % by a front that rings, and v/c since the law is linear in ln J"
    tolerance = 0.02 + speed / C_P
    beats = "ten cells of front in forty beat by sin(w dt/2) = 0.16: 4 %; and the wall's loss"
    return [
        relative(f"{at}: stress behind the shock/(rho c v)", -1.0, impact.plateau, tolerance, why),
        at_least(f"{at}: smallest J", impact.J, 0.1, "a strain of v/c = 0.04 at most, twice that where waves meet"),
        at_most(f"{at}: energy off balance, at its worst", impact.worst, 0.05, beats),
        seen(
            f"{at}: energy made or lost at the end", impact.balance, "musl stops at a wall what particles bring there"
        ),
    ]


def impact(full: bool) -> Outcome:
    """13: rho c v behind the shock, no particle turned inside out, energy within 5 %."""
    settings = [(Linear(), "musl")]
    if full:
        settings += [(QuadraticBSpline(), "musl"), (Linear(), "usf"), (QuadraticBSpline(), "usf")]
    rows = []
    for shape, order in settings:
        piece = column(shape, order)
        for speed in SPEEDS:
            rows += _rows(piece, f"{type(shape).__name__}, {order}", speed)
    return Outcome(tuple(rows))


CASES = (Case("impact", "13: a column hits a wall at 1, 10 and 100 m/s", impact),)
