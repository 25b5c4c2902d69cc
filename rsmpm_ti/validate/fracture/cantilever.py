"""A double cantilever beam: two arms pulled apart at their ends, while a crack grows between them along the middle.

Predicted: load against opening, and the crack's length, from E, nu and G_f. Held against beam theory at G = G_f with
arms that also turn and give at the crack's tip (Kanninen 1973, Int. J. Fracture 9:83): an arm of depth h is as soft as
one clamped 0.64 h behind the tip, x = a + 0.64 h. Along the notch, of length n, arms are thinner by half of its width,
k deep:

    w = 8 P (n^3/k^3 + (x^3 - n^3)/h^3)/E',    G = 12 P^2 x^2/(E' h^3).

The middle is a plane of strength sigma_t between arms that do not break, as side grooves are cut for in tests: without,
a crack between arms that bend is not stable in its direction (Cotterell & Rice 1980, Int. J. Fracture 16:155), and
arms of l_ch = E' G_f/sigma_t^2, as these are, break off at the notch. How strength is lost at the tip hardly matters to
the loads, by the J-integral, but it does to where the crack ends. The arms hang on one node each, as on pins.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from rsmpm_ti import lab_rock, simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.records.snapshot import TENSION
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.slow import slow_time_scale
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import mm
from rsmpm_ti.validate.comparison import compare
from rsmpm_ti.validate.experiment import Experiment, Input

ARM, LENGTH, NOTCH = 20.0 * mm, 164.0 * mm, 60.0 * mm
"""Depth of an arm, length of the specimen, and depth of the notch from the load on [m]."""

INSET = 4.0 * mm
"""Of the load from the end [m]."""

DX = 1.0 * mm

SLIT = 3.0 * DX
"""Width of the notch [m]: fewer cells do not part."""

PLANE, STRONGER = 4.0 * DX, 100.0
"""Width of the plane in which the crack grows [m], and strength of the rest over its own."""

ROOT = 0.64
"""Length by which the root lengthens an arm, over its depth: Kanninen (1973)."""

PIN = 0.3
"""Half width of a pin over a cell: one node."""

ENERGY = 5.0
"""G_f of `lab_rock` [J/m^2]."""

SPEED = 5e-3
"""Of each arm's end [m/s]."""

OPENINGS, END = (95e-6, 110e-6, 125e-6), 130e-6
"""At which the loads are compared, and at the end [m]; the crack leaves the notch at 84 um."""

THEORY = "beam theory with Kanninen's root (1973)"


@dataclass(frozen=True, kw_only=True)
class WeakPlane:
    """The strength as it is within `width` [m] about the plane y = 0, and STRONGER elsewhere."""

    width: float

    varies = True

    def factors(self, x: np.ndarray, volume: np.ndarray) -> np.ndarray:
        return np.where(np.abs(x[:, 1]) < 0.5 * self.width, 1.0, STRONGER)


@dataclass(frozen=True)
class Beams:
    """Both arms, by beam theory. Loads per thickness [N/m]."""

    modulus: float
    energy: float

    def compliance(self, crack: float) -> float:
        """Opening over load [m^2/N]."""
        thin, x = ARM - 0.5 * SLIT, crack + ROOT * ARM
        return 8.0 * ((NOTCH / thin) ** 3 + (x**3 - NOTCH**3) / ARM**3) / self.modulus

    def load(self, crack: float) -> float:
        """At which G is G_f [N/m]."""
        return math.sqrt(self.energy * self.modulus * ARM**3 / 12.0) / (crack + ROOT * ARM)

    def opening(self, crack: float) -> float:
        """At which G is G_f [m]."""
        return self.load(crack) * self.compliance(crack)

    def crack(self, opening: float) -> float:
        """Length of a crack that an opening has made grow [m]."""
        return float(brentq(lambda crack: self.opening(crack) - opening, NOTCH, LENGTH))


def rock_of() -> Rock:
    rock = lab_rock(G_f_I=ENERGY, length=2.0 * DX)
    return replace(rock, heterogeneity=WeakPlane(width=PLANE))


