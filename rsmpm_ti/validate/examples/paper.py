"""The paper itself on one page: its figures 1 and 2, with finite elements in Abaqus's place, and what it states.

Gao, Xu, Gu, Ren, Zhang & Zhang (2023), Water Resources and Power 41(3):136: sigma_1 before cracking of both examples,
and how their cracks grow. Its time step and its particle counts cannot be remade: docs/method.md, docs/scenes.md.
"""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.records.snapshot import TENSION
from rsmpm_ti.results.result import Result
from rsmpm_ti.spec.regions import Slit, slits_of
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import Comparison, compare, predict
from rsmpm_ti.validate.examples.page import draw_field, draw_growth
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.verify.elastic.slit_field import INNER, slit_disc, slit_specimen
from rsmpm_ti.verify.elastic.slit_field import compare as field_of
from rsmpm_ti.verify.reference.fe_field import load_field

PAPER = "Gao et al. 2023, sec. 4"
FINITE = "P2 finite elements, rsmpm_ti.verify.reference; the paper: agreement with Abaqus, without a number"
COUNT = "its count fits no lattice of 2 x 2 particles a cell with the flaw that it describes; it gives no flaw width"
STEP = "the printed step is a hundred times dx/c_p of its grid: its exponent or its unit is wrong"
STEPS = 5
"""Instants of growth that are drawn."""


@dataclass(frozen=True)
class Grown:
    """One example broken by the scene that ships."""

    name: str
    scene: Scene
    result: Result

    @property
    def slit(self) -> Slit:
        return slits_of(self.scene.bodies[0].region)[0]

    def instants(self) -> list[tuple[float, float]]:
        """(time [s], nominal stress [Pa]) when fractions of all failures have come, the first failure first."""
        times = np.sort(self.result.events.time)
        chosen = times[np.linspace(0, len(times) - 1, STEPS).astype(int)]
        stress = nominal_stress(self.result.history)
        return [(float(t), float(np.interp(t, self.result.history["time_s"], stress))) for t in chosen]

    def from_tip(self) -> float:
        """Distance of the first failure from the nearer end of the flaw, along the flaw [m]."""
        events = self.result.events
        first = self.slit.frame(events.x[[int(np.argmin(events.time))]])[0]
        return abs(abs(float(first[0])) - 0.5 * self.slit.length)

    def gap(self) -> float:
        """Distance of the crack's ends from the two platens, the larger one [m]."""
        low, high = self.scene.bodies[0].region.bounds()
        y = self.result.events.x[:, 1]
        return max(float(y.min() - low[1]), float(high[1] - y.max()))


def _grown(name: str) -> Grown:
    scene = load_scene(name)
    return Grown(name, scene, simulate(scene, threads=1))


def _stated(grown: Grown, particles: int) -> list[Comparison]:
    """What the paper says of one example in words or numbers."""
    name, events = grown.name, grown.result.events
    count, first = float(len(grown.result.snapshot.x)), int(events.mode[np.argmin(events.time)])
    return [
        compare(f"{name}: first failure from the flaw's tip", "mm", 0.0, grown.from_tip() / mm, 1.0, PAPER,
                absolute=True),
        compare(f"{name}: first failure is tensile", "1", 1.0, float(first == TENSION), 0.0, PAPER),
        compare(f"{name}: particles", "1", particles, count, 0.001, PAPER, beyond=COUNT),
    ]  # fmt: skip


def page(full: bool) -> Outcome:
    fields = {
        "cube": field_of(slit_specimen(0.5e-3, 2e-3), load_field("slit_specimen_2mm"))[0],
        "disc": field_of(slit_disc(), load_field("slit_disc_1mm"), INNER)[0],
    }
    rows = [
        compare(f"{name}: rms difference of sigma_1 from finite elements, of the nominal stress", "1", 0.0, error.rms,
                0.02, FINITE, absolute=True)
        for name, error in fields.items()
    ]  # fmt: skip
    grown = {name: _grown(name) for name in ("cube", "disc")}
    rows += _stated(grown["cube"], 79976) + _stated(grown["disc"], 50732)
    gap = grown["disc"].gap() / mm
    rows.append(compare("disc: crack's end from the platens", "mm", 0.0, gap, 5.0, PAPER, absolute=True))
    rows.append(predict("cube: wing's end from the platens", "mm", grown["cube"].gap() / mm, PAPER + ": no number"))
    step = grown["cube"].scene.domain.dx / grown["cube"].scene.rock.wave_speed()
    rows.append(compare("dx/c_p, against the printed time step", "s", 1.91e-5, step, 0.01, PAPER, beyond=STEP))
    for name, one in grown.items():
        onset = float(one.result.summary["first_failure_stress_Pa"]) / MPa
        rows.append(predict(f"{name}: nominal stress at the first failure", "MPa", onset, PAPER + ": no number"))

    def draw(figure):
        figure.set_size_inches(15.0, 15.0)
        top, middle, bottom = figure.subfigures(3, 1, height_ratios=(0.75, 1.0, 0.6))
        clouds = top.subplots(1, 6, width_ratios=(1, 1, 1, 1.6, 1.6, 1.6))
        draw_field(clouds[:3], fields["cube"], 1.0, "example 1")
        draw_field(clouds[3:], fields["disc"], 3.0, "example 2")
        top.suptitle("Figure 1 of the paper: sigma_1 over the nominal stress before cracking")
        for part, one in ((middle, grown["cube"]), (bottom, grown["disc"])):
            draw_growth(part.subplots(1, STEPS, sharey=True), one.result, one.scene, one.instants())
        middle.suptitle("Figure 2: crack growth, scenes `cube` and `disc` as they ship; red: tension, blue: shear")

    return Outcome(tuple(rows), draw)


CASES = (
    Experiment(
        "paper", "the paper's figures 1 and 2 remade on one page, and what it states", page, quick=False,
        inputs=(
            Input("density", 2600.0, "kg/m^3", PAPER), Input("E", 17e9, "Pa", PAPER), Input("nu", 0.14, "1", PAPER),
            Input("cohesion", 5.95 * MPa, "Pa", PAPER), Input("friction_angle", 40.0, "degrees", PAPER),
            Input("tensile_strength", 2.0 * MPa, "Pa", PAPER),
        ),
    ),
)  # fmt: skip
