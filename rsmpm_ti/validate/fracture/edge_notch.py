"""A plate in tension with an edge notch, from none to five process zones deep: from strength to toughness.

Predicted: the nominal stress at the peak, from E, nu, sigma_t and G_f of `lab_rock`. A shallow notch ought to break at
sigma_t and a deep one at K_Ic = F(a/W) sigma sqrt(pi a); in between stands a cohesive crack of the same numbers and of
linear softening, solved by finite elements (`cohesive_reference.py`), which the runs are held against.

In both the ends do not turn and the side opposite to the notch is a mirror: the plate is half of one with a notch at
either edge, and does not bend. F is that of a tall plate (Tada, Paris & Irwin 2000, The Stress Analysis of Cracks
Handbook, 3rd ed., 2.7, within 0.5 %); of this one, which is as high as it is wide, elements give it too.

The servo slows the platens while the plate breaks. At half the time scale the peak of the third notch falls by 1 %.
"""

import math
from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti import lab_rock, simulate, uniaxial_test
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.results.result import Result
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.quasi_static.servo import Servo
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import compare, predict
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.validate.fracture.cohesive_reference import NOTCHES, PLATE, ROCK_ENERGY, ROCK_STRENGTH, read

DX, COARSE = 1.0 * mm, 2.0 * mm
"""A cell, and one of the quick tier; the mean is over two, and the notch three wide."""

COMPARED = NOTCHES[2]
"""Notch of the quick tier, which is run at both cell sizes in the full one [m]."""

TIME_SCALE, BEYOND = 4.0, 1.3
"""Strain at the end over that at which a whole plate reaches sigma_t."""

THROUGH = 0.95
"""Part of the peak by which the load has fallen where the plate has parted."""

START, REST = 4.0, 0.93
"""Cells of the notch's end past which the crack is looked at, and part of the width up to which."""

SOURCE = "cohesive crack of the same rock by finite elements"

ZONE = PLATE.plane_modulus * ROCK_ENERGY / ROCK_STRENGTH**2
"""l_ch = E' G_f/sigma_t^2 [m]."""


def notches(depth: float, dx: float) -> tuple[Slit, ...]:
    """The notch half way up the plate, with a round end; none where it has no depth."""
    if not depth:
        return ()
    width = 3.0 * dx
    below = 0.5 * width  # the slit's other end, which is rounded too, is no part of the plate
    middle = (0.5 * (depth - below), PLATE.length)
    return (Slit(centre=middle, length=depth + below, width=width, angle=0.0, rounded=True),)


@dataclass(frozen=True)
class Broken:
    """peak: nominal stress there [Pa]; cost: energy that the crack took per area [J/m^2], past the first START cells,
    where it sets out from a blunt notch, and up to REST of the width; strayed: its largest distance there from the
    notch's line [m], by the middle of what was dissipated."""

    peak: float
    cost: float = math.nan
    strayed: float = math.nan


def broken(result: Result, notch: float, dx: float) -> Broken:
    peak = result.summary["peak_filtered_Pa"]
    found = Broken(math.nan if peak is None else -float(peak))
    if not notch:
        return found
    state = result.snapshot
    x, energy = state.x - state.displacement, state.history["dissipated"] * state.volume
    slices = np.arange(notch + START * dx, REST * PLATE.depth, 2.0 * dx)
    at = np.digitize(x[:, 0], slices)
    spent = np.array([energy[at == k].sum() for k in range(1, len(slices))])
    moment = np.array([(energy * (x[:, 1] - PLATE.length))[at == k].sum() for k in range(1, len(slices))])
    if not (spent > 0.0).all():
        return found
    return replace(found, cost=float(spent.mean()) / (2.0 * dx), strayed=float(np.abs(moment / spent).max()))


def pulled(notch: float, dx: float, drop: float = 0.3) -> Broken:
    """A run until its load has fallen by a part of the peak."""
    scene = uniaxial_test(
        title="Plate with an edge notch in tension",
        rock=lab_rock(length=2.0 * dx),
        dx=dx,
        width=PLATE.depth,
        height=2.0 * PLATE.length,
        room=4.0 * dx,
        flaws=notches(notch, dx),
        speed=-2.5e-3,
        strain_end=-BEYOND * ROCK_STRENGTH / PLATE.plane_modulus,
        time_scale=TIME_SCALE,
        servo=Servo(),
        cfl=1.0,
        seeding=Jittered(amount=0.1, seed=1),
    )
    mirror = Wall(axis=0, side="upper", position=PLATE.depth)
    loading = replace(scene.loading, boundaries=(*scene.loading.boundaries, mirror))
    scene = replace(scene, loading=loading, schedule=replace(scene.schedule, stop_after_drop=drop))
    return broken(simulate(scene, threads=1), notch, dx)


