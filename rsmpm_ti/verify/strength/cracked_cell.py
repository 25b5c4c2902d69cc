"""Rock that cracks with a direction, strained by hand and between walls: stress follows closed forms, for every law."""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.strength.crack_forms import BAND, G_F_I, LAM, SIN_R, TAN_R, TENSILE, M, across
from rsmpm_ti.verify.strength.crack_paths import (
    LAWS,
    PATHS,
    PRESSURE,
    STEP,
    WIDE,
    Followed,
    apart_tension,
    followed,
    label,
    path_errors,
    rock,
    softening_name,
    spinning_error,
    three_principals,
    turned_error,
)

PASSES_STEP, SPEED = 4e-6, 0.1
"""Strain of a step of the cell between walls; speed of its platen [m/s]."""


@dataclass(frozen=True, kw_only=True)
class ThereAndBack:
    """The platen's fraction of its speed, step by step: out, a part back, all the way out, back and into the rock."""

    dt: float
    wide: float

    def factor(self, time: float) -> float:
        """Strain is meant to turn at 0.5e-3, 0.1e-3 and `wide`, and to end at -1e-3."""
        strain, out = time / self.dt * PASSES_STEP, (0.5e-3, 0.9e-3, 0.8e-3 + self.wide)
        return 1.0 if strain < out[0] or out[1] < strain < out[2] else -1.0


@dataclass(frozen=True)
class Cell:
    """One cell through the real passes; [rows] after every 25 steps."""

    strain: np.ndarray  # ln J
    sigma: np.ndarray  # [rows, 4], of its first particle [Pa]
    released: float  # by failure, of the ledger [J]
    missing: float  # kinetic + elastic + dissipated - work at the end, over the largest work

    def error(self, law: Directional) -> float:
        """Largest error of the two normal stresses in the plane, in loads of one step."""
        axial, opening = across(M * self.strain, softening_name(law))
        lateral = LAM * (self.strain - opening)
        worst = max(np.abs(self.sigma[:, 1] - axial).max(), np.abs(self.sigma[:, 0] - lateral).max())
        return float(worst / (M * PASSES_STEP))


def between_walls(law: Directional) -> Cell:
    """Pull one cell between walls by a platen along ThereAndBack."""
    dt = PASSES_STEP * BAND / SPEED
    wide = WIDE if softening_name(law) == "ExponentialSoftening" else 1.3e-3  # until all strength is gone
    steps = round((0.8e-3 + 2.0 * wide + 1e-3) / PASSES_STEP)
    scene = Scene(
        title="cracked cell",
        domain=Domain(lower=(0.0, 0.0), upper=(BAND, BAND), dx=BAND),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(BAND, BAND))),),
        rock=rock(law),
        loading=Loading(
            boundaries=(
                Wall(axis=0, side="lower", position=0.0),
                Wall(axis=0, side="upper", position=BAND),
                Wall(axis=1, side="lower", position=0.0),
                Platen(axis=1, side="upper", position=BAND, speed=SPEED, pulls=True),
            ),
            start=ThereAndBack(dt=dt, wide=wide),
        ),
        schedule=Schedule(t_end=steps * dt, dt=dt),
        shape=Linear(),
    )
    drive = set_up(scene)
    particles, rows = drive.sim.particles, []
    while not drive.clock.done:
        drive.advance(25)  # the strain turns at multiples of these
        rows.append((math.log(particles.J[0]), *particles.sigma[0], drive.survey.work))
    found, end = np.array(rows), drive.survey
    released = float(drive.sim.ledger.released.to_numpy().sum())
    missing = (end.kinetic + end.elastic + end.dissipated - end.work) / found[:, 5].max()
    return Cell(found[:, 0], found[:, 1:5], released, float(missing))


def energy_row(what: str, law: Directional, got: float, step: float) -> Row:
    """Energy per crack area that opening has cost [J/m^2]: G_f_I, or what the brittle cell held."""
    if softening_name(law) == "Brittle":
        held, why = 0.5 * TENSILE**2 / M * BAND, "the step in which it fails overshoots by at most its load"
        return relative(f"{what}: energy held [J/m2]", held, got, 2.1 * M * step / TENSILE, why)
    # the mean of a step's two stresses is that of a step before: sum |f'| de de = f_t de more, de = step/(1 - |f'|/M)
    fall = TENSILE**2 * BAND / (2.0 * G_F_I)
    lag = TENSILE * BAND / G_F_I * step / (1.0 - fall / M)
    why = "traction lags a step; 0.1 % for rock that is stretched when it is lost"
    return relative(f"{what}: energy / area [J/m2]", G_F_I, got, lag + 0.001, why)


