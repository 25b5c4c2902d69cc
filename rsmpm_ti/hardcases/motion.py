"""Large motion: turns of a stressed disc, pieces in free flight, blocks that meet, a bar that is drawn out."""

import math
from dataclasses import dataclass

import numpy as np
import taichi as ti

from rsmpm_ti.analysis.numerical_fracture import parted, parting_warning
from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, difference, relative, seen
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.hardcases.pieces import DENSITY, DX, ELASTIC, HOOKE, NU, Piece, breaking, scene_of
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.regions import Box, Disc
from rsmpm_ti.spec.scene import Body, Schedule
from rsmpm_ti.verify.elastic.bodies import turned


@ti.kernel
def _turn(elasticity: ti.template(), G: ti.types.ndarray(), steps: int, sigma: ti.types.ndarray()):
    """Apply a displacement gradient G [2, 2] to one packed stress, again and again."""
    for _ in range(1):
        packed = ti.Vector([sigma[0], sigma[1], sigma[2], sigma[3]])
        step = ti.Matrix([[G[0, 0], G[0, 1]], [G[1, 0], G[1, 1]]])
        for _step in range(steps):
            packed = elasticity.stress(packed, step)
        for component in ti.static(range(4)):
            sigma[component] = packed[component]


def _rigid(turns: int, per_turn: int) -> list[Row]:
    """The stress update alone, in steps that are exactly rotations: back where it was after whole turns."""
    start = np.array([30e6, -10e6, 3e6, 5e6])
    sigma = start.copy()
    _turn(HOOKE, turned(2.0 * math.pi / per_turn) - np.eye(2), turns * per_turn, sigma)
    deviator = lambda s: math.hypot(0.5 * (s[0] - s[1]), s[3])  # noqa: E731
    at = f"{turns} turns of {per_turn} steps"
    why = "round-off of the strain, 1e-16 a step, times E over the deviator of 21 MPa"
    growth = math.exp(8.0 * math.pi**2 * turns / per_turn)
    return [
        at_most(f"{at}: change of the deviator", abs(deviator(sigma) / deviator(start) - 1.0), 1e-7, why),
        at_most(f"{at}: change of the stress", float(np.abs(sigma - start).max()) / deviator(start), 1e-7, why),
        seen(f"{at}: what an explicit Jaumann step would make of it", growth, "exp(8 pi^2/n) a turn"),
    ]


def spinning_disc(transfer, turns: float, strength_fraction: float) -> tuple[Piece, np.ndarray]:
    """(A disc of 8 cells' diameter after its turns, mean in-plane stress at its centre over the static one, [looks]).

    The static stress there is rho w^2 R^2 (3 - 2 nu)/(8 (1 - nu)) (Timoshenko & Goodier, art. 32, plane strain); a
    sudden start doubles it.
    """
    radius, static = 4.0 * DX, 50e6
    w = math.sqrt(static * 8.0 * (1.0 - NU) / (DENSITY * radius**2 * (3.0 - 2.0 * NU)))
    strength = 2.0 * static / strength_fraction
    criterion = MohrCoulomb(cohesion=3.0 * strength, friction_angle=40.0, tensile_strength=strength)
    disc = Body(region=Disc(centre=(0.008, 0.008), radius=radius), spin=w)
    scene = scene_of(
        (16, 16), (0, 0), (1, 1), bodies=(disc,), rock=breaking(criterion), shape=QuadraticBSpline(), transfer=transfer
    )
    piece = Piece.of(scene)
    centre = np.linalg.norm(piece.x - 8.0, axis=1) < 1.5
    steps, stress = math.ceil(2.0 * math.pi * turns / w / piece.clock.dt), []
    while piece.clock.step < steps:
        try:
            piece.drive.advance(math.ceil(0.01 * steps))
        except UnstableRun:  # what has failed flies off
            break
        sigma = piece.by_id("sigma")[centre]
        stress.append(float(0.5 * (sigma[:, 0] + sigma[:, 1]).mean()) / static)
    return piece, np.array(stress)


