"""Energy as it was exchanged: a body's weight, a dead load, and platens that load and unload."""

import math
from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Case, Outcome, at_most, relative
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.spec.boundaries import Fixed, Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.elastic.bodies import elastic

E, DENSITY, GRAVITY = 17e9, 2600.0, 9.81


def column(dx: float, damping: float, t_end: float) -> Scene:
    """A column of 2 x 10 m between smooth walls, let go under its weight; its base is a load cell."""
    walls = (
        Wall(axis=1, side="lower", position=0.0),
        Wall(axis=0, side="lower", position=0.0),
        Wall(axis=0, side="upper", position=2.0),
    )
    cell = LoadCell(axis=1, lower=(0,), upper=(), width=2.0)
    return Scene(
        title="A column under its own weight",
        domain=Domain(lower=(0.0, 0.0), upper=(2.0, 12.0), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(2.0, 10.0))),),
        rock=replace(elastic(E, 0.25, DENSITY), viscosity=BulkViscosity(c2=damping)),
        loading=Loading(boundaries=walls, body_force=(0.0, -GRAVITY), cell=cell),
        schedule=Schedule(t_end=t_end, rows=200),
    )


def gravity(full: bool) -> Outcome:
    """rho g h at the base, s_xx/s_yy = nu/(1 - nu), and the work of a weight let go: twice what is stored at rest."""
    dx = 0.25 if full else 0.5
    result = simulate(column(dx, damping=2.0, t_end=0.4 / dx))  # viscosity goes with dx, and the time to rest with 1/dx
    history, sigma = result.history, result.snapshot.sigma
    stored, work = history["energy_elastic_J"], history["work_J"]
    last = slice(-20, None)
    pressure, weight = DENSITY * GRAVITY * 10.0, 2.0 * 10.0 * DENSITY * GRAVITY
    # U = (rho g h)^2 A h/(6 M), since stress is linear
    exact = pressure**2 * 2.0 * 10.0 / (6.0 * elastic(E, 0.25, DENSITY).elasticity.p_wave_modulus)
    why = "what still swings"
    rows = (
        relative("pressure on the base [Pa]", pressure, history["stress_bottom_Pa"][last].mean(), 2e-3, why),
        relative("s_xx/s_yy", 1.0 / 3.0, (sigma[:, 0, 0] / sigma[:, 1, 1]).mean(), 1e-6, "Hooke's law, round-off"),
        relative("elastic energy [J/m]", exact, stored[-1], 2e-3, "B-splines miss the free end's last quarter cell"),
        relative("work over elastic energy", 2.0, work[-1] / stored[-1], 1e-4, "virtual work; strains are 1e-5"),
        at_most("residual over the work", residual(history)[-1] / work[-1], 2e-3, "viscosity acts a step late"),
    )
    return Outcome(rows, lambda figure: draw_energies(figure, history, f"A weight of {1e-3 * weight:.0f} kN/m let go"))


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Pull:
    """A pull along x on what lies beyond `first`, raised by a smooth step within `ramp`."""

    b: float  # [m/s^2]
    first: float  # [m]
    ramp: float  # [s]

    @ti.func
    def acceleration(self, X, t):
        s = ti.min(t / self.ramp, 1.0)
        return ti.Vector([ti.select(X[0] > self.first, self.b * s * s * (3.0 - 2.0 * s), 0.0), 0.0])


