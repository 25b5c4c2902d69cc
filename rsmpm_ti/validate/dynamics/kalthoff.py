"""Kalthoff & Winkler's plate: struck between two notches, so slowly that it cracks instead of shearing through.

The crack leaves the notch at about 70 degrees from the notch's line (Kalthoff & Winkler 1988, in Impact Loading and
Dynamic Behaviour of Materials, ed. Chiem, Kunze & Meyer, DGM, vol. 1, p. 185; told by Batra & Ravisankar 2000, Int. J.
Fract. 105:161), and a crack in tension stays below the Rayleigh speed (Freund 1990, sec. 7.4). Both are predicted from
the steel's elasticity, density, fracture energy and strength, which other tests measured, and from the impact: the half
between the notches takes half of the projectile's 33 m/s, since both have one impedance, and takes it in 1 us as in
Borden et al. (2012), Comput. Methods Appl. Mech. Eng. 217:77, sec. 4.3. A platen gives it that speed through a block of
the same steel, since rock beside a platen that moves in must not come past its plane. The steel cracks in tension and
does not yield. The strength is what the cells carry (tough_plate.py).
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.crack_bands import Crack
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.results.result import Result
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Program
from rsmpm_ti.spec.regions import Box, Difference, Slit, Union
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import GPa, mm
from rsmpm_ti.validate.comparison import Comparison, compare, predict
from rsmpm_ti.validate.dynamics.tough_plate import brittle, carried_strength, front_speed, run_of, tough
from rsmpm_ti.validate.experiment import Experiment, Input

STEEL = Hooke(E=190.0 * GPa, nu=0.3)
DENSITY = 8000.0
ENERGY = 2.213e4
STRENGTH = 1.93 * GPa
SPEED, RISE = 16.5, 1e-6

SIZE, NOTCH, AXIS, BLOCK = 100.0 * mm, 50.0 * mm, 25.0 * mm, 10.0 * mm
"""Of the upper half: both edges, length of its notch, and the notch's distance from the axis; length of the block."""

DX, QUICK_DX = 0.5 * mm, 1.0 * mm
SLIT_CELLS = 3.0
"""Width of the notch [cells], by which its faces part."""

T_END = 70e-6
"""The crack is then about to reach the far edges."""

WINDOW = 6e-6
"""Over which the speed of the front is taken [s]: 10 mm."""

ANGLE, BAND = 70.0, (65.0, 75.0)
BRANCHES = "no energy is asked for, so that the crack branches, and its branches lean"
PLANES = "across the tension that broke them; a crack that follows them goes their way"
TOLD = "Kalthoff & Winkler 1988: 'approximately 70 degrees' (Batra & Ravisankar 2000, IJF 105:161)"


def struck_plate(rock: Rock, dx: float) -> Scene:
    """The half above the axis, seen from the side: struck at its left edge below the notch."""
    width, room = SLIT_CELLS * dx, 6.0 * mm
    notch = Slit(centre=(0.0, AXIS), length=2.0 * NOTCH, width=width, angle=0.0)
    whole = Union(parts=(Box(lower=(0.0, 0.0), upper=(SIZE, SIZE)), Box(lower=(-BLOCK, 0.0), upper=(0.0, AXIS))))
    plate = Difference(whole=whole, removed=(notch,))
    projectile = Platen(axis=0, side="lower", position=-BLOCK, speed=SPEED)
    return Scene(
        title="Kalthoff and Winkler's plate",
        domain=Domain(lower=(-BLOCK - room, 0.0), upper=(SIZE + room, SIZE + room), dx=dx),
        bodies=(Body(region=plate, seeding=Jittered(amount=0.1, seed=1)),),
        rock=rock,
        loading=Loading(
            boundaries=(projectile, Wall(axis=1, side="lower", position=0.0)),
            start=Program(times=(RISE,), factors=(1.0,)),
            width=AXIS,
        ),
        schedule=Schedule(t_end=T_END, cfl=0.5),
    )


@dataclass(frozen=True)
class Struck:
    """A run, and the crack that left the notch."""

    result: Result

    @property
    def crack(self) -> Crack | None:
        cracks = (c for c in self.result.fracture.cracks if c.origin.tip == "0+" and c.course is not None)
        return next(cracks, None)

    @property
    def first_angle(self) -> float:
        """By which it leaves, over its first 3 mm [degrees]."""
        return math.nan if self.crack is None else self.crack.origin.angle

    @property
    def angle(self) -> float:
        """From the notch's tip to where it has come [degrees]."""
        if self.crack is None:
            return math.nan
        way = self.result.events.x[self.crack.events] - np.array([NOTCH, AXIS])
        end = way[np.argmax(np.linalg.norm(way, axis=1))]
        return math.degrees(math.atan2(end[1], end[0]))

    @property
    def planes(self) -> float:
        """Median angle of the crack's own planes, which stand across the tension that broke them [degrees]."""
        normals = self.result.events.crack_angle
        if self.crack is None or normals is None:
            return math.nan
        return float(np.median(np.degrees(normals[self.crack.events]) % 180.0)) - 90.0

    def speeds(self) -> tuple[np.ndarray, np.ndarray]:
        """Times [s] and speeds of its front over the Rayleigh speed."""
        if self.crack is None:
            return np.zeros(0), np.full(1, math.nan)
        time = self.result.events.time[self.crack.events]
        times, speeds = front_speed(time, self.crack.length_at, WINDOW)
        return times, speeds / self.result.fracture.rayleigh_speed


