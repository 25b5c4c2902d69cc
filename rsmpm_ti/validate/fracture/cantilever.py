"""A double cantilever beam: two arms pulled apart at their ends, while a crack grows between them along the middle.

Predicted: load against opening, and the crack's length, from E, nu, sigma_t and G_f. Held against beam theory at
G = G_f, with arms that also turn and give at the crack's tip (Kanninen 1973, Int. J. Fract. 9:83): an arm of depth h is
as soft as one clamped 0.64 h behind the tip, x = a + 0.64 h.

Arms of l_ch = E' G_f/sigma_t^2 must bend to f_t sqrt(3 l_ch/h), beyond their strength, and a crack between arms that
bend is not stable in its direction: beside its tip there is tension along it (Cotterell & Rice 1980, Int. J. Fract.
16:155). So both ends are pressed along the beam, as Benbow & Roesler (1957), Proc. Phys. Soc. B 70:201, did to split
bars straight. The thrust N on an arm releases no energy of its own; it makes the arm a beam-column (Timoshenko & Gere
1961, Theory of Elastic Stability, ch. 1): with k = sqrt(12 N/(E' h^3)),

    M = P tan(k x)/k,    G = 12 M^2/(E' h^3),
    w = 2 P (tan(k x) - k x)/(N k) + 8 P n^3 (1/t^3 - 1/h^3)/E' - 12 N e n^2/(E' t^3),

P per thickness, w the opening, n the notch's length, along which arms are t = h - 2 e thick. The thrust acts on the
middle line of the whole arm, and so bends the thinner ones together. How strength is lost at the tip hardly matters to
the loads, by the J-integral, but it does to where the crack ends. The arms hang on one node each, as on pins.
"""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import brentq

from rsmpm_ti import lab_rock, simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.records.snapshot import TENSION, Snapshot
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.slow import slow_time_scale
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.holes.pressure import HolePressure
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import compare, predict
from rsmpm_ti.validate.experiment import Experiment, Input

ARM, LENGTH, NOTCH = 20.0 * mm, 164.0 * mm, 60.0 * mm
"""Depth of an arm, length of the specimen, and depth of the notch from the load on [m]."""

INSET = 4.0 * mm
"""Of the load from the end [m]."""

DX = 1.0 * mm

SLIT = 3.0 * DX
"""Width of the notch [m]: fewer cells do not part."""

THIN = ARM - 0.5 * SLIT
"""Of an arm along the notch [m]."""

PRESSURE, PRESSED = 4.0 * MPa, 13.0 * mm
"""On each arm's ends, and its height about the arm's middle line [m], which leaves corners alone: 2.6 MPa in an arm,
1.3 times the strength in tension and a tenth of that in compression."""

ROOT = 0.64
"""Length by which the root lengthens an arm, over its depth: Kanninen (1973)."""

PIN = 0.3
"""Half width of a pin over a cell: one node."""

ENERGY = 5.0
"""G_f of `lab_rock` [J/m^2]."""

SPEED = 5e-3
"""Of each arm's end [m/s]."""

SLOWER = 2.0
"""Than would do until the peak: the beam goes on swinging while the crack grows."""

OPENINGS, END, AROUND = (125e-6, 150e-6, 175e-6), 190e-6, 0.07
"""At which the loads are compared, and at the end [m], and part of an opening over which a load is the mean, since the
arms swing. By theory the crack leaves the notch at 69 um; it leaves a blunt one of three cells later."""

THEORY = "beam theory with Kanninen's root (1973)"


@dataclass(frozen=True)
class Beams:
    """Both arms, by beam theory. Loads per thickness [N/m]; thrust: of each arm [N/m]."""

    modulus: float
    energy: float
    thrust: float = PRESSURE * PRESSED

    @property
    def wave(self) -> float:
        """k of a beam-column [1/m]."""
        return math.sqrt(12.0 * self.thrust / (self.modulus * ARM**3))

    @property
    def closed(self) -> float:
        """By how much the thrust alone closes the ends [m]."""
        return 12.0 * self.thrust * 0.25 * SLIT * NOTCH**2 / (self.modulus * THIN**3)

    def compliance(self, crack: float) -> float:
        """Opening over load [m^2/N]."""
        x = self.wave * (crack + ROOT * ARM)
        bent = 2.0 * (math.tan(x) - x) / (self.thrust * self.wave)
        return bent + 8.0 * NOTCH**3 * (THIN**-3 - ARM**-3) / self.modulus

    def load(self, crack: float) -> float:
        """At which G is G_f [N/m]."""
        moment = math.sqrt(self.energy * self.modulus * ARM**3 / 12.0)
        return moment * self.wave / math.tan(self.wave * (crack + ROOT * ARM))

    def opening(self, crack: float) -> float:
        """At which G is G_f [m]."""
        return self.load(crack) * self.compliance(crack) - self.closed

    def crack(self, opening: float) -> float:
        """Length of a crack that an opening has made grow [m]."""
        return float(brentq(lambda crack: self.opening(crack) - opening, NOTCH, LENGTH))


