"""Onset load and direction of the first crack against the angle of a flaw, in the slit cube and the slit disc.

Held against finite elements of the same flaw, whose mean stress is what cracks this rock (see `mean_stress`), and
against the generalised maximum tangential stress criterion (see `gmts`), which is for a sharp crack and needs a
distance r_c. The rock here judges the mean stress over 1 mm beside a flaw 3 mm wide with round ends, for which no r_c
follows from theory: it is fitted to one number, the onset load of the cube's flaw at FITTED degrees, and then used at
every other angle and in the disc. Where the criterion finds no tension at r_c, a flaw nearly along the load, it
predicts nothing and nothing is compared.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Outcome, Row, at_least, at_most, difference, relative
from rsmpm_ti.study import gmts, mean_stress
from rsmpm_ti.study.flaw_cracks import MIDDLE, WIDTH, Beginning, crack, read_beginning
from rsmpm_ti.study.mean_stress import ANGLES, HALF, TENSILE
from rsmpm_ti.study.runs import Run, Study

FITTED = 45.0
QUICK = (0.0, 30.0, 45.0, 60.0, 90.0)
HELD = {"cube": (30.0, 45.0, 60.0, 75.0), "disc": (0.0, 15.0, 30.0, 45.0)}
"""Angles at which a flaw cracks from its ends."""

ACROSS = {"cube": 0.0, "disc": 90.0}
"""Angles at which a flaw is perpendicular to the load."""


@dataclass(frozen=True)
class Prediction:
    """At a flaw's end: angle [degrees], NaN for none; there and at its middle: stress over nominal stress."""

    angle: float
    end: float
    middle: float

    @property
    def load(self) -> float:
        """Nominal stress at onset [Pa]; infinite where nothing is in tension."""
        most = max(self.end, self.middle)
        return TENSILE / most if most > 0.0 else math.inf


def predict(specimen: str, angle: float, r_c: float) -> Prediction:
    """What the criterion says of a flaw at `angle` [degrees]; r_c [m]."""
    sif, middle = {
        "cube": (gmts.sif_cube, gmts.mid_face_cube),
        "disc": (gmts.sif_disc, gmts.mid_face_disc),
    }[specimen]
    a = HALF[specimen]
    return Prediction(*gmts.tip(sif(angle), r_c / a), middle(angle, 0.5 * WIDTH / a))


def runs(quick: bool) -> list[Run]:
    """The lab's rock at dx = 0.5 mm and, for comparison, the paper's rule at 1 mm; quick: the first at QUICK angles.

    Cells of 1 mm are as large as the length of the mean that finite elements were averaged over, and refused.
    """
    plan = [("lab", specimen, angle) for specimen in HALF for angle in (QUICK if quick else ANGLES)]
    plan += [] if quick else [("paper", specimen, angle) for specimen in HALF for angle in ANGLES]
    return [
        Run(
            f"{rock}_{specimen}_{angle:g}",
            crack,
            {
                "specimen": specimen,
                "angle": angle,
                "dx": 0.5e-3 if rock == "lab" else 1e-3,
                "paper": rock == "paper",
            },
        )
        for rock, specimen, angle in plan
    ]


def fit(found: dict[float, Beginning]) -> float:
    """r_c [m] at which the criterion gives the onset load of the cube's flaw at FITTED degrees."""
    return gmts.critical_distance(gmts.sif_cube(FITTED), HALF["cube"], TENSILE / found[FITTED].stress)


def angle_rows(specimen: str, found: dict[float, Beginning], r_c: float) -> list[Row]:
    """First cracks against the criterion; and where a flaw across the load cracks."""
    rows = []
    for angle in HELD[specimen]:
        expected = predict(specimen, angle, r_c).angle
        if angle in found and math.isfinite(expected):
            at, why = f"flaw at {angle:g} degrees [deg]", "what a strength law can claim: docs/references.md, section 9"
            rows.append(difference(f"{specimen}: angle of first cracks, {at}", expected, found[angle].first, 10.0, why))
    along = found[ACROSS[specimen]].along
    why = "from its middle, as sandstone discs do: docs/references.md, section 18"
    rows.append(at_most(f"{specimen}: onset, along/half length, flaw across the load", along, MIDDLE, why))
    return rows


def mean_stress_rows(specimen: str, found: dict[float, Beginning]) -> list[Row]:
    """First cracks and onset loads against finite elements; the angle where the flaw does not lie along the load."""
    rows = []
    for angle, expected in mean_stress.kept()[specimen].items():
        if angle in found:
            name, why = f"{specimen}, FE: %s, flaw at {angle:g} degrees", "a tenth: a mean over a cell or two at a face"
            rows.append(relative(name % "onset load [Pa]", expected["stress"], found[angle].stress, 0.1, why))
            why = "first cracks scatter by that along a round end"
            rows.append(difference(name % "angle [deg]", expected["first"], found[angle].first, 5.0, why))
    return rows


