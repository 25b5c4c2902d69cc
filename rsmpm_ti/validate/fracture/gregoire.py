"""A concrete beam with a notch of half its depth, in three-point bending (Gregoire et al. 2013): its whole load curve.

Predicted: load against the opening of the notch's mouth, from E, sigma_t and G_f that the source gives, and nothing
else. Nothing is fitted. Softening and plane stress were chosen before any run:

- Strength falls exponentially with the opening, as of concrete: steep first, with a long tail (Reinhardt, Cornelissen
  & Hordijk 1986, J. Struct. Eng. 112:2462; Cornelissen, Hordijk & Reinhardt 1986, Heron 31(2):45). Linear softening of
  the same energy is drawn beside it.
- Plane stress: the beam is as thick as it is deep and strength is lost over seven of its depths, so that nothing holds
  its sides. In plane strain it would be 4 % stiffer.
- The mean stress is over two cells, the least that the law allows, and the notch is three cells wide.
  `cohesive_reference.py` has neither: what lies between it and the runs is the code's own error.

What is found: the source's numbers themselves overstate these beams, since a cohesive crack of the same E, sigma_t and
G_f costs 1.6 times what they did, and leaves the band at the peak. G_f of the source is not what a ligament of 25 mm
costs: near a face a crack costs less (Duan, Hu & Wittmann 2007, Eng. Fract. Mech. 74:87). From 0.002 to 0.022 mm, where
the beams peak, the cohesive crack is inside the band.

The beam is 140 mm long, not 175: nothing acts beyond its supports. No servo, and the pace of PACE: chosen after runs at
several, as the fastest at which the load swings by no more than 5 %. At a third of it the peak, which is one of the
swings, falls by 4 % at dx 2 mm, and the energy by 2.6 %.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.integrate import trapezoid

from rsmpm_ti import bending_test, load_rock, simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import mm
from rsmpm_ti.validate.comparison import Comparison, compare, predict
from rsmpm_ti.validate.data.tables import Band, gregoire
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.validate.fracture.cohesive_reference import BEAM, CONCRETE_ENERGY, CONCRETE_STRENGTH, read

THICKNESS = 50.0 * mm

CELLS = (2.0 * mm, 1.0 * mm, 0.5 * mm)
"""Sizes of a cell [m]; the last is held against the experiment."""

PACE, END = 0.0127 * mm, 0.133 * mm
"""Deflections of the upper roller: of an elastic beam at the peak load of the cohesive crack, twice as much as where
beam theory reaches the strength; and at an opening of 0.2 mm."""

DATUM = "gregoire_half_notch.csv"


@dataclass(frozen=True)
class Curve:
    """Load [N] against the opening of the mouth [m]."""

    opening: np.ndarray
    load: np.ndarray

    def at(self, opening: np.ndarray | float) -> np.ndarray:
        """Load where the opening first reached a value."""
        return np.interp(opening, np.maximum.accumulate(self.opening), self.load)

    def inside(self, band: Band) -> float:
        """Fraction of the band's openings at which the load is inside it."""
        load = self.at(band.opening)
        return float(np.mean((load >= band.low) & (load <= band.high)))

    @property
    def peak(self) -> float:
        return float(self.load.max())

    def energy(self, end: float) -> float:
        """Area below it up to an opening [J]."""
        opening = np.linspace(0.0, end, 400)
        return float(trapezoid(self.at(opening), opening))


def bend(dx: float) -> Curve:
    rock = load_rock("gregoire_concrete", dx=dx)
    scene = bending_test(
        title="Half-notched concrete beam",
        rock=replace(rock, elasticity=replace(rock.elasticity, plane_stress=BEAM.plane_stress)),
        dx=dx,
        depth=BEAM.depth,
        span=BEAM.span,
        notch=BEAM.notch,
        deflection_end=END,
        deflection_peak=PACE,
        gauge_length=BEAM.gauge,
        servo=None,
        seeding=Jittered(amount=0.1, seed=1),
    )
    history = simulate(scene, threads=1).history
    load = 0.5 * (history["force_top_N"] + history["force_bottom_N"])
    return Curve(history["gauge_mouth_m"], THICKNESS * load)