def scene_of(rock: Rock, beams: Beams) -> Scene:
    room, pin = 4.0 * DX, PIN * DX
    tip, outside = INSET + NOTCH, 0.5 * SLIT  # so that its other end, which is rounded too, is no part of an arm
    slit = Slit(centre=(0.5 * (tip - outside), 0.0), length=tip + outside, width=SLIT, angle=0.0, rounded=True)
    # first swing of a clamped beam, 1.875^2 sqrt(E' I/(rho A))/a^2: Blevins (1979), table 8-1
    swing = 2.0 * math.pi * (NOTCH + ROOT * ARM) ** 2 / (3.516 * ARM * math.sqrt(beams.modulus / (12.0 * rock.density)))
    duration = beams.opening(NOTCH) / (2.0 * SPEED)
    ends = (INSET - pin, INSET + pin)
    pressed = (0.5 * (side * ARM - PRESSED) for side in (-1.0, 1.0))
    beyond = ((-room, 0.0), (LENGTH, LENGTH + room))
    faces = [Box(lower=(a, y), upper=(b, y + PRESSED)) for y in pressed for a, b in beyond]
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
            start=Ramp(time=duration / 2.0), time_scale=slow_time_scale(duration, swing) / SLOWER, width=LENGTH,
            local_damping=AUTO_DAMPING,
            holes=tuple(HolePressure(region=face, times=(0.15 * duration,), pressures=(PRESSURE,)) for face in faces),
            cell=LoadCell(gauges=(Gauge(name="ends", a=(INSET, -0.5 * ARM), b=(INSET, 0.5 * ARM), reads="opening"),)),
        ),
        schedule=Schedule(strain_end=-END / (2.0 * ARM), cfl=1.0, rows=3000),
        transfer=PicFlip(),
    )  # fmt: skip


@dataclass(frozen=True)
class Curve:
    """opening [m] and load [N/m] of a run, and its largest opening so far."""

    opening: np.ndarray
    load: np.ndarray
    reached: np.ndarray

    def softness(self, begins: float) -> float:
        """Opening over load [m^2/N], from 0.2 to 0.5 of the opening at which the crack begins to grow."""
        early = (self.opening > 0.2 * begins) & (self.opening < 0.5 * begins)
        return 1.0 / float(np.polyfit(self.opening[early], self.load[early], 1)[0])

    def load_at(self, opening: float, closed: float) -> float:
        """Mean about an opening, each load as theory carries it there, as 1/sqrt of the opening and what the thrust
        takes of it."""
        near = np.abs(self.reached - opening) < AROUND * opening
        return float(np.mean(self.load[near] * np.sqrt((self.reached[near] + closed) / (opening + closed))))


def pulled(scene: Scene) -> tuple[Curve, Snapshot]:
    result = simulate(scene, threads=1)
    history = result.history
    assert result.snapshot is not None
    opening, load = history["gauge_ends_m"], -0.5 * (history["force_top_N"] + history["force_bottom_N"])
    return Curve(opening, load, np.maximum.accumulate(opening)), result.snapshot


def grown(_full: bool) -> Outcome:
    rock = lab_rock(G_f_I=ENERGY, length=2.0 * DX)
    beams = Beams(rock.elasticity.E / (1.0 - rock.elasticity.nu**2), ENERGY)
    scene = scene_of(rock, beams)
    run, state = pulled(scene)
    faster, _ = pulled(replace(scene, loading=replace(scene.loading, time_scale=SLOWER * scene.time_scale)))
    whole, begins, end = scene.elastic(), beams.opening(NOTCH), float(run.opening[-1])
    whole, _ = pulled(replace(whole, schedule=replace(whole.schedule, strain_end=-0.6 * begins / (2.0 * ARM))))
    name, unit = "compliance of the notched specimen", "um m/kN"
    rows = [
        compare(name, unit, 1e9 * beams.compliance(NOTCH), 1e9 * run.softness(begins), 0.03, THEORY),
        predict(f"{name}, rock that does not break", unit, 1e9 * whole.softness(begins), "what is not the crack's"),
    ]
    for w in OPENINGS:
        theory, name = beams.load(beams.crack(w)), f"load at {1e6 * w:.0f} um"
        rows.append(compare(name, "kN/m", 1e-3 * theory, 1e-3 * run.load_at(w, beams.closed), 0.03, THEORY))
        fast = 1e-3 * faster.load_at(w, beams.closed)
        rows.append(predict(f"{name}, loaded twice as fast", "kN/m", fast, "how far the pace matters"))
    broken = (state.x - state.displacement)[state.failure_mode == TENSION]
    length = float(broken[:, 0].max()) - INSET
    rows.append(
        compare("length of the crack at the end", "mm", beams.crack(end) / mm, length / mm, 0.03, THEORY,
                beyond="half of the strength is lost ahead of where beam theory puts a sharp tip")
    )  # fmt: skip

    def draw(figure):
        above, below = figure.subplots(2, 1, height_ratios=(2, 1))
        cracks = np.linspace(NOTCH, beams.crack(end), 50)
        above.plot(1e6 * run.opening, 1e-3 * run.load, color="tab:red", lw=0.9, label="run")
        above.plot([1e6 * beams.opening(a) for a in cracks], [1e-3 * beams.load(a) for a in cracks], "k--", lw=0.9,
                   label="beam theory, G = G_f")  # fmt: skip
        still = np.array([0.0, begins])
        above.plot(
            1e6 * still,
            1e-3 * (still + beams.closed) / beams.compliance(NOTCH),
            "k:",
            lw=0.9,
            label="beam theory, the notch",
        )
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
        "cantilever", "double cantilever beam: load and crack length against opening, by beam theory", grown,
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