def law_rows(one: Followed) -> list[Row]:
    """Every path of one law."""
    name, why = label(one.law), "traction and cohesion lag one step"
    rows = [
        at_most(f"{name}, {path}: error / step's load", error, 1.0, why) for path, error in path_errors(one).items()
    ]
    rows.append(energy_row(name, one.law, float(one.lost["opened"][-1] * BAND), STEP))
    return rows


def friction_row(one: Followed) -> Row:
    """Shear at the end of sliding there, on the crack that has lost all its cohesion; none such if it turns."""
    top = int(np.argmax(PATHS["sheared"][:, 2])) - 1
    return relative("fixed Brittle: tau / p", TAN_R, float(one.sigma["sheared"][top, 3] / PRESSURE), 1e-9, "round-off")


def shared_rows(all_of_them: list[Followed]) -> list[Row]:
    """What holds for every law alike: the worst of them."""
    turned = max(turned_error(one) for one in all_of_them)
    spins = [spinning_error(one) for one in all_of_them]
    rows = [
        at_most("all, turned by 30 deg: change / sigma_t", turned, 1e-8, "round-off of 1e4 increments of M x 1e-16"),
        at_most("all, spun by 90 deg: change / allowed", max(e / most for e, most in spins), 1.0, "half a step's turn"),
    ]
    for one in all_of_them:
        name = softening_name(one.law)
        if name != "ExponentialSoftening" and not one.law.rotating:
            low, _, high = np.sort(three_principals(one.sigma["crushed"])[-400])
            why = "no cohesion is left, and three principal stresses count"
            rows.append(relative(f"{name}, crushed: sigma_3/sigma_1", (1 + SIN_R) / (1 - SIN_R), low / high, 1e-9, why))
    tension = max(apart_tension(one) for one in all_of_them)
    rows.append(at_most("all, crushed and pulled apart: sigma_1 / sigma_t", tension / TENSILE, 1e-9, "nothing is left"))
    least = min(float(np.diff(one.lost[path]).min()) for one in all_of_them for path in PATHS)
    why = "a step that closes a crack half way errs by half its load times its strain"
    rows.append(at_least("all: energy lost in a step [J/m3]", least, -0.5 * M * STEP**2, why))
    return rows


def cracked_cell(full: bool) -> Outcome:
    """Every law along every path by hand; one law, or all, between walls through the passes of a run."""
    points = [followed(law) for law in LAWS]
    walled = LAWS if full else LAWS[1:2]
    cells = [between_walls(law) for law in walled]
    rows = [row for one in points for row in law_rows(one)]
    rows += [friction_row(points[0]), *shared_rows(points)]
    why = "traction lags one step"
    for law, cell in zip(walled, cells, strict=True):
        rows.append(at_most(f"{label(law)}, between walls: error / step's load", cell.error(law), 1.0, why))
        rows.append(energy_row(f"{label(law)}, between walls", law, cell.released / BAND, PASSES_STEP))
        stopped = "what a platen stops that turns at once is booked: else 1.3 % is missing"
        rows.append(at_most(f"{label(law)}, between walls: energy missing / work", abs(cell.missing), 5e-3, stopped))

    def draw(figure):
        opened, shear, crush, turn = figure.subplots(2, 2).flat
        for k, one in enumerate(points):
            if one.law.rotating:
                _curve(turn, one, "turning", 2e3 * PATHS["turning"][1:, 2], 3, k - 3)
            else:
                _curve(opened, one, "opened", 1e3 * PATHS["opened"][1:, 1], 1, k)
                _curve(shear, one, "sheared", 2e3 * PATHS["sheared"][1:, 2], 3, k)
                _curve(crush, one, "crushed", -1e3 * PATHS["crushed"][1:, 1], 1, k)
        opened.set(xlabel="axial strain [1e-3]", ylabel="axial stress [MPa]", title="pulled, closed, pulled, pressed")
        opened.set(xlim=(-0.4, 2.0), ylim=(-6.0, 2.3))
        shear.set(xlabel="shear strain [1e-3]", ylabel="shear stress [MPa]", title="sheared under 5 MPa, fixed")
        turn.set(xlabel="shear strain [1e-3]", ylabel="shear stress [MPa]", title="sheared under 5 MPa, rotating")
        crush.set(xlabel="axial shortening [1e-3]", ylabel="axial stress [MPa]", title="crushed, then an oedometer")
        opened.legend(fontsize="x-small")

    return Outcome(tuple(rows), draw)


def _curve(axes, one: Followed, path: str, x: np.ndarray, component: int, colour: int) -> None:
    name = softening_name(one.law)
    axes.plot(x, 1e-6 * one.sigma[path][:, component], color=f"C{colour}", label=name)
    axes.plot(x, 1e-6 * one.forms[path][:, component], "k--", linewidth=0.8)


CASES = (Case("cracked_cell", "cracked rock pulled, sheared, crushed, turned: every law after failure", cracked_cell),)