def trend(specimen: str, found: dict[float, Beginning], r_c: float) -> tuple[float, float]:
    """Correlation of the logarithms of onset loads, measured and predicted, and rms of the logarithm of their ratio,
    both loads over that at FITTED degrees; at the angles where the criterion predicts a load."""
    pairs = [(found[angle].stress, predict(specimen, angle, r_c).load) for angle in found]
    at_fitted = np.log((found[FITTED].stress, predict(specimen, FITTED, r_c).load))
    logs = np.array([np.log(pair) - at_fitted for pair in pairs if math.isfinite(pair[1])])
    if len(logs) < 3:
        return math.nan, math.nan
    return float(np.corrcoef(logs.T)[0, 1]), float(np.sqrt(np.mean((logs[:, 0] - logs[:, 1]) ** 2)))


def finish(results: dict) -> Outcome:
    found: dict[tuple[str, str], dict[float, Beginning]] = {}
    for tag, result in results.items():
        rock, specimen, angle = tag.split("_")
        found.setdefault((rock, specimen), {})[float(angle)] = read_beginning(result)
    r_c = fit(found["lab", "cube"])
    why = "fitted, not compared: any length below half the flaw's"
    rows = [at_most("r_c from the cube's onset load at 45 degrees [m]", r_c, HALF["cube"], why)]
    for specimen in HALF:
        rows += mean_stress_rows(specimen, found["lab", specimen])
        rows += angle_rows(specimen, found["lab", specimen], r_c)
        correlation, rms = trend(specimen, found["lab", specimen], r_c)
        why = "nine tenths: the order of the angles and the shape of the curve"
        rows.append(at_least(f"{specimen}: correlation of log onset loads with the criterion's", correlation, 0.9, why))
        why = "a fifth: the flaw is a slot, twice as wide as r_c, and no crack"
        rows.append(at_most(f"{specimen}: rms log of onset load over the criterion's, 1 at 45", rms, 0.2, why))
    expected, got = predict("disc", FITTED, r_c).load, found["lab", "disc"][FITTED].stress
    why = "no freedom left: r_c is the cube's; its error in the slot's field counts fully"
    rows.append(relative("disc: onset load at 45 degrees [Pa]", expected, got, 0.3, why))
    return Outcome(tuple(rows), lambda figure: draw(figure, found, r_c))


def draw(figure, found: dict[tuple[str, str], dict[float, Beginning]], r_c: float) -> None:
    """Angle and onset load against the flaw's angle, for cube and disc."""
    figure.set_size_inches(9.0, 7.5)
    beta = np.linspace(0.0, 90.0, 91)
    load_line = {"cube": "platens", "disc": "line of the load"}
    for (left, right), specimen in zip(figure.subplots(2, 2, sharex=True), HALF, strict=True):
        theory = [predict(specimen, angle, r_c) for angle in beta]
        sharp = [predict(specimen, angle, 1e-6 * HALF[specimen]).angle for angle in beta]
        left.plot(beta, [p.angle for p in theory], "k-", label=f"GMTS, $r_c$ = {1e3 * r_c:.2f} mm")
        left.plot(beta, sharp, "k:", label="MTS, $r_c$ = 0")
        right.plot(beta, [1e-6 * TENSILE / p.end if p.end > 0.0 else np.nan for p in theory], "k-", label="GMTS, end")
        middle = [1e-6 * TENSILE / p.middle if p.middle > 0.0 else np.nan for p in theory]
        right.plot(beta, middle, "k--", label="Inglis, middle of the face")
        exact = mean_stress.kept()[specimen]
        left.plot(
            list(exact), [crack["first"] for crack in exact.values()], "C2^-", ms=4, label="FE of the slot, 1 mm mean"
        )
        right.plot(
            list(exact), [1e-6 * crack["stress"] for crack in exact.values()], "C2^-", ms=4, label="FE of the slot"
        )
        for rock, style, name in (("lab", "o", "directional, 1 mm mean"), ("paper", "s", "paper's rule")):
            beginnings = found.get((rock, specimen), {})
            angles = np.array(sorted(beginnings))
            colour = {"lab": "C0", "paper": "C1"}[rock]
            if len(angles) == 0:
                continue
            if rock == "lab":
                left.plot(
                    angles, [beginnings[k].first for k in angles], style, color=colour, label=f"{name}: first cracks"
                )
            path = [beginnings[k].path for k in angles]
            left.plot(angles, path, style, color=colour, mfc="none", label=f"{name}: first 3 mm")
            right.plot(angles, [1e-6 * beginnings[k].stress for k in angles], style, color=colour, label=name)
        left.set(title=specimen, ylabel="angle from the flaw's plane [degrees]", ylim=(-5, 185))
        stresses = [p.load for p in theory if math.isfinite(p.load)]
        top = max([*stresses[:1], *(b.stress for k, v in found.items() if k[1] == specimen for b in v.values())])
        right.set(title=specimen, ylabel="nominal stress at onset [MPa]", ylim=(0.0, 1.2e-6 * top))
        for axes in (left, right):
            axes.set_xlabel(f"angle of the flaw from the {load_line[specimen]} [degrees]")
            axes.legend(fontsize=7)


STUDIES = (Study("flaw_angle", "onset load and first direction against the flaw's angle, cube and disc", runs, finish),)
