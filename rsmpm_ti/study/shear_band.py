"""Shear bands through intact rock in compression: their angle, held against Mohr and Coulomb's."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.case import Outcome, Row, at_most, difference
from rsmpm_ti.records.snapshot import SHEAR
from rsmpm_ti.study.runs import Run, Study

SEEDS = tuple(range(1, 9))
WIDTH = 4e-3
"""Width of the strip in which a band is looked for [m]: bands are 3 to 4 mm wide at dx = 1 mm, not quite straight."""

STEP = 0.5
"""Angles are tried at this distance [degrees]."""

ARTHUR, COULOMB = 55.0, 65.0
"""45 + (phi + psi)/4 and 45 + phi/2 [degrees] with phi = 40, from the plane on which the major principal stress acts.

Arthur et al. (1977), Geotechnique 27:53; Coulomb (1776). This rock slips at constant volume, psi = 0, for which Roscoe
(1970), Geotechnique 20:129, has 45 + psi/2 = 45. What lies between Roscoe and Coulomb is admissible; Arthur's is what
is mostly measured.
"""


@dataclass(frozen=True, kw_only=True)
class Strip:
    """A straight strip: angle from +x [degrees, 0 to 180); place: of its middle line along the normal
    (-sin, cos) of that angle [m]; inside: bool [e]."""

    angle: float
    position: float
    inside: np.ndarray


def fullest_strip(x: np.ndarray, lowest: float, highest: float, width: float = WIDTH) -> Strip:
    """The strip `width` [m] wide that holds most of positions x [e, 2] [m], at an angle in [lowest, highest] degrees.

    Straight lines by voting (Duda & Hart 1972, Commun. ACM 15:11): branches and bands of the other sense, which would
    turn a principal axis, have no say. Of equally full strips, the first.
    """
    best, most = (lowest, 0.0), -1
    for angle in np.arange(lowest, highest + 0.5 * STEP, STEP):
        across = np.sort(x @ _normal(angle))
        held = np.searchsorted(across, across + width, side="right") - np.arange(len(x))
        if held.max() > most:
            first = int(held.argmax())
            most, best = int(held[first]), (float(angle), float(across[first] + 0.5 * width))
    angle, position = best
    return Strip(angle=angle, position=position, inside=np.abs(x @ _normal(angle) - position) <= 0.5 * width)


def _normal(angle: float) -> np.ndarray:
    return np.array([-np.sin(np.radians(angle)), np.cos(np.radians(angle))])


def bands(x: np.ndarray) -> list[Strip]:
    """The fullest strip that rises to the right and the one that rises to the left, the fuller first. x [e, 2] [m]."""
    pair = [fullest_strip(x, 20.0, 85.0), fullest_strip(x, 95.0, 160.0)]
    return sorted(pair, key=lambda strip: -int(strip.inside.sum()))


def crush(*, dx: float, seed: int) -> dict:
    """`intact_weibull` to its end: places where particles lost half their cohesion, and peak stress over UCS."""
    scene = load_scene("intact_weibull", dx=dx, seed=seed, time_scale=20.0)
    result = simulate(scene, threads=1)
    ucs = scene.rock.criterion.ucs
    return {
        "x": result.events.x[result.events.mode == SHEAR],
        "peak": np.array(result.summary["largest_stress_Pa"] / ucs),
    }


def runs(quick: bool) -> list[Run]:
    seeds = SEEDS[:1] if quick else SEEDS
    return [Run(f"seed_{seed}", crush, {"dx": 1e-3, "seed": seed}) for seed in seeds]


def finish(results: dict) -> Outcome:
    rows: list[Row] = []
    steepness = []
    for tag, result in results.items():
        strip = bands(result["x"])[0]
        steep = min(strip.angle, 180.0 - strip.angle)
        steepness.append(steep)
        what = f"{tag}: angle of the fullest band from the horizontal [degrees]"
        rows.append(difference(what, ARTHUR, steep, COULOMB - ARTHUR, "between Roscoe's 45 and Coulomb's 65"))
        why = "rock with weak places is weaker than without"
        rows.append(at_most(f"{tag}: peak stress over UCS of the uniform rock", float(result["peak"]), 1.0, why))

    if len(steepness) > 1:
        error, why = np.std(steepness, ddof=1) / np.sqrt(len(steepness)), "twice the standard error of the mean"
        rows.append(difference("mean angle [degrees]", ARTHUR, float(np.mean(steepness)), 2.0 * float(error), why))

    def draw(figure):
        figure.set_size_inches(9.0, 3.6 * -(-len(results) // 4))
        axes = np.atleast_1d(figure.subplots(-(-len(results) // 4), min(4, len(results)), sharey=True)).ravel()
        for ax, (tag, result) in zip(axes, results.items(), strict=False):
            x = result["x"]
            ax.plot(*(1e3 * x.T), ".", color="0.7", markersize=1.0)
            for strip, colour in zip(bands(x), ("C0", "C1"), strict=True):
                steep = min(strip.angle, 180.0 - strip.angle)
                ax.plot(*(1e3 * x[strip.inside].T), ".", color=colour, markersize=1.0, label=f"{steep:.1f} degrees")
            ax.set(aspect="equal", xlabel="x [mm]", title=tag, xlim=(-15, 65), ylim=(0, 100))
            ax.legend(fontsize=7)
        for ax in axes[::4]:
            ax.set_ylabel("y [mm]")

    return Outcome(tuple(rows), draw)


STUDIES = (Study("shear_band", "angle of shear bands through intact heterogeneous rock, eight seeds", runs, finish),)