def toughness_stress(notch: np.ndarray) -> np.ndarray:
    """Nominal stress [Pa] at which a tall plate with two edge notches reaches K_Ic: Tada, Paris & Irwin (2000), 2.7."""
    r = notch / PLATE.depth
    factor = (1.122 - 0.561 * r - 0.205 * r**2 + 0.471 * r**3 - 0.190 * r**4) / np.sqrt(1.0 - r)
    return math.sqrt(ROCK_ENERGY * PLATE.plane_modulus) / (factor * np.sqrt(math.pi * notch))


def depths(full: bool) -> Outcome:
    stored = {line["notch_m"]: line for line in read()["plate"]}
    dx = DX if full else COARSE
    runs = {
        notch: pulled(notch, dx, THROUGH if notch == COMPARED else 0.3)
        for notch in ((0.0, *NOTCHES) if full else (COMPARED,))
    }
    found, rows = {notch: run.peak for notch, run in runs.items()}, []
    for notch, got in found.items():
        name = f"strength, notch of {notch / ZONE:.2f} l_ch" if notch else "strength without a notch"
        expected = stored[notch]["peak_Pa"] if notch else ROCK_STRENGTH
        rows.append(compare(name, "MPa", expected / MPa, got / MPa, 0.05, SOURCE if notch else "sigma_t"))
    crack = runs[COMPARED]
    rows += [
        compare("what the crack cost per area", "J/m^2", ROCK_ENERGY, crack.cost, 0.05, "G_f of the rock"),
        compare("largest distance of the crack from the notch's line", "cells", 0.0, crack.strayed / dx, 2.0,
                "a straight notch, pulled evenly: Cotterell & Rice 1980, Int. J. Fract. 16:155", absolute=True),
    ]  # fmt: skip
    coarse = pulled(COMPARED, COARSE).peak if full else found[COMPARED]
    if full:
        name = f"the same, notch of {COMPARED / ZONE:.2f} l_ch, dx {COARSE / mm:g} mm"
        rows.append(predict(name, "MPa", coarse / MPa, "how far cell, notch's width and mean matter"))

    def draw(figure):
        axes = figure.subplots()
        notch = np.geomspace(0.1, 6.0, 100) * ZONE
        tall = toughness_stress(notch[notch < 0.9 * PLATE.depth]) / ROCK_STRENGTH
        axes.axhline(1.0, color="0.6", lw=0.9, label="strength, sigma_t")
        axes.plot(notch[: len(tall)] / ZONE, tall, color="0.6", ls="--", lw=0.9, label="toughness, a tall plate (Tada)")
        at = [n / ZONE for n in NOTCHES]
        axes.plot(at, [stored[n]["toughness_stress_Pa"] / ROCK_STRENGTH for n in NOTCHES], "k:", lw=0.9,
                  label="toughness, this plate, by elements")  # fmt: skip
        axes.plot([0.0, *at], [1.0, *(stored[n]["peak_Pa"] / ROCK_STRENGTH for n in NOTCHES)], "k-", lw=0.9,
                  label="cohesive crack, by elements")  # fmt: skip
        axes.plot([n / ZONE for n in found], [f / ROCK_STRENGTH for f in found.values()], "o", color="tab:red",
                  label=f"runs, dx {dx / mm:g} mm")  # fmt: skip
        if full:
            axes.plot(COMPARED / ZONE, coarse / ROCK_STRENGTH, "o", mfc="none", color="tab:red",
                      label=f"run, dx {COARSE / mm:g} mm")  # fmt: skip
        axes.set(xlabel="depth of the notch over l_ch = E' G_f/sigma_t^2", ylabel="nominal stress at the peak/sigma_t",
                 ylim=(0.0, 1.3), xlim=(-0.1, 5.5), title="Plate with an edge notch: strength, toughness")  # fmt: skip
        axes.legend()

    return Outcome(tuple(rows), draw)


GIVEN = "rock of the package, `lab_rock`"

CASES = (
    Experiment(
        "edge_notch", "plate with an edge notch, 0 to 5 process zones deep: strength, toughness and what is between",
        depths,
        inputs=(
            Input("E", PLATE.E, "Pa", GIVEN),
            Input("nu", PLATE.nu, "1", GIVEN),
            Input("tensile_strength", ROCK_STRENGTH, "Pa", GIVEN),
            Input("G_f_I", ROCK_ENERGY, "J/m^2", GIVEN),
            Input("averaging_length", 2.0 * DX, "m", "two cells, the least that the law allows"),
        ),
    ),
)  # fmt: skip
