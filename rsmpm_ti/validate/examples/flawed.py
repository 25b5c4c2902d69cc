"""Flawed specimens of the lab's rock: what published abstracts state, and strengths predicted from intact tests alone.

Full papers on flawed specimens could not be read; what their abstracts state in words is held against runs as a sign or
a place. Strengths of specimens with one flaw and with two are published here as predictions, of 2026-11-30, with the
scatter over seeds and cells, to be judged by whoever has the tables.
"""

import numpy as np

from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.units import MPa
from rsmpm_ti.validate.comparison import Comparison, compare, predict
from rsmpm_ti.validate.examples.specimen_runs import FINE, QUICK, Told, tell, to_the_peak
from rsmpm_ti.validate.experiment import Experiment, Input

ANGLES, FINER = (0.0, 30.0, 45.0, 60.0, 90.0), (30.0, 45.0, 60.0)
BRIDGING, SEEDS = (0.0, 45.0, 90.0, 120.0), (1, 2)

LIU = "Liu et al. 2020, Bull. Eng. Geol. Environ. 79:3145, abstract: marble"
BOBET = "Bobet & Einstein 1998, Int. J. Rock Mech. Min. Sci. 35:863, abstract: gypsum"
YANG = "Yang & Jing 2011, Int. J. Fract. 168:227, abstract: sandstone"
PREDICTION = "prediction of 2026-11-30; no table of such a test could be read"

UCS = lab_rock().criterion.ucs
"""Of the intact rock [Pa]."""


def rising(angles: list[float], values: list[float]) -> float:
    """Spearman's rank correlation of values with angles: 1 where they always rise."""
    order = np.argsort(np.argsort(values))
    return float(np.corrcoef(np.argsort(np.argsort(angles)), order)[0, 1])


def _mean(told: list[Told], name: str) -> tuple[float, float]:
    """Mean [MPa] and half of the range."""
    values = np.array([getattr(t, name) for t in told]) / MPa
    return float(values.mean()), 0.5 * float(np.ptp(values))


def _predicted(what: str, told: list[Told]) -> list[Comparison]:
    rows = []
    for name, word in (("onset", "first failure"), ("peak", "peak")):
        mean, half = _mean(told, name)
        rows.append(predict(f"{word} at {what}, +-{half:.2g}", "MPa", mean, PREDICTION))
    return rows


def _draw(figure, found: dict[float, list[Told]], title: str):
    """First failure and peak against an angle; the axes, for what is to be added."""
    axes = figure.subplots()
    for number, (name, label) in enumerate((("onset", "first failure"), ("peak", "peak"))):
        means = np.array([_mean(told, name) for told in found.values()])
        axes.errorbar(list(found), means[:, 0], yerr=means[:, 1], fmt="o-", color=f"C{number}", capsize=4, label=label)
    axes.set(ylabel="nominal stress [MPa]", ylim=(0, None), title=title)
    return axes


def one_flaw(full: bool) -> Outcome:
    """Angles of a flaw of 15 mm in a specimen of 50 mm."""
    found: dict[float, list[Told]] = {}
    for angle in ANGLES:
        found[angle] = [tell(to_the_peak("cube_lab", flaw_angle=angle, seed=s, servo=False, **QUICK)) for s in SEEDS]
        if angle in FINER:
            found[angle].append(tell(to_the_peak("cube_lab", flaw_angle=angle, servo=False, **FINE)))
    rows = [row for angle in ANGLES for row in _predicted(f"flaw at {angle:g} degrees", found[angle])]
    steep = [angle for angle in ANGLES if angle > 0.0]
    onset, peak = ({a: _mean(found[a], name)[0] for a in ANGLES} for name in ("onset", "peak"))
    trends = {
        "onset": [onset[a] for a in steep],
        "peak": [peak[a] for a in steep],
        "onset over peak": [onset[a] / peak[a] for a in steep],
    }
    for name, values in trends.items():
        rows.append(
            compare(f"{name} rises with the angle, rank correlation", "1", 1.0, rising(steep, values), 0.0, LIU)
        )
    inclined = [t for a in FINER for t in found[a]]
    tensile = float(np.mean([t.tensile for t in inclined]))
    rows.append(compare("first failure is tensile, fraction of runs", "1", 1.0, tensile, 0.0, BOBET))
    tips = float(np.mean([t.along for t in inclined]))
    rows.append(compare("first failure from the flaw's middle, half lengths", "1", 1.0, tips, 0.2, BOBET))
    later = float(np.nanmean([t.shear_onset / t.onset for t in inclined]))
    rows.append(
        predict("first shear failure over first failure, load", "1", later, BOBET + "; shear cracks come later")
    )
    weaker = float(np.mean([t.peak < UCS for told in found.values() for t in told]))
    rows.append(compare("peak below that of intact rock, fraction of runs", "1", 1.0, weaker, 0.0, YANG))

    def draw(figure):
        axes = _draw(figure, found, "One flaw of 15 mm in 50 mm: mean and range over seeds and cells")
        axes.axhline(UCS / MPa, color="k", linestyle="--", linewidth=0.8, label="intact")
        axes.set_xlabel("angle of the flaw from the horizontal [degrees]")
        axes.legend()

    return Outcome(tuple(rows), draw)


def two_flaws(full: bool) -> Outcome:
    """Bridging angles of two flaws of 12 mm, 12 mm apart, at 45 degrees."""
    found = {
        b: [tell(to_the_peak("two_flaws", bridging_angle=b, seed=s, **QUICK)) for s in SEEDS] for b in BRIDGING
    }  # fmt: skip
    rows = [row for b in BRIDGING for row in _predicted(f"bridging angle {b:g} degrees", found[b])]
    tensile = float(np.mean([t.tensile for told in found.values() for t in told]))
    rows.append(compare("first failure is tensile, fraction of runs", "1", 1.0, tensile, 0.0, BOBET))

    def draw(figure):
        axes = _draw(figure, found, "Two flaws of 12 mm, 12 mm apart, at 45 degrees: mean and range over seeds")
        axes.set_xlabel("bridging angle [degrees]")
        axes.legend()

    return Outcome(tuple(rows), draw)


INTACT = (
    Input("cohesion", 5.95 * MPa, "Pa", "Gao et al. 2023, sec. 4.1"),
    Input("friction_angle", 40.0, "degrees", "Gao et al. 2023, sec. 4.1"),
    Input("tensile_strength", 2.0 * MPa, "Pa", "Gao et al. 2023, sec. 4.1"),
    Input("G_f_I", 5.0, "J/m^2", "`lab_rock`: see rsmpm_ti/rock/presets.py"),
    Input("G_f_II", 240.0, "J/m^2", "`lab_rock`; case `mode_two` says what depends on it"),
)

CASES = (
    Experiment("one_flaw", "one flaw: first failure and peak against its angle, from intact tests alone",
               one_flaw, quick=False, inputs=INTACT),
    Experiment("two_flaws", "two flaws: first failure and peak against the bridging angle, from intact tests alone",
               two_flaws, quick=False, inputs=INTACT),
)  # fmt: skip
