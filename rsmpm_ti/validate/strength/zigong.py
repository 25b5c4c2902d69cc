"""Zigong sandstone, 0 to 80 MPa: a curved envelope, by Hoek-Brown and by one Mohr-Coulomb line.

Both criteria are made of the strengths at 0, 40 and 80 MPa, with all their repeats, and predict those between.
"""

import numpy as np

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.curved.hoek_brown import HoekBrown
from rsmpm_ti.units import MPa
from rsmpm_ti.validate.comparison import Comparison, compare
from rsmpm_ti.validate.data.tables import strengths
from rsmpm_ti.validate.experiment import Experiment, Input
from rsmpm_ti.validate.strength.fits import ends_and_middle, hoek_brown, mohr_coulomb
from rsmpm_ti.validate.strength.picture import draw_envelope
from rsmpm_ti.validate.strength.specimens import axial_strength, of_the_shelf, rock_like

POINTS = strengths("Zigong sandstone", "compression")
FITTED = ends_and_middle(POINTS)
JUDGED = tuple(p for p in POINTS if p not in FITTED)
COHESION, FRICTION = mohr_coulomb(FITTED)
INTACT, M_I = hoek_brown(FITTED)

TENSION = 6.0 * MPa
"""Of the shelf, an estimate; no compressed specimen asks for it."""

CRITERIA = {
    "Hoek-Brown": HoekBrown(intact_strength=INTACT, m=M_I, tensile_strength=TENSION),
    "Mohr-Coulomb": MohrCoulomb(cohesion=COHESION, friction_angle=FRICTION, tensile_strength=TENSION),
}

TARGET = 0.10


def _judge(name: str, pressure: float, found: float) -> Comparison:
    here = [p for p in JUDGED if p.sigma_3 == pressure]
    repeats = [p.sigma_1 / MPa for p in here]
    band = (min(repeats), max(repeats)) if len(repeats) > 1 else None
    what = f"strength under {pressure / MPa:g} MPa, {name}"
    keys = ", ".join(p.key for p in here)
    return compare(what, "MPa", float(np.mean(repeats)), found / MPa, TARGET, here[0].source, band=band, datum=keys)


def envelope(full: bool) -> Outcome:
    """quick: 10 MPa by Hoek-Brown, where the curve bends most."""
    pressures = sorted({p.sigma_3 for p in JUDGED})
    rows, runs = [], {name: [] for name in CRITERIA}
    for name, criterion in CRITERIA.items() if full else list(CRITERIA.items())[:1]:
        rock = rock_like("zigong_sandstone", criterion)
        for pressure in pressures if full else pressures[:1]:
            found = axial_strength(rock, pressure, expected=criterion.strength(pressure), full=full)
            runs[name].append((pressure, found))
            rows.append(_judge(name, pressure, found))

    def draw(figure):
        axes = figure.subplots()
        range_ = np.linspace(0.0, POINTS[-1].sigma_3, 60)
        draw_envelope(
            axes,
            fitted=[(p.sigma_3, p.sigma_1) for p in FITTED],
            judged=[(p.sigma_3, p.sigma_1) for p in JUDGED],
            curves={name: [(p, criterion.strength(p)) for p in range_] for name, criterion in CRITERIA.items()},
            runs=runs,
        )
        axes.set(xlabel="confining pressure [MPa]", ylabel="strength [MPa]")
        axes.set_title("Zigong sandstone in compression (Zhang, Wu & Zhang 2020)")

    return Outcome(tuple(rows), draw)


KEYS = tuple(p.key for p in FITTED)

CASES = (
    Experiment(
        "zigong",
        "Zigong sandstone to 80 MPa: Hoek-Brown and Mohr-Coulomb, made of three pressures, predict six others",
        envelope,
        inputs=(
            *of_the_shelf("zigong_sandstone", tension=TENSION),
            Input("intact_strength", INTACT, "Pa", "Hoek-Brown through all strengths at 0, 40 and 80 MPa", KEYS),
            Input("m", M_I, "1", "the same curve", KEYS),
            Input("cohesion", COHESION, "Pa", "line through the same strengths", KEYS),
            Input("friction_angle", FRICTION, "degrees", "the same line", KEYS),
        ),
        judged=tuple(p.key for p in JUDGED),
    ),
)
