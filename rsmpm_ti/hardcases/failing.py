"""Rock that fails all at once, and failed rock that is a fluid: bounded, and paid for."""

import math
from dataclasses import replace

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, difference, relative, seen
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.hardcases.pieces import DX, HOOKE, PAPER, Piece, breaking, scene_of
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.readout import read_events
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.regions import Difference, Disc
from rsmpm_ti.spec.scene import Body, Loading, Schedule

UCS, PLANE_MODULUS = PAPER.ucs, HOOKE.E / (1.0 - HOOKE.nu**2)

WIDTH, HEIGHT = 6, 12
"""Of the specimen [cells]."""

RATE = 8.0
"""Nominal strain rate [1/s]."""


STRAIN_END = 1.2 * UCS / PLANE_MODULUS


def specimen(hole: float = 0.0) -> Piece:
    """A specimen between frictionless platens that start with the field of uniform straining; hole: its radius [m]."""
    speed, side = 0.5 * RATE * HEIGHT * DX, 3
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=speed),
        Platen(axis=1, side="upper", position=HEIGHT * DX, speed=-speed),
    )
    size, lower, upper = (WIDTH + 2 * side, HEIGHT), (side, 0), (WIDTH + side, HEIGHT)
    scene = scene_of(
        size, lower, upper,
        rock=breaking(viscosity=BulkViscosity()),
        loading=Loading(boundaries=platens, start=Affine(), width=WIDTH * DX),
        schedule=Schedule(strain_end=STRAIN_END, cfl=0.25),
    )  # fmt: skip
    if hole > 0.0:
        centre = (DX * (side + 0.5 * WIDTH), DX * 0.5 * HEIGHT)
        region = Difference(whole=scene.bodies[0].region, removed=(Disc(centre=centre, radius=hole),))
        scene = replace(scene, bodies=(Body(region=region),))
    return Piece.of(scene)


def press(piece: Piece, cfl: float, velocity: np.ndarray) -> tuple[np.ndarray, float]:
    """History of a run to STRAIN_END, in about 240 rows, and its energy at the start; the guard looks at each row."""
    piece.start(cfl, velocity)
    history, rows = History(piece.sim, piece.clock, piece.drive.survey), 240.0
    stride = round(STRAIN_END / (RATE * piece.clock.dt) / rows)
    while piece.clock.strain < STRAIN_END:
        piece.drive.advance(stride)
        history.record(piece.drive.survey)
    return history.table(), history.energy_start


def _balance(table: np.ndarray, start: float) -> np.ndarray:
    """kinetic + elastic + dissipated - work - start [J], per row."""
    names = ("energy_kinetic_J", "energy_elastic_J", "energy_dissipated_J")
    return sum(table[name] for name in names) - table["work_J"] - start


def _energy_rows(piece: Piece, table: np.ndarray) -> list[Row]:
    fall = float(np.diff(table["energy_dissipated_J"], prepend=0.0).min() / table["work_J"].max())
    least = float(read_events(piece.sim).released.min())
    return [
        at_least("smallest step of the energy dissipated, over the work", fall, -1e-12, "round-off of its sum"),
        at_least("least energy released by a failure [J]", least, 0.0, "failure only takes stress"),
    ]


def _created(table: np.ndarray, start: float) -> float:
    return float(_balance(table, start).max() / table["work_J"].max())


def uniform_failure(full: bool) -> Outcome:
    """12: the whole specimen reaches its strength at once; which particle is first is round-off."""
    piece = specimen()
    table, start = press(piece, 0.5, piece.by_id("v"))
    events = read_events(piece.sim)
    before = np.flatnonzero(table["time_s"] < events.time[0])[-8:]
    line = np.polyfit(table["time_s"][before], table["stress_top_Pa"][before], 1)
    nominal = float(np.polyval(line, events.time[0]))
    fraction, took = len(events) / piece.particles.count, (events.time[-1] - events.time[0]) / piece.clock.dt
    rows = [
        relative("nominal stress at first failure/UCS", UCS, nominal, 0.01, "two rows of 0.5 % of UCS each"),
        relative("sigma_3 of the first failure/UCS", -UCS, float(events.sigma_3[0]), 0.01, "as nominal: it is uniform"),
        relative("fraction of particles that fail", 1.0, fraction, 0.0, "all are equal"),
        at_most("steps from first failure to last", took, 4.0 * HEIGHT / 0.5, "4 transits of a wave"),
        difference("stress is finite", 1.0, float(np.isfinite(piece.by_id("sigma")).all()), 0.0, "no NaN"),
        at_most("energy created, over the work", _created(table, start), 0.01, SECOND_ORDER),
    ]
    return Outcome((*rows, *_energy_rows(piece, table)))


