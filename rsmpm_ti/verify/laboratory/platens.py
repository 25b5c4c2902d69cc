"""Platens where they are, that push and do not pull: long ways, a bar that hits one, one that comes from afar.

A bar without lateral strain (nu = 0) is one-dimensional, along any axis and in any dimension:

- squeezed between two platens: sigma = -E ln(1 - strain) (Hencky's strain, which Hooke's law in rates integrates to);
- meeting a platen at speed v: rho c v from the first touch on until the wave is back from the free end, 2 L/c later;
  then it leaves at v, and nothing holds it (Graff 1975, Wave motion in elastic solids, sec. 2.4).
"""

import itertools
import math
from dataclasses import replace

import numpy as np

from rsmpm_ti import simulate
from rsmpm_ti.analysis.load_curve import load_at
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative, seen
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine, AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

E, DENSITY = 17e9, 2600.0
C = math.sqrt(E / DENSITY)
"""Speed of waves along the bar [m/s]."""

LENGTH, WIDTH = 40e-3, 8e-3
"""Of the bar [m]. Between plane ends it buckles at a strain of (pi^2/3)(WIDTH/LENGTH)^2 = 13 % (Euler)."""

SQUEEZES = (0.01, 0.02, 0.049)
"""Strains at which the load is read; five rows of particles have then been run over by a platen that stays behind."""

GAP, SPEED = 5, 10.0
"""Cells between the bar and a platen that comes, and its speed [m/s]."""

WAYS = tuple(itertools.product((2, 3), (0, 1)))
"""Dimensions and axes; in 3D also along the last."""


def bar(
    dim: int, axis: int, *, dx: float, gap: int = 0, speeds: tuple[float, float], schedule: Schedule, start=None, **body
) -> Scene:
    """A bar along an axis between two platens, the upper one `gap` cells away from it."""

    def corner(along: float, across: float) -> tuple[float, ...]:
        return tuple(along if d == axis else across for d in range(dim))

    top = LENGTH + gap * dx
    platens = (
        Platen(axis=axis, side="lower", position=0.0, speed=speeds[0]),
        Platen(axis=axis, side="upper", position=top, speed=speeds[1]),
    )
    return Scene(
        title="a bar between platens",
        domain=Domain(lower=corner(0.0, -2.0 * dx), upper=corner(top, WIDTH + 2.0 * dx), dx=dx),
        bodies=(Body(region=Box(lower=corner(0.0, 0.0), upper=corner(LENGTH, WIDTH)), **body),),
        rock=Rock(density=DENSITY, elasticity=Hooke(E=E, nu=0.0), criterion=Unbreakable()),
        loading=Loading(boundaries=platens, start=start or AtRest(), width=WIDTH ** (dim - 1)),
        schedule=schedule,
    )


def squeeze(dim: int, axis: int, dx: float) -> list[Row]:
    """To a strain of 5 %, and what the row beside a platen carries against the bulk at 1 %."""
    speed = 0.4  # inertia beside the load: (rho c v/2)/sigma, 1e-3 of it at 1 %
    end = Schedule(strain_end=1.02 * max(SQUEEZES))
    scene = bar(dim, axis, dx=dx, speeds=(speed, -speed), schedule=end, start=Affine())
    rows, history = [], simulate(scene).history
    for strain in SQUEEZES:
        at = float(np.interp(strain, history["axial_strain"], history["time_s"]))
        stress = float(load_at(history, at)[0])
        why = "kinetic energy of the squeeze, and second order of the stress update in the strain of a step"
        rows.append(
            relative(f"{dim}D, axis {axis}: load at {strain:g} [Pa]", -E * math.log1p(-strain), stress, 1e-3, why)
        )
    final = simulate(replace(scene, schedule=Schedule(strain_end=SQUEEZES[0]))).snapshot
    place, sigma = final.x[:, axis], final.sigma[:, axis, axis]
    beside = place > place.max() - 0.1 * dx
    bulk = np.abs(place - place.mean()) < 0.25 * LENGTH
    name = f"{dim}D, axis {axis}: row beside the platen over bulk at {SQUEEZES[0]:g}"
    why = "uniform strain is exact on a grid that goes with the platens; what swings is 0.1 %"
    return [*rows, relative(name, 1.0, sigma[beside].mean() / sigma[bulk].mean(), 0.005, why)]