def cohesive(softening: str) -> Curve:
    """Of a cohesive crack in the same beam, by finite elements."""
    stored = read()["beam"][softening]
    return Curve(np.array(stored["opening_m"]), THICKNESS * np.array(stored["load_N_per_m"]))


def rows_of(got: Curve, theory: Curve, band: Band) -> list[Comparison]:
    end, source = float(band.opening[-1]), band.source
    low, high = (Curve(np.append(0.0, band.opening), np.append(0.0, load)) for load in (band.low, band.high))
    costs = 0.5 * (low.energy(end) + high.energy(end))
    share, cost = theory.inside(band), theory.energy(end) / costs
    why = (
        f"of the same numbers a cohesive crack by finite elements peaks at {theory.peak:.0f} N, costs {cost:.2f} times "
        f"what the beams did, and is inside at {100.0 * share:.0f} % of the openings"
    )
    most = slice(int(np.argmax(band.low)), int(np.argmax(band.high)) + 1)
    widest = (float(band.opening[most][0]) / mm, float(band.opening[most][-1]) / mm)

    def held(quantity, unit, bounds, predicted, target):
        return compare(
            quantity, unit, 0.5 * sum(bounds), predicted, target, source, band=bounds, datum=DATUM, beyond=why
        )

    rows = [
        compare("openings at which the load is inside the band", "1", 1.0, got.inside(band), 0.1, source, datum=DATUM,
                beyond=why),
        held("peak load", "N", (low.peak, high.peak), got.peak, 0.1),
        held("opening at the peak", "mm", widest, float(got.opening[np.argmax(got.load)]) / mm, 0.1),
    ]  # fmt: skip
    for opening in (0.01, 0.1, 0.2):
        bounds = (float(low.at(opening * mm)), float(high.at(opening * mm)))
        rows.append(held(f"load at {opening:g} mm", "N", bounds, float(got.at(opening * mm)), 0.1))
    rows.append(held(f"energy to {end / mm:.2f} mm", "J", (low.energy(end), high.energy(end)), got.energy(end), 0.1))
    return rows


def whole_curve(_full: bool) -> Outcome:
    band, theory = gregoire(), cohesive("exponential")
    curves = {dx: bend(dx) for dx in CELLS}
    finest = min(curves)
    rows = rows_of(curves[finest], theory, band)
    rows += [
        predict("openings inside the band, cohesive crack", "1", theory.inside(band), "by finite elements"),
        compare("peak load against that of the cohesive crack", "N", theory.peak, curves[finest].peak, 0.05,
                "cohesive crack by finite elements"),
    ]  # fmt: skip
    rows += [predict(f"peak load, dx {d / mm:g} mm", "N", c.peak, "coarser") for d, c in curves.items() if d > finest]

    def draw(figure):
        axes = figure.subplots()
        axes.fill_between(band.opening / mm, band.low, band.high, color="0.85", label="measured")
        for dx, curve in curves.items():
            axes.plot(curve.opening / mm, curve.load, lw=1.2, label=f"predicted, dx {dx / mm:g} mm")
        for softening, style in (("exponential", "k--"), ("linear", "k:")):
            curve = cohesive(softening)
            axes.plot(curve.opening / mm, curve.load, style, lw=0.9, label=f"cohesive crack, {softening}")
        axes.set(xlabel="opening of the notch's mouth [mm]", ylabel="load [N]", xlim=(0.0, 0.21), ylim=(0.0, None),
                 title="Half-notched concrete beam (Gregoire et al. 2013)")  # fmt: skip
        axes.legend()

    return Outcome(tuple(rows), draw)


SOURCE = gregoire().source

CASES = (
    Experiment(
        "gregoire", "half-notched concrete beam: load against the opening of the notch's mouth", whole_curve,
        inputs=(
            Input("E", BEAM.E, "Pa", SOURCE),
            Input("nu", BEAM.nu, "1", SOURCE),
            Input("density", 2346.0, "kg/m^3", SOURCE),
            Input("tensile_strength", CONCRETE_STRENGTH, "Pa", SOURCE),
            Input("G_f_I", CONCRETE_ENERGY, "J/m^2", SOURCE),
            Input("averaging_length", 2.0 * min(CELLS), "m", "two cells, the least that the law allows"),
        ),
        judged=(DATUM,),
        quick=False,
    ),
)  # fmt: skip
