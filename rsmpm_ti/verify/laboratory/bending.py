"""A beam on two rollers, pressed by a third between them: every platen of a side counts.

Statics alone: the load is the force of the upper roller and the sum of the lower ones', each bears half of it, and all
of it as the nominal stress of the load cell's width. Rollers are platens of a few cells (`span`).
"""

from dataclasses import replace

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

LENGTH, DEPTH, SUPPORTS = 0.1, 0.02, (0.01, 0.09)
"""Of the beam, and places of the lower rollers [m]."""

SETTLED = 0.75e-3
"""Half as long again as the upper roller takes to its full speed [s]."""


def beam(axis: int, dx: float) -> Scene:
    """Pressed along `axis` by a roller in the middle, which reaches its 20 mm/s in half a millisecond."""

    def corner(along: float, across: float) -> tuple[float, ...]:
        return (along, across) if axis == 1 else (across, along)

    lower = [Platen(axis=axis, side="lower", position=0.0, speed=0.0, span=(x - 1e-3, x + 1e-3)) for x in SUPPORTS]
    upper = Platen(axis=axis, side="upper", position=DEPTH, speed=-0.02, span=(49e-3, 51e-3))
    return Scene(
        title="a beam on two rollers",
        domain=Domain(lower=corner(-4.0 * dx, -4.0 * dx), upper=corner(LENGTH + 4.0 * dx, DEPTH + 4.0 * dx), dx=dx),
        bodies=(Body(region=Box(lower=corner(0.0, 0.0), upper=corner(LENGTH, DEPTH))),),
        rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable()),
        loading=Loading(boundaries=(*lower, upper), start=Ramp(time=0.5e-3), width=1.0),
        schedule=Schedule(t_end=1.5e-3),
    )


def _rows(axis: int, history, one) -> list[Row]:
    """history: of the whole beam; one: of a load cell that reads the first lower roller alone."""
    late = history["time_s"] > SETTLED
    upper, lower = history["force_top_N"][late].mean(), history["force_bottom_N"][late].mean()
    why = "what still swings has a thousandth of the load for its mean"
    pull = float(max(0.0, -history["force_bottom_N"].min()))
    return [
        relative(f"axis {axis}: both lower rollers [N/m]", upper, lower, 0.01, why),
        relative(f"axis {axis}: the first of them [N/m]", 0.5 * upper, one["force_bottom_N"][late].mean(), 0.01, why),
        at_most(f"axis {axis}: pull of the lower rollers [N/m]", pull, 0.0, "they only push"),
    ]


def bending(full: bool) -> Outcome:
    """Along y; full: along x too, and finer."""
    rows, runs = [], {}
    for axis in (1, 0) if full else (1,):
        scene = beam(axis, 1e-3 if full else 2e-3)
        first = replace(scene.loading, cell=LoadCell(lower=(0,)))
        runs[axis] = [simulate(s).history for s in (scene, replace(scene, loading=first))]
        rows += _rows(axis, *runs[axis])

    def draw(figure):
        axes = figure.subplots()
        for axis, (history, one) in runs.items():
            time = 1e3 * history["time_s"]
            axes.plot(time, 1e-3 * history["force_top_N"], label=f"upper roller, axis {axis}")
            axes.plot(time, 1e-3 * history["force_bottom_N"], "--", label="both lower rollers")
            axes.plot(1e3 * one["time_s"], 2e-3 * one["force_bottom_N"], ":", label="twice the first of them")
        axes.set(xlabel="time [ms]", ylabel="force [kN/m]", title="a beam on two rollers")
        axes.legend()

    return Outcome(tuple(rows), draw)


CASES = (Case("lab_bending", "a beam on rollers: what the load cell reads is what the rollers bear", bending),)
