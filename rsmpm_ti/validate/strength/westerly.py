"""Westerly granite in compression, 0 to 58 MPa: one Mohr-Coulomb line, made of three of six strengths."""

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.units import MPa
from rsmpm_ti.validate.comparison import compare
from rsmpm_ti.validate.data.tables import strengths
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.validate.strength.fits import ends_and_middle, mohr_coulomb
from rsmpm_ti.validate.strength.specimens import axial_strength, rock_like

POINTS = strengths("Westerly granite", "compression")
FITTED = ends_and_middle(POINTS)
JUDGED = tuple(p for p in POINTS if p not in FITTED)
COHESION, FRICTION = mohr_coulomb(FITTED)

TENSION = 10.0 * MPa
"""Of the shelf; no compressed specimen asks for it."""


def envelope(full: bool) -> Outcome:
    rock = rock_like(
        "westerly_granite", MohrCoulomb(cohesion=COHESION, friction_angle=FRICTION, tensile_strength=TENSION)
    )
    rows, found = [], []
    for point in JUDGED:
        expected = rock.criterion.strength(point.sigma_3)
        predicted = axial_strength(rock, point.sigma_3, expected=expected, full=full)
        found.append(predicted)
        rows.append(
            compare(
                f"strength under {point.sigma_3 / MPa:g} MPa", "MPa", point.sigma_1 / MPa, predicted / MPa, 0.07,
                point.source, datum=point.key,
            )
        )  # fmt: skip

    def draw(figure):
        axes = figure.subplots()
        axes.plot(*zip(*((p.sigma_3 / MPa, p.sigma_1 / MPa) for p in FITTED), strict=True), "ks", label="fitted on")
        axes.plot(*zip(*((p.sigma_3 / MPa, p.sigma_1 / MPa) for p in JUDGED), strict=True), "ko", mfc="none",
                  label="measured, judges")  # fmt: skip
        ends = (POINTS[0].sigma_3, POINTS[-1].sigma_3)
        axes.plot([p / MPa for p in ends], [rock.criterion.strength(p) / MPa for p in ends], "tab:blue", lw=0.8,
                  label="Mohr-Coulomb")  # fmt: skip
        axes.plot([p.sigma_3 / MPa for p in JUDGED], [f / MPa for f in found], "x", color="tab:red", label="runs")
        axes.set(xlabel="confining pressure [MPa]", ylabel="strength [MPa]",
                 title="Westerly granite, compression (Mogi 1967)")  # fmt: skip
        axes.legend()

    return Outcome(tuple(rows), draw)


CASES = (
    Experiment(
        "westerly", "Westerly granite in compression: a Mohr-Coulomb line through three strengths predicts the others",
        envelope,
        inputs=(
            Input("cohesion", COHESION, "Pa", "line through the strengths at both ends and in the middle",
                  tuple(p.key for p in FITTED)),
            Input("friction_angle", FRICTION, "degrees", "the same line", tuple(p.key for p in FITTED)),
        ),
        judged=tuple(p.key for p in JUDGED),
    ),
)  # fmt: skip