def hit(dim: int, axis: int, dx: float, threads: int = 1) -> list[Row]:
    """It comes down at SPEED on the platen that it touches, and leaves."""
    down = tuple(-SPEED if d == axis else 0.0 for d in range(dim))
    end = Schedule(t_end=3.0 * LENGTH / C, rows=600)
    scene = bar(dim, axis, dx=dx, gap=GAP, speeds=(0.0, 0.0), schedule=end, velocity=down)
    result = simulate(scene, threads=threads)
    history, back = result.history, 2.0 * LENGTH / C
    time, load = history["time_s"], history["stress_bottom_Pa"]
    held = (time > 0.2 * back) & (time < 0.8 * back)
    why = "a wave front is three cells wide, and swings behind it die out slowly"
    name = f"{dim}D, axis {axis}" + (f", {threads} threads" if threads > 1 else "")
    impulse = float(np.sum(load * np.diff(time, prepend=0.0)))
    leaves = result.snapshot.velocity[:, axis].mean()
    rest = "a front of some cells lags, and leaves swings in the bar; how much was not derived"
    given = impulse / (DENSITY * LENGTH) - SPEED
    return [
        relative(f"{name}: load of the hit [Pa]", DENSITY * C * SPEED, load[held].mean(), 0.03, why),
        relative(f"{name}: impulse [Pa s]", 2.0 * DENSITY * LENGTH * SPEED, impulse, 2.0 * dx / LENGTH, rest),
        at_most(f"{name}: pull [Pa]", float(-load.min()), 0.0, "it pushes alone: to the last bit"),
        relative(
            f"{name}: leaves at [m/s]", given, float(leaves), 1e-9, "momentum: what the platen gave, to round-off"
        ),
        seen(f"{name}: of the speed with which it came", float(leaves) / SPEED, "1 for a bar without cells"),
    ]


def comes(dim: int, axis: int, dx: float) -> list[Row]:
    """A platen from five cells away: what it reads before it arrives, when it does, and then."""
    arrives = GAP * dx / SPEED
    end = Schedule(t_end=arrives + 0.8 * LENGTH / C, cfl=0.4, rows=2000)
    scene = bar(dim, axis, dx=dx, gap=GAP, speeds=(0.0, -SPEED), schedule=end)
    history = simulate(scene).history
    time, load = history["time_s"], history["stress_top_Pa"]
    first = float(time[np.argmax(load > 0.0)]) if (load > 0.0).any() else math.nan
    held = time > arrives + 0.4 * LENGTH / C
    why = "a twentieth of a cell over its way of five (Contacts.tolerance)"
    return [
        relative(f"{dim}D, axis {axis}: platen arrives [s]", arrives, first, 0.01, why),
        relative(
            f"{dim}D, axis {axis}: and presses [Pa]", DENSITY * C * SPEED, load[held].mean(), 0.03, "front and swings"
        ),
    ]


def platens(full: bool) -> Outcome:
    """Along each axis in 2D and 3D, and finer; quick: in 2D along y."""
    ways = [(2, 1, 2e-3)] + [
        (2, 0, 2e-3),
        (2, 1, 1e-3),
        (2, 1, 0.5e-3),
        (3, 0, 2e-3),
        (3, 1, 2e-3),
        (3, 2, 2e-3),
    ] * full
    rows = [row for way in ways for test in (squeeze, hit, comes) for row in test(*way)]
    if full:
        rows += hit(2, 1, 2e-3, threads=2)

    def draw(figure):
        axes = figure.subplots()
        judged = [row for row in rows if row.tolerance > 0.0]
        for k, row in enumerate(judged):
            axes.barh(k, 100.0 * row.error, color="tab:blue" if row.passed else "tab:red")
        axes.set_yticks(range(len(judged)), [row.quantity for row in judged], fontsize=6)
        axes.set(xlabel="against closed form [%]", title="bars between platens")

    return Outcome(tuple(rows), draw)


CASES = (Case("lab_platens", "bars squeezed far, hitting a platen, met by one: axes, dimensions, threads", platens),)
