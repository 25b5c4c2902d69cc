"""Energy as it was exchanged: a body's weight, a dead load, and platens that load and unload.

Each is of one dimension, and is done along every axis in 2D and 3D.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.spec.boundaries import Fixed, Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.elastic.bodies import elastic

E, DENSITY, GRAVITY = 17e9, 2600.0, 9.81

WAYS = ((2, 0), (2, 1), (3, 0), (3, 1), (3, 2))
"""Dimensions and axes."""

Rows = Callable[[int, int, float], tuple[tuple[Row, ...], np.ndarray]]
"""Numbers and history of one way on a grid: (dimensions, axis, dx)."""


def ways(rows: Rows, own: tuple[int, int], full: bool, dx: float, fine: float, title: str) -> Outcome:
    """Its own way alone; with --full that one finer, and every other."""
    found, history = rows(*own, fine if full else dx)
    for dim, axis in WAYS if full else ():
        if (dim, axis) != own:
            found += rows(dim, axis, dx)[0]
    return Outcome(found, lambda figure: draw_energies(figure, history, title))


def corner(dim: int, axis: int, along: float, across: float) -> tuple[float, ...]:
    """A place: one coordinate along the axis, another along all others."""
    return tuple(along if d == axis else across for d in range(dim))


def column(dim: int, axis: int, dx: float, damping: float, t_end: float) -> Scene:
    """A column of 2 x 10 m (2 x 2 x 10 m) between smooth walls, let go under its weight; its base is a load cell."""
    base = Wall(axis=axis, side="lower", position=0.0)
    sides = tuple(
        Wall(axis=d, side=side, position=position)
        for d in range(dim)
        if d != axis
        for side, position in (("lower", 0.0), ("upper", 2.0))
    )
    cell = LoadCell(axis=axis, lower=(0,), upper=(), width=2.0 ** (dim - 1))
    return Scene(
        title="A column under its own weight",
        domain=Domain(lower=(0.0,) * dim, upper=corner(dim, axis, 12.0, 2.0), dx=dx),
        bodies=(Body(region=Box(lower=(0.0,) * dim, upper=corner(dim, axis, 10.0, 2.0))),),
        rock=replace(elastic(E, 0.25, DENSITY), viscosity=BulkViscosity(c2=damping)),
        loading=Loading(boundaries=(base, *sides), body_force=corner(dim, axis, -GRAVITY, 0.0), cell=cell),
        schedule=Schedule(t_end=t_end, rows=200),
    )


def weight(dim: int, axis: int, dx: float) -> tuple[tuple[Row, ...], np.ndarray]:
    scene = column(dim, axis, dx, damping=2.0, t_end=0.4 / dx)  # viscosity goes with dx, and the time to rest with 1/dx
    result = simulate(scene)
    history, sigma = result.history, result.snapshot.sigma
    stored, work = history["energy_elastic_J"], history["work_J"]
    last, across = slice(-20, None), (axis + 1) % dim
    pressure = DENSITY * GRAVITY * 10.0
    # U = (rho g h)^2 A h/(6 M), since stress is linear
    exact = pressure**2 * 2.0 ** (dim - 1) * 10.0 / (6.0 * elastic(E, 0.25, DENSITY).elasticity.p_wave_modulus)
    why, at = "what still swings", f"{dim}D, axis {axis}: "
    ratio = (sigma[:, across, across] / sigma[:, axis, axis]).mean()
    rows = (
        relative(f"{at}pressure on the base [Pa]", pressure, history["stress_bottom_Pa"][last].mean(), 2e-3, why),
        relative(f"{at}stress across over along", 1.0 / 3.0, ratio, 1e-6, "Hooke's law, round-off"),
        relative(f"{at}elastic energy [J]", exact, stored[-1], 2e-3, "B-splines miss the free end's last quarter cell"),
        relative(f"{at}work over elastic energy", 2.0, work[-1] / stored[-1], 1e-4, "virtual work; strains are 1e-5"),
        at_most(f"{at}residual over the work", residual(history)[-1] / work[-1], 2e-3, "viscosity acts a step late"),
    )
    return rows, history


def gravity(full: bool) -> Outcome:
    """rho g h at the base, s_xx/s_yy = nu/(1 - nu), and the work of a weight let go: twice what is stored at rest."""
    return ways(weight, (2, 1), full, 0.5, 0.25, "A weight of 510 kN/m let go")


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Pull:
    """A pull along an axis on what lies beyond `first`, raised by a smooth step within `ramp`."""

    b: tuple[float, ...]  # [m/s^2]
    axis: int
    first: float  # [m]
    ramp: float  # [s]

    @ti.func
    def acceleration(self, X, t):
        s = ti.min(t / self.ramp, 1.0)
        return ti.select(X[self.axis] > self.first, s * s * (3.0 - 2.0 * s), 0.0) * ti.Vector(self.b)


def pulled(dim: int, axis: int, dx: float) -> tuple[tuple[Row, ...], np.ndarray]:
    length, depth, stress = 0.05, 0.004, 1e6
    transit = length / math.sqrt(E / DENSITY)
    b = corner(dim, axis, stress / (DENSITY * dx), 0.0)
    ends = [corner(dim, axis, along, 0.5 * depth) for along in (0.01, 0.03)]
    scene = Scene(
        title="A bar under a dead load",
        domain=Domain(
            lower=corner(dim, axis, 0.0, -3.0 * dx), upper=corner(dim, axis, length + 5.0 * dx, depth + 3.0 * dx), dx=dx
        ),
        bodies=(Body(region=Box(lower=(0.0,) * dim, upper=corner(dim, axis, length, depth))),),
        rock=replace(elastic(E, 0.0, DENSITY), viscosity=BulkViscosity(c2=0.5)),
        loading=Loading(
            boundaries=(Fixed(axis=axis, side="lower", position=0.0),),
            force_field=Pull(b=b, axis=axis, first=length - dx, ramp=40.0 * transit),
            cell=LoadCell(gauges=(Gauge(name="middle", a=ends[0], b=ends[1]),)),
        ),
        schedule=Schedule(t_end=50.0 * transit, rows=200),
    )
    history = simulate(scene).history
    exact = stress**2 * depth ** (dim - 1) * (length - 2.0 * dx / 3.0) / (2.0 * E)
    last = slice(-20, None)
    work, stored = history["work_J"][last].mean(), history["energy_elastic_J"][last].mean()
    why, at = "log and engineering strain differ by half of 6e-5; what still swings", f"{dim}D, axis {axis}: "
    third = "the last cell, 1/50 of the bar, holds a third as much"
    rows = (
        relative(f"{at}strain of the bar", stress / E, history["gauge_middle"][last].mean(), 2e-3, why),
        relative(f"{at}elastic energy [J]", exact, stored, 0.01, third),
        relative(f"{at}work [J]", exact, work, 0.01, "quasi-static: all of it is stored"),
        relative(f"{at}work over elastic energy", 1.0, work / stored, 2e-3, "what still swings"),
    )
    return rows, history


def dead_load(full: bool) -> Outcome:
    """A bar of nu = 0 under 1 MPa on its end, raised within 40 transits: strain sigma/E, work = what is stored.

    The load is a force field on the last cell. So stress is sigma up to there and falls linearly to 0 across it, and
    U = sigma^2 A (L - 2/3 dx)/(2 E).
    """
    return ways(pulled, (2, 0), full, 1e-3, 0.5e-3, "A bar under a dead load")


@dataclass(frozen=True, kw_only=True)
class Cycles:
    """A start whose platens close and open again, again and again."""

    period: float  # [s]

    def factor(self, time: float) -> float:
        return math.sin(2.0 * math.pi * time / self.period)


def loaded_twice(dim: int, axis: int, dx: float) -> tuple[tuple[Row, ...], np.ndarray]:
    height, width, most = 0.1, 0.01, 1e-3
    period = 40.0 * height / math.sqrt(E / DENSITY)
    speed = 0.5 * most * height * math.pi / period
    platens = tuple(
        Platen(axis=axis, side=side, position=position, speed=sign * speed)
        for side, position, sign in (("lower", 0.0, 1.0), ("upper", height, -1.0))
    )
    scene = Scene(
        title="Loaded and unloaded twice",
        domain=Domain(
            lower=corner(dim, axis, 0.0, -2.0 * dx), upper=corner(dim, axis, height, width + 2.0 * dx), dx=dx
        ),
        bodies=(Body(region=Box(lower=(0.0,) * dim, upper=corner(dim, axis, height, width))),),
        rock=elastic(E, 0.0, DENSITY),
        loading=Loading(boundaries=platens, start=Cycles(period=period), width=width ** (dim - 1)),
        schedule=Schedule(t_end=2.0 * period, rows=200),
    )
    history = simulate(scene).history
    stress, work = history["stress_top_Pa"], history["work_J"]
    exact = -E * math.log(1.0 - most)
    wave, at = "a row's mean, and what swings", f"{dim}D, axis {axis}: "
    # per first volume W/E = eps^2/2 + eps^3/6, and s^2/(2 E) of the present volume is eps^2/2
    rates = "energy of Hooke's law in rates, s^2/(2 E) of the present volume, is eps/3 short"
    rows = (
        relative(f"{at}largest stress [Pa]", exact, stress.max(), 0.01, wave),
        at_most(f"{at}stress at the end over the largest", abs(stress[-1]) / exact, 0.01, wave),
        at_most(f"{at}work at the end over the largest", abs(work[-1]) / work.max(), 0.01**2, f"its square: {wave}"),
        relative(f"{at}residual over the largest work", most / 3.0, residual(history).max() / work.max(), 0.01, rates),
    )
    return rows, history


def cycle(full: bool) -> Outcome:
    """An elastic column of nu = 0, pressed to 1e-3 and let go, twice: -E ln(1 - eps), and nothing left at the end."""
    return ways(loaded_twice, (2, 1), full, 2.5e-3, 1.25e-3, "Loaded and unloaded twice")


def residual(history: np.ndarray) -> np.ndarray:
    """|kinetic + elastic + dissipated - work| of a body that started at rest [J]."""
    held = history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
    return np.abs(held - history["work_J"])


def draw_energies(figure, history: np.ndarray, title: str) -> None:
    axes = figure.subplots()
    for name in ("kinetic", "elastic", "dissipated"):
        axes.plot(1e3 * history["time_s"], history[f"energy_{name}_J"], label=name)
    axes.plot(1e3 * history["time_s"], history["work_J"], "k--", linewidth=0.8, label="work")
    axes.set(xlabel="time [ms]", ylabel="energy [J/m]", title=title)
    axes.legend()


CASES = (
    Case("gravity", "a column let go under its weight: base pressure, stress ratio, work", gravity),
    Case("dead_load", "a bar under a load that does not give way: strain and work", dead_load),
    Case("cycle", "an elastic column loaded and unloaded twice: nothing is left", cycle),
)