def _rows(struck: Struck, law: str, beyond: str) -> list[Comparison]:
    _, speeds = struck.speeds()
    rows = [
        compare(f"{law}: angle of the crack, tip to end", "degrees", ANGLE, struck.angle, 5.0, TOLD, band=BAND,
                absolute=True, beyond=beyond),
        compare(f"{law}: angle over its first 3 mm", "degrees", ANGLE, struck.first_angle, 5.0, TOLD, band=BAND,
                absolute=True, beyond=beyond),
        compare(f"{law}: largest speed over c_R", "1", 1.0, float(speeds.max()), 0.0,
                "theory: a crack in tension stays below c_R (Freund 1990, sec. 7.4)", band=(0.0, 1.0)),
        predict(f"{law}: mean speed over c_R", "1", float(speeds.mean()), "nothing was measured of it here"),
    ]  # fmt: skip
    if math.isfinite(struck.planes):
        rows.append(predict(f"{law}: median angle of its own planes", "degrees", struck.planes, PLANES))
    return rows


def kalthoff(full: bool) -> Outcome:
    dx = DX if full else QUICK_DX
    rock = tough(density=DENSITY, elasticity=STEEL, energy=ENERGY, strength=STRENGTH, dx=dx)
    energy = Struck(run_of(struck_plate(rock, dx)))
    runs, rows = {"with fracture energy": energy}, _rows(energy, "with fracture energy", "")
    if full:
        weak = brittle(density=DENSITY, elasticity=STEEL, strength=rock.criterion.tensile_strength)
        paper = Struck(run_of(struck_plate(weak, dx)))
        runs["law of the paper"] = paper
        rows += _rows(paper, "law of the paper", BRANCHES)
    carried = carried_strength(STEEL, ENERGY, STRENGTH, dx)
    rows.append(predict("strength that the cells carry, over the steel's", "1", carried / STRENGTH, "tough_plate.py"))

    def draw(figure):
        axes = figure.subplots(1, len(runs) + 1)
        for plate, (law, struck) in zip(axes, runs.items(), strict=False):
            snapshot = struck.result.snapshot
            plate.scatter(*(snapshot.x.T / mm), c=snapshot.damage, s=(150.0 * dx / SIZE) ** 2, cmap="magma_r", lw=0)
            for angle in BAND:
                way = 55.0 * np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
                plate.plot([NOTCH / mm, NOTCH / mm + way[0]], [AXIS / mm, AXIS / mm + way[1]], "c--", lw=0.9)
            plate.set(aspect="equal", title=f"{law}: {struck.angle:.0f} degrees", xlabel="x [mm]", ylabel="y [mm]")
            times, speeds = struck.speeds()
            axes[-1].plot(1e6 * times, speeds[: len(times)], "o-", ms=3, lw=0.9, label=law)
        axes[-1].axhline(1.0, color="k", lw=0.8, ls="--")
        axes[-1].set(xlabel="time [us]", ylabel="speed of the front over c_R", ylim=(0.0, 1.1), title="Speed")
        axes[-1].legend()
        figure.suptitle("Damage; dashed: 65 and 75 degrees")

    return Outcome(tuple(rows), draw)


_STEEL_SOURCE = "18Ni1900: Nickel Development Institute, Publication 4419, Tables 7 and 19"

CASES = (
    Experiment(
        "kalthoff", "Kalthoff & Winkler: a notched steel plate, struck: the crack leaves at 70 degrees", kalthoff,
        inputs=(
            Input("E", STEEL.E, "Pa", _STEEL_SOURCE),
            Input("nu", STEEL.nu, "1", _STEEL_SOURCE),
            Input("density", DENSITY, "kg/m^3", _STEEL_SOURCE),
            Input("sigma_t", STRENGTH, "Pa", f"{_STEEL_SOURCE}: middle of the 0.2 % proof stress, 1.79 to 2.07 GPa"),
            Input("G_f_I", ENERGY, "J/m^2", "Borden et al. 2012, CMAME 217:77, sec. 4.3"),
            Input("speed", SPEED, "m/s", "half of the projectile's: Borden et al. 2012, CMAME 217:77, sec. 4.3"),
        ),
    ),
)  # fmt: skip