def dead_load(full: bool) -> Outcome:
    """A bar of nu = 0 under 1 MPa on its end, raised within 40 transits: strain sigma/E, work = what is stored.

    The load is a force field on the last cell. So stress is sigma up to there and falls linearly to 0 across it, and
    U = sigma^2 A (L - 2/3 dx)/(2 E).
    """
    length, depth, dx, stress = 0.05, 0.004, 0.5e-3 if full else 1e-3, 1e6
    transit = length / math.sqrt(E / DENSITY)
    pull = Pull(b=stress / (DENSITY * dx), first=length - dx, ramp=40.0 * transit)
    middle = 0.5 * depth
    gauge = Gauge(name="middle", a=(0.01, middle), b=(0.03, middle))
    scene = Scene(
        title="A bar under a dead load",
        domain=Domain(lower=(0.0, -0.003), upper=(length + 0.005, depth + 0.003), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(length, depth))),),
        rock=replace(elastic(E, 0.0, DENSITY), viscosity=BulkViscosity(c2=0.5)),
        loading=Loading(
            boundaries=(Fixed(axis=0, side="lower", position=0.0),),
            force_field=pull,
            cell=LoadCell(gauges=(gauge,)),
        ),
        schedule=Schedule(t_end=50.0 * transit, rows=200),
    )
    history = simulate(scene).history
    exact = stress**2 * depth * (length - 2.0 * dx / 3.0) / (2.0 * E)
    last = slice(-20, None)
    work, stored = history["work_J"][last].mean(), history["energy_elastic_J"][last].mean()
    why = "log and engineering strain differ by half of 6e-5; what still swings"
    rows = (
        relative("strain of the bar", stress / E, history["gauge_middle"][last].mean(), 2e-3, why),
        relative("elastic energy [J/m]", exact, stored, 0.01, "the last cell, 1/50 of the bar, holds a third as much"),
        relative("work [J/m]", exact, work, 0.01, "quasi-static: all of it is stored"),
        relative("work over elastic energy", 1.0, work / stored, 2e-3, "what still swings"),
    )
    return Outcome(rows, lambda figure: draw_energies(figure, history, "A bar under a dead load"))


@dataclass(frozen=True, kw_only=True)
class Cycles:
    """A start whose platens close and open again, again and again."""

    period: float  # [s]

    def factor(self, time: float) -> float:
        return math.sin(2.0 * math.pi * time / self.period)


def cycle(full: bool) -> Outcome:
    """An elastic column of nu = 0, pressed to 1e-3 and let go, twice: -E ln(1 - eps), and nothing left at the end."""
    height, width, dx, most = 0.1, 0.01, 1.25e-3 if full else 2.5e-3, 1e-3
    period = 40.0 * height / math.sqrt(E / DENSITY)
    speed = 0.5 * most * height * math.pi / period
    platens = tuple(
        Platen(axis=1, side=side, position=position, speed=sign * speed)
        for side, position, sign in (("lower", 0.0, 1.0), ("upper", height, -1.0))
    )
    scene = Scene(
        title="Loaded and unloaded twice",
        domain=Domain(lower=(-0.005, 0.0), upper=(width + 0.005, height), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(width, height))),),
        rock=elastic(E, 0.0, DENSITY),
        loading=Loading(boundaries=platens, start=Cycles(period=period), width=width),
        schedule=Schedule(t_end=2.0 * period, rows=200),
    )
    history = simulate(scene).history
    stress, work = history["stress_top_Pa"], history["work_J"]
    exact = -E * math.log(1.0 - most)
    # forces of a step's beginning go with the platens' speed of its end: dt/2 of the loop integral of F dv
    loops = 2.0 * 0.5 * math.pi**2 * scene.dt / period
    lag = f"a platen's work takes its newest speed: pi^2 dt/(2 T) a cycle is {loops:.2g}; and a margin of a third"
    plane = "a platen acts on the nodes where it started, 1/50 of a cell away"
    rows = (
        relative("largest stress [Pa]", exact, stress.max(), 0.01, plane),
        at_most("stress at the end over the largest", abs(stress[-1]) / exact, 0.01, "a row's mean, and what swings"),
        at_most("work at the end over the largest", abs(work[-1]) / work.max(), 4.0 / 3.0 * loops, lag),
        at_most("residual over the largest work", residual(history).max() / work.max(), 4.0 / 3.0 * loops, lag),
    )
    return Outcome(rows, lambda figure: draw_energies(figure, history, "Loaded and unloaded twice"))


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