def scene_of(rock: Rock, beams: Beams) -> Scene:
    room, pin = 4.0 * DX, PIN * DX
    tip, outside = INSET + NOTCH, 0.5 * SLIT  # so that its other end, which is rounded too, is no part of an arm
    slit = Slit(centre=(0.5 * (tip - outside), 0.0), length=tip + outside, width=SLIT, angle=0.0, rounded=True)
    # first swing of a clamped beam, 1.875^2 sqrt(E' I/(rho A))/a^2: Blevins (1979), table 8-1
    swing = 2.0 * math.pi * (NOTCH + ROOT * ARM) ** 2 / (3.516 * ARM * math.sqrt(beams.modulus / (12.0 * rock.density)))
    duration = beams.opening(NOTCH) / (2.0 * SPEED)
    ends = (INSET - pin, INSET + pin)
    return Scene(
        title="Double cantilever beam",
        domain=Domain(lower=(-room, -ARM), upper=(LENGTH + room, ARM), dx=DX),
        bodies=(
            Body(
                region=Difference(whole=Box(lower=(0.0, -ARM), upper=(LENGTH, ARM)), removed=(slit,)),
                seeding=Jittered(amount=0.1, seed=1),
            ),
        ),
        rock=rock,
        loading=Loading(
            boundaries=(
                Platen(axis=1, side="lower", position=-ARM, speed=-SPEED, pulls=True, span=ends),
                Platen(axis=1, side="upper", position=ARM, speed=SPEED, pulls=True, span=ends),
            ),
            start=Ramp(time=duration / 2.0), time_scale=slow_time_scale(duration, swing), width=LENGTH,
            local_damping=AUTO_DAMPING,
            cell=LoadCell(gauges=(Gauge(name="ends", a=(INSET, -0.5 * ARM), b=(INSET, 0.5 * ARM), reads="opening"),)),
        ),
        schedule=Schedule(strain_end=-END / (2.0 * ARM), cfl=1.0),
        transfer=PicFlip(),
    )  # fmt: skip


def pulled(_full: bool) -> Outcome:
    rock = rock_of()
    beams = Beams(rock.elasticity.E / (1.0 - rock.elasticity.nu**2), ENERGY)
    result = simulate(scene_of(rock, beams), threads=1)
    history, state = result.history, result.snapshot
    opening, load = history["gauge_ends_m"], -0.5 * (history["force_top_N"] + history["force_bottom_N"])
    begins, end = beams.opening(NOTCH), float(opening[-1])
    early = (opening > 0.2 * begins) & (opening < 0.5 * begins)
    softness = 1.0 / float(np.polyfit(opening[early], load[early], 1)[0])
    rows = [
        compare("compliance of the notched specimen", "um m/kN", 1e9 * beams.compliance(NOTCH), 1e9 * softness, 0.03,
                THEORY)
    ]  # fmt: skip
    reached = np.maximum.accumulate(opening)
    for w in OPENINGS:
        near = np.abs(reached - w) < 0.02 * w  # the mean over what is left of swings
        got = float(np.mean(load[near] * np.sqrt(reached[near] / w)))
        rows.append(
            compare(f"load at {1e6 * w:.0f} um", "kN/m", 1e-3 * beams.load(beams.crack(w)), 1e-3 * got, 0.03, THEORY)
        )
    broken = (state.x - state.displacement)[state.failure_mode == TENSION]
    length = float(broken[:, 0].max()) - INSET
    rows.append(
        compare("length of the crack at the end", "mm", beams.crack(end) / mm, length / mm, 0.03, THEORY,
                beyond="half of the strength is lost ahead of where beam theory puts a sharp tip")
    )  # fmt: skip

    def draw(figure):
        above, below = figure.subplots(2, 1, height_ratios=(2, 1))
        grown = np.linspace(NOTCH, beams.crack(end), 50)
        above.plot(1e6 * opening, 1e-3 * load, color="tab:red", lw=0.9, label="run")
        above.plot([1e6 * beams.opening(a) for a in grown], [1e-3 * beams.load(a) for a in grown], "k--", lw=0.9,
                   label="beam theory, G = G_f")  # fmt: skip
        still = np.array([0.0, begins])
        above.plot(1e6 * still, 1e-3 * still / beams.compliance(NOTCH), "k:", lw=0.9, label="beam theory, the notch")
        above.set(xlabel="opening of the ends [um]", ylabel="load [kN/m]", title="Double cantilever beam")
        above.legend()
        place = (state.x - state.displacement) / mm
        seen = below.scatter(*place.T, c=state.damage, s=1.5, cmap="magma_r", vmin=0.0, vmax=1.0)
        below.axvline((INSET + beams.crack(end)) / mm, color="k", lw=0.7, ls="--")
        below.set(aspect="equal", xlabel="x [mm]", ylabel="y [mm]")
        figure.colorbar(seen, ax=below, label="strength lost")

    return Outcome(tuple(rows), draw)


GIVEN = "rock of the package, `lab_rock`"

CASES = (
    Experiment(
        "cantilever", "double cantilever beam: load and crack length against opening, by beam theory", pulled,
        inputs=(
            Input("E", 17e9, "Pa", GIVEN),
            Input("nu", 0.14, "1", GIVEN),
            Input("tensile_strength", 2e6, "Pa", GIVEN),
            Input("G_f_I", ENERGY, "J/m^2", GIVEN),
            Input("averaging_length", 2.0 * DX, "m", "two cells, the least that the law allows"),
        ),
        quick=False,
    ),
)  # fmt: skip
