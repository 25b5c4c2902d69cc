"""A crack that runs through a strip of PMMA: how fast, and when it branches.

A strip between two grips that are drawn apart and then held; a crack runs from a notch through what is then stored. The
grips leave lateral motion free, so that no crack starts at their corners. The energy that a long crack finds, per area
E eps^2 H/2 in a strip of height H (Rice 1967, J. Appl. Mech. 34:248), is as many times G_f as a run is given. A crack
in tension stays below the Rayleigh speed (Freund 1990, sec. 7.4). Measured on PMMA: at 330 +- 30 m/s its speed begins
to swing, its mean acceleration falls sharply, and a pattern forms on its faces (Fineberg, Gross, Marder & Swinney 1992,
Phys. Rev. B 45:5146). Predicted from E, nu, density, K_Ic and sigma_t of the shelf's PMMA; the strength is what the
cells carry (tough_plate.py). The strip has the size of those of Bleyer, Roux-Langlois & Molinari (2017), Int. J. Fract.
204:79.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.results.result import Result
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.library.rocks import load_sheet
from rsmpm_ti.spec.loading_start import Program
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import mm
from rsmpm_ti.validate.comparison import Comparison, compare, predict
from rsmpm_ti.validate.dynamics.tough_plate import carried_strength, front_speed, run_of, tough
from rsmpm_ti.validate.experiment import Experiment, Input

SHELF = load_sheet("pmma")
PMMA = Hooke(E=SHELF.E, nu=SHELF.nu, plane_stress=True)
ENERGY = SHELF.toughness**2 / PMMA.E
"""Plane stress [J/m^2]."""

LENGTH, HEIGHT, NOTCH = 32.0 * mm, 16.0 * mm, 4.0 * mm
DX, QUICK_DX = 0.16 * mm, 0.25 * mm
SLIT_CELLS = 3.0
"""Width of the notch [cells], by which its faces part."""

LOADS, QUICK_LOADS = (1.5, 2.0), (2.0,)
"""Energy that a long crack finds, over G_f. The strip itself bears sqrt(8 load l/H) of the strength that cells carry, l
being the length of the mean: with 3 it broke at once over its whole length."""

DRAWN, T_END = 12e-6, 50e-6
"""How long the grips move [s], three passages of a wave from one to the other; and the end."""

WINDOW = 5e-6
"""Over which the speed of the front is taken [s]: 2 mm."""

ONSET, ONSET_BAND = 330.0, (300.0, 360.0)
FINEBERG = "Fineberg, Gross, Marder & Swinney 1992, PRB 45:5146: 330 +- 30 m/s"

LIMIT = "theory: a crack in tension stays below c_R (Freund 1990, sec. 7.4)"
JUMPS = "rock cracks ahead of the tip, and the tip runs into it: the front jumps"
PLANE = "measured are the first micro-branches, which do not reach through the plate; a model of its plane has none"

BIN, GAP, LASTING = 0.5 * mm, 0.8 * mm, 4
"""A crack has branched where failures of so many columns of this width have a gap across, in a row."""


def strip(load: float, dx: float) -> Scene:
    """Drawn apart until a long crack would find `load` times G_f."""
    stretch = math.sqrt(2.0 * load * ENERGY / (PMMA.E * HEIGHT))
    half, room, speed = 0.5 * HEIGHT, 10.0 * dx, stretch * HEIGHT / DRAWN  # each grip goes DRAWN/2 times it
    notch = Slit(centre=(0.0, 0.0), length=2.0 * NOTCH, width=SLIT_CELLS * dx, angle=0.0, rounded=True)
    plate = Difference(whole=Box(lower=(0.0, -half), upper=(LENGTH, half)), removed=(notch,))
    return Scene(
        title="A crack through a strip of PMMA",
        domain=Domain(lower=(-room, -half - room), upper=(LENGTH + room, half + room), dx=dx),
        bodies=(Body(region=plate, seeding=Jittered(amount=0.1, seed=1)),),
        rock=tough(density=SHELF.density, elasticity=PMMA, energy=ENERGY, strength=SHELF.tensile_strength, dx=dx),
        loading=Loading(
            boundaries=(
                Platen(axis=1, side="lower", position=-half, speed=-speed, pulls=True),
                Platen(axis=1, side="upper", position=half, speed=speed, pulls=True),
            ),
            start=Program(times=(0.5 * DRAWN, DRAWN), factors=(1.0, 0.0)),
            width=LENGTH,
        ),
        schedule=Schedule(t_end=T_END),
    )


@dataclass(frozen=True)
class Ran:
    """A run, and its crack: the largest, since small ones begin at the notch's other corner."""

    load: float
    result: Result

    @property
    def places(self) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and places [m] of the failures of the crack, in order of time; none where it did not run."""
        crack = max(self.result.fracture.cracks, key=lambda crack: crack.particles, default=None)
        rows = np.zeros(0, dtype=int) if crack is None else crack.events
        return self.result.events.time[rows], self.result.events.x[rows]

    @property
    def rayleigh(self) -> float:
        return self.result.fracture.rayleigh_speed

    def speeds(self) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and speeds of its front along the strip [m/s], up to a quarter of the height from the far edge."""
        time, x = self.places
        way = x[:, 0] - NOTCH
        front = np.maximum.accumulate(way)
        runs = front < min(LENGTH - NOTCH - 0.25 * HEIGHT, front.max(initial=0.0))
        return front_speed(time[runs], way[runs], WINDOW)

    def branch(self) -> tuple[float, float]:
        """Where it first branches [m], and the angle between both branches over the next 3 mm [degrees]; NaN: never."""
        _, x = self.places
        columns = np.floor(x[:, 0] / BIN).astype(int)
        pairs = []
        for column in range(int(NOTCH / BIN), int(LENGTH / BIN)):
            across = np.sort(x[columns == column, 1])
            wide = int(np.argmax(np.diff(across))) if len(across) > 1 else 0
            parted = len(across) > 1 and across[wide + 1] - across[wide] > GAP
            pairs.append((across[: wide + 1].mean(), across[wide + 1 :].mean()) if parted else None)
        for start in range(len(pairs) - LASTING):
            run = pairs[start : start + max(LASTING, round(3.0 * mm / BIN))]
            if all(pair is not None for pair in run[:LASTING]):
                found = np.array([pair for pair in run if pair is not None])
                along = np.array([k for k, pair in enumerate(run) if pair is not None]) * BIN
                slopes = [math.degrees(math.atan(np.polyfit(along, found[:, side], 1)[0])) for side in (0, 1)]
                return (start + int(NOTCH / BIN)) * BIN, slopes[1] - slopes[0]
        return math.nan, math.nan

    def speed_at(self, place: float) -> float:
        """Of the front when it passed a place [m/s]."""
        times, speeds = self.speeds()
        time, x = self.places
        passed = time[np.argmax(np.maximum.accumulate(x[:, 0]) >= place)] if math.isfinite(place) else math.nan
        return float(np.interp(passed, times, speeds))

    @property
    def terminal(self) -> float:
        """Mean speed over the second half of its way [m/s]."""
        _, speeds = self.speeds()
        return float(speeds[len(speeds) // 2 :].mean())


def _rows(ran: Ran) -> list[Comparison]:
    name, (place, angle) = f"{ran.load:g} G_f", ran.branch()
    _, speeds = ran.speeds()
    mean, largest = float(speeds.mean()) / ran.rayleigh, float(speeds.max()) / ran.rayleigh
    rows = [
        compare(f"{name}: mean speed over c_R", "1", 1.0, mean, 0.0, LIMIT, band=(0.0, 1.0)),
        compare(f"{name}: largest speed over c_R", "1", 1.0, largest, 0.0, LIMIT, band=(0.0, 1.0), beyond=JUMPS),
        predict(f"{name}: speed over the second half, over c_R", "1", ran.terminal / ran.rayleigh, "rises with load"),
        predict(f"{name}: branches", "1", float(math.isfinite(place)), "1 yes, 0 no"),
    ]
    if math.isfinite(place):
        rows += [
            compare(f"{name}: speed where it first branches", "m/s", ONSET, ran.speed_at(place), 0.1, FINEBERG,
                    band=ONSET_BAND, beyond=PLANE),
            predict(f"{name}: angle between the branches", "degrees", angle, "over 3 mm"),
        ]  # fmt: skip
    return rows


def crack_speed(full: bool) -> Outcome:
    dx = DX if full else QUICK_DX
    runs = [Ran(load, run_of(strip(load, dx))) for load in (LOADS if full else QUICK_LOADS)]
    rows = [row for ran in runs for row in _rows(ran)]
    carried = carried_strength(PMMA, ENERGY, SHELF.tensile_strength, dx)
    rows.append(
        predict("strength that the cells carry, over PMMA's", "1", carried / SHELF.tensile_strength, "tough_plate.py")
    )

    def draw(figure):
        plates, speed = figure.subfigures(1, 2)
        for axes, ran in zip(np.atleast_1d(plates.subplots(len(runs), 1)), runs, strict=True):
            snapshot = ran.result.snapshot
            axes.scatter(*(snapshot.x.T / mm), c=snapshot.damage, s=(260.0 * dx / LENGTH) ** 2, cmap="magma_r", lw=0)
            axes.set(aspect="equal", title=f"{ran.load:g} G_f", ylabel="y [mm]")
        axes = speed.subplots()
        for ran in runs:
            times, speeds = ran.speeds()
            axes.plot(1e6 * times, speeds, "o-", ms=3, lw=0.9, label=f"{ran.load:g} G_f")
        axes.axhline(runs[0].rayleigh, color="k", lw=0.8, ls="--", label="Rayleigh speed")
        axes.axhspan(*ONSET_BAND, color="0.85", label="measured: speed begins to swing")
        axes.set(xlabel="time [us]", ylabel="speed of the front [m/s]", ylim=(0.0, 1.1 * runs[0].rayleigh))
        axes.legend()

    return Outcome(tuple(rows), draw)


_SHELF = "the shelf's PMMA: Seles et al. 2022, Procedia Structural Integrity 42:1721"

CASES = (
    Experiment(
        "crack_speed", "a crack through a strip of PMMA: its speed below c_R, and where it branches", crack_speed,
        inputs=(
            Input("E", PMMA.E, "Pa", _SHELF),
            Input("nu", PMMA.nu, "1", _SHELF),
            Input("density", SHELF.density, "kg/m^3", "the shelf's PMMA"),
            Input("K_Ic", SHELF.toughness, "Pa m^0.5", _SHELF),
            Input("sigma_t", SHELF.tensile_strength, "Pa", _SHELF),
        ),
    ),
)  # fmt: skip
