"""Westerly granite in compression, 0 to 58 MPa: one Mohr-Coulomb line, made of three of six strengths."""

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.units import MPa
from rsmpm_ti.validate.comparison import compare
from rsmpm_ti.validate.data.tables import strengths
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.validate.strength.fits import ends_and_middle, mohr_coulomb
from rsmpm_ti.validate.strength.picture import draw_envelope
from rsmpm_ti.validate.strength.specimens import axial_strength, of_the_shelf, rock_like

POINTS = strengths("Westerly granite", "compression")
FITTED = ends_and_middle(POINTS)
JUDGED = tuple(p for p in POINTS if p not in FITTED)
COHESION, FRICTION = mohr_coulomb(FITTED)

TENSION = 10.0 * MPa
"""Of the shelf; no compressed specimen asks for it."""

TARGET = 0.07


def envelope(full: bool) -> Outcome:
    """quick: the pressure in the middle of those that judge."""
    criterion = MohrCoulomb(cohesion=COHESION, friction_angle=FRICTION, tensile_strength=TENSION)
    rock, rows, runs = rock_like("westerly_granite", criterion), [], []
    for point in JUDGED if full else JUDGED[1:2]:
        expected = criterion.strength(point.sigma_3)
        found = axial_strength(rock, point.sigma_3, expected=expected, full=full)
        runs.append((point.sigma_3, found))
        what = f"strength under {point.sigma_3 / MPa:g} MPa"
        measured = point.sigma_1 / MPa
        rows.append(compare(what, "MPa", measured, found / MPa, TARGET, point.source, datum=point.key))

    def draw(figure):
        axes = figure.subplots()
        line = [(p.sigma_3, criterion.strength(p.sigma_3)) for p in (POINTS[0], POINTS[-1])]
        draw_envelope(
            axes,
            fitted=[(p.sigma_3, p.sigma_1) for p in FITTED],
            judged=[(p.sigma_3, p.sigma_1) for p in JUDGED],
            curves={"Mohr-Coulomb": line},
            runs={"Mohr-Coulomb": runs},
        )
        axes.set(xlabel="confining pressure [MPa]", ylabel="strength [MPa]")
        axes.set_title("Westerly granite in compression (Mogi 1967)")

    return Outcome(tuple(rows), draw)


KEYS = tuple(p.key for p in FITTED)

CASES = (
    Experiment(
        "westerly",
        "Westerly granite in compression: a Mohr-Coulomb line through three strengths predicts the others",
        envelope,
        inputs=(
            *of_the_shelf("westerly_granite", tension=TENSION),
            Input("cohesion", COHESION, "Pa", "line through the strengths at both ends and in the middle", KEYS),
            Input("friction_angle", FRICTION, "degrees", "the same line", KEYS),
        ),
        judged=tuple(p.key for p in JUDGED),
    ),
)