def rotation(full: bool) -> Outcome:
    """6: stress that turns with its rock, by itself and in a disc that spins; nothing fails at 80 % of strength."""
    rows = [*_rigid(1, 360), *_rigid(10, 3600)]
    if full:
        rows += _rigid(10, 36000)
    turns = 10
    for name, transfer in (("Apic", Apic()), ("FLIP", PicFlip()))[: 2 if full else 0]:
        piece, stress = spinning_disc(transfer, turns, 0.8)
        failed = int((piece.by_id("mode") > 0).sum())
        mean = float(stress[len(stress) // 2 :].mean())
        if name == "Apic":
            why = "8 cells across, and what is left of the ringing of a sudden start"
            rows.append(relative(f"{name}, {turns} turns: mean stress at the centre over theory", 1.0, mean, 0.15, why))
            rows.append(
                at_most(f"{name}, {turns} turns: particles failed at 80 % of strength", failed, 0.0, "0.8 x 1.15 < 1")
            )
        else:
            why = "FLIP keeps the ringing that crossing cells makes; Apic and 1 % PIC forget it"
            rows.append(seen(f"{name}, {turns} turns: mean stress at the centre over theory", mean, why))
            rows.append(seen(f"{name}, {turns} turns: particles failed at 80 % of strength", failed, why))
    return Outcome(tuple(rows))


BAR = (8, 4)
"""Of the spinning bar [cells]; it breaks in two of 4."""


@dataclass(frozen=True)
class Flight:
    """Worst over a flight: momentum over that of all parts, change of angular momentum over itself; share that failed;
    a lone particle's distance from its line [cells] and its stress/E."""

    momentum: float
    angular: float
    failed: float
    lone: float
    lone_stress: float


def broken_bar(shape, transfer, diameters: int) -> Flight:
    """Spin a bar so fast that its middle fails, and follow the pieces for so many diameters.

    rho w^2 L^2/8 pulls there with 70 % of the strength; a sudden start makes up to twice that of it.

    Beside it flies a single particle.
    """
    strength, length, room = 50e6, BAR[0] * DX, 10 * diameters
    w = math.sqrt(8.0 * 0.7 * strength / DENSITY) / length
    criterion = MohrCoulomb(cohesion=3.0 * strength, friction_angle=40.0, tensile_strength=strength)
    low = (room - BAR[0] / 2, room - BAR[1] / 2)
    bar = Box(lower=tuple(DX * a for a in low), upper=tuple(DX * (a + b) for a, b in zip(low, BAR, strict=True)))
    lone = Box(lower=(4 * DX, 4 * DX), upper=(4.5 * DX, 4.5 * DX))
    bodies = (Body(region=bar, spin=w), Body(region=lone, velocity=(60.0, 20.0)))
    size = (2 * room,) * 2
    scene = scene_of(size, (0, 0), (1, 1), bodies=bodies, rock=breaking(criterion), shape=shape, transfer=transfer)
    piece = Piece.of(scene)
    mass = piece.sim.density * piece.by_id("volume")

    def moments() -> tuple[np.ndarray, float]:
        x, v = piece.x[:-1] - room, piece.by_id("v")[:-1]
        spin = x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]
        if transfer.affine:  # each particle also turns by itself: its B = C dx^2/4 counts (Jiang et al. 2015)
            C = piece.by_id("C")[:-1]
            spin += 0.25 * DX * (C[:, 1, 0] - C[:, 0, 1])
        return mass[:-1] @ v, float(mass[:-1] @ spin)

    (_, spin), v0 = moments(), piece.by_id("v")[:-1]
    scale = float(mass[:-1] @ np.linalg.norm(v0, axis=1))
    x0, momentum, angular, distance = piece.x[-1], 0.0, 0.0, 0.0
    half = piece.x[:-1, 0] > room
    while distance < diameters * BAR[0] / 2:
        piece.drive.advance(50)
        p, l = moments()
        momentum, angular = max(momentum, float(np.abs(p).max()) / scale), max(angular, abs(l / spin - 1.0))
        distance = float(np.linalg.norm(piece.x[:-1][half].mean(axis=0) - room)) - BAR[0] / 4
    straight = piece.x[-1] - x0 - np.array([60.0, 20.0]) * piece.clock.time / DX
    sigma = piece.by_id("sigma")
    lone = float(np.abs(straight).max()), float(np.abs(sigma[-1]).max()) / HOOKE.E
    return Flight(momentum, angular, float((piece.by_id("mode")[:-1] > 0).mean()), *lone)


def fragments(full: bool) -> Outcome:
    """7: a bar that spins itself to pieces, and one particle alone: what flies freely keeps what it has."""
    rows = []
    runs = [(Linear(), PicFlip())] + [(QuadraticBSpline(), PicFlip()), (QuadraticBSpline(), Apic())] * full
    for shape, transfer in runs:
        flight, name = (
            broken_bar(shape, transfer, 10 if full else 4),
            f"{type(shape).__name__}, {type(transfer).__name__}",
        )
        why = "FLIP carries no spin of particles themselves: of half a cell it is 0.6 % of the bar's"
        most = 0.01
        if transfer.affine:
            why, most = "affine transfers keep it: round-off of 2000 steps", 1e-11
        rows += [
            at_least(f"{name}: fraction of particles that fail", flight.failed, 0.05, "it does break"),
            at_most(f"{name}: momentum over that of all parts", flight.momentum, 1e-12, "round-off of 2000 steps"),
            at_most(f"{name}: change of angular momentum", flight.angular, most, why),
            at_most(f"{name}: lone particle off its line [cells]", flight.lone, 1e-9, "round-off of its place"),
            at_most(f"{name}: its stress/E", flight.lone_stress, 1e-12, "round-off of the velocity gradient"),
        ]
    return Outcome(tuple(rows))


def meeting() -> Piece:
    """Two blocks of 4 x 4 cells, 2.5 cells apart, off the lines of the grid."""
    low, high = ((4.0, 4.0), (10.5, 4.0)), ((8.0, 8.0), (14.5, 8.0))
    boxes = [
        Box(lower=tuple(DX * v for v in a), upper=tuple(DX * v for v in b)) for a, b in zip(low, high, strict=True)
    ]
    return Piece.of(
        scene_of((24, 12), (0, 0), (1, 1), bodies=tuple(Body(region=box) for box in boxes), rock=breaking())
    )


def _meet(piece: Piece, failed: bool) -> list[Row]:
    n, name = piece.particles.count // 2, "failed" if failed else "unfailed"
    velocity = np.repeat([[0.5, 0.0], [-0.5, 0.0]], n, axis=0)
    piece.start(0.5, velocity, shift=(0.1, 0.1))
    if failed:
        piece.particles.mode.fill(1)
    drive, mass = piece.drive, piece.sim.density * piece.by_id("volume")
    history = History(piece.sim, piece.clock, drive.survey)
    gap, pull, drift = math.inf, 0.0, 0.0
    while piece.clock.time < 4.5 * DX:  # at 1 m/s they would be 2 cells into each other
        drive.advance(200)
        history.record(drive.survey)
        x, sigma = piece.x[:, 0], piece.by_id("sigma")
        gap = min(gap, float(x[n:].min() - x[:n].max()))
        pull = max(pull, float(sigma[:, :2].max()))
        drift = max(drift, abs(float(mass @ piece.by_id("v")[:, 0])) / float(0.5 * mass.sum()))
    apart = float(piece.by_id("v")[n:, 0].mean() - piece.by_id("v")[:n, 0].mean())
    rows = [
        at_least(f"{name}: smallest gap [cells]", gap, -0.5, "surfaces are half a spacing beyond: not a cell into it"),
        at_most(f"{name}: momentum over one block's", drift, 1e-12, "round-off of 23 000 steps"),
    ]
    if failed:
        rows.append(at_most(f"{name}: largest tension [Pa]", pull, 0.0, "failed rock does not pull"))
        rows.append(seen(f"{name}: speed apart at the end [m/s]", apart, "its waves are not reversed: it is a fluid"))
    else:
        why = "one velocity field: blocks touch at one cell, and hold on to each other as they leave it"
        rows.append(seen(f"{name}: largest tension [MPa]", 1e-6 * pull, why))
        rows.append(seen(f"{name}: speed apart at the end [m/s]", apart, why))
    return rows


def contact(full: bool) -> Outcome:
    """8: two blocks meet at 1 m/s, failed and unfailed."""
    piece = meeting()
    return Outcome(tuple(row for failed in (True, False) for row in _meet(piece, failed)))


SOFT = Rock(density=DENSITY, elasticity=Hooke(E=1e-6, nu=0.0), criterion=ELASTIC.criterion, viscosity=ELASTIC.viscosity)
"""So soft that nothing stops a bar from being drawn out."""


def drawn(shape) -> Piece:
    """A bar of 6 x 3 cells in room to be drawn out fivefold."""
    return Piece.of(scene_of((40, 9), (17, 3), (23, 6), rock=SOFT, shape=shape, schedule=Schedule(t_end=1e6)))


def numerical_fracture(full: bool) -> Outcome:
    """9: a bar that cannot break is drawn out until its particles lose each other; the report says so."""
    rows = []
    for shape in (Linear(), Gimp(), QuadraticBSpline())[: 3 if full else 1]:
        piece, name = drawn(shape), type(shape).__name__
        velocity = np.stack([1.0 * (piece.x[:, 0] - 20.0), 0.0 * piece.x[:, 1]], axis=1) * DX  # stretch is 1 + t
        piece.start(1.0, velocity)
        piece.clock.dt = 2e-3
        scene, first, warned = piece.sim.scene, math.inf, ""
        while piece.clock.time < 3.5:
            piece.drive.advance(20)
            snapshot = take_snapshot(piece.sim, piece.clock.time)
            if len(parted(scene, snapshot)) and not math.isfinite(first):
                first, warned = 1.0 + piece.clock.time, parting_warning(scene, snapshot)
        limit = 2.0 * shape.crack_band
        why = (
            "spacing is half a cell times the stretch, found within a look; spacings are uneven once cells are crossed"
        )
        rows.append(relative(f"{name}: stretch at which it is told", limit, first, 0.15, why))
        told = float("parted by its discretisation" in warned)
        rows.append(difference(f"{name}: the warning says what it is", 1.0, told, 0.0, "place, reach and remedy"))
    return Outcome(tuple(rows))


CASES = (
    Case("rotation", "6: stress that turns with its rock, and a disc that spins", rotation),
    Case("fragments", "7: a bar that spins itself to pieces, and its pieces in flight", fragments),
    Case("contact", "8: blocks of failed and unfailed rock that meet at 1 m/s", contact, quick=False),
    Case("numerical_fracture", "9: a bar that cannot break is drawn out", numerical_fracture),
)