SECOND_ORDER = "the trapezoidal rule in a step in which stress is lost: 0.2 % of the work at CFL 0.5, and waves as much"


def failure_energy(full: bool) -> Outcome:
    """15: failure spreads from a hole until the specimen bursts; no energy comes of it as the step is refined."""
    piece = specimen(hole=1.6 * DX)
    velocity, rows, created = piece.by_id("v"), [], []
    for cfl in (0.5, 0.25):
        table, start = press(piece, cfl, velocity)
        created.append(_created(table, start))
        rows.append(at_most(f"CFL {cfl:g}: energy created, over the work", created[-1], 0.01, SECOND_ORDER))
    rows.append(at_most("what half the step leaves of it", created[1] / created[0], 0.5, "first order: a half"))
    fraction = len(read_events(piece.sim)) / piece.particles.count
    rows.append(at_least("fraction of particles that fail", fraction, 0.1, "enough to have something to book"))
    return Outcome((*rows, *_energy_rows(piece, table)))


GRAVITY = 1e5
"""[m/s^2]: a pressure of 4 MPa under 16 mm, and a fall that lasts 2000 steps."""


def pour() -> Piece:
    """A column of 8 x 16 cells, to be failed, on the floor of a box of 40 cells."""
    edge = DX * 40
    walls = (
        Wall(axis=0, side="lower", position=0.0),
        Wall(axis=0, side="upper", position=edge),
        Wall(axis=1, side="lower", position=0.0),
    )
    loading = Loading(boundaries=walls, body_force=(0.0, -GRAVITY))
    return Piece.of(scene_of((40, 40), (16, 0), (24, 16), rock=breaking(viscosity=BulkViscosity()), loading=loading))


FALL = 2400
"""Steps until the flow nears the sides of its box."""


def collapse(full: bool) -> Outcome:
    """14: a column of failed rock under its weight flows, as it must without shear strength, and stays bounded."""
    piece = pour()
    piece.start(0.5, 0.0)
    piece.particles.mode.fill(1)
    drive, history = piece.drive, History(piece.sim, piece.clock, piece.drive.survey)
    fronts, balance, least = [], [], 1.0
    for _ in range(FALL // 100):
        drive.advance(100)
        s = drive.survey
        history.record(s)
        fronts.append(float(np.ptp(piece.x[:, 0])))
        balance.append((piece.energy + s.dissipated) / s.work - 1.0)
        least = min(least, s.J_min)
    speed = 0.5 * DX * float(np.diff(fronts).max()) / (100 * piece.clock.dt)
    ritter = 2.0 * math.sqrt(GRAVITY * 16 * DX)
    rows = [
        at_least("width at the end over the start", fronts[-1] / 8.0, 2.0, "a fluid does not stand"),
        at_most("speed of its fronts over 2 sqrt(g h)", speed / ritter, 1.0, "front of a dam break (Ritter)"),
        at_least("smallest J", least, 0.9, "rho c v of its fastest, 60 m/s, is 3 % of K"),
        at_most("energy off balance over the work", float(np.abs(balance).max()), 0.05, "5 %, as for impact"),
    ]
    if full:
        rows.append(_splash(piece, history))
    return Outcome(tuple(rows))


def _splash(piece: Piece, history: History) -> Row:
    """On, to where the fluid has hit the sides and sprays."""
    try:
        for _ in range(100):
            piece.drive.advance(100)
            history.record(piece.drive.survey)
    except UnstableRun:
        pass
    why = "by then spray has left the box at its top"
    return seen("heights that it could fall until it is stopped", 0.5 * GRAVITY * piece.clock.time**2 / (16 * DX), why)


CASES = (
    Case("uniform_failure", "12: a specimen that reaches its strength everywhere at once", uniform_failure),
    Case("collapse", "14: a column of failed rock under its own weight", collapse),
    Case("failure_energy", "15: failure spreads from a hole: what it costs", failure_energy),
)
