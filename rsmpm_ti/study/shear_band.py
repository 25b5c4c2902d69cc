"""Shear bands through intact rock in compression: their angle against what dilation makes of it."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.case import Outcome, Row, at_most, difference
from rsmpm_ti.records.snapshot import SHEAR
from rsmpm_ti.study.runs import Run, Study

SEEDS, DILATION = tuple(range(1, 9)), (0.0, 10.0, 20.0)
"""Of strength and places; angles of dilation psi [degrees]."""

WIDTH = 4e-3
"""Width of the strip in which a band is looked for [m]: bands are 3 to 4 mm wide at dx = 1 mm, not quite straight."""

STEP = 0.5
"""Angles are tried at this distance [degrees]."""

FRICTION, COULOMB = 40.0, 65.0
"""phi of the rock, and Coulomb's (1776) angle 45 + phi/2 of a band from the plane on which the major principal stress
acts [degrees]."""

CLOSE = 3.0
"""How near the mean of the seeds is to be to Arthur's angle [degrees]."""


def arthur(psi: float) -> float:
    """45 + (phi + psi)/4 [degrees], which is mostly measured: Arthur et al. (1977), Geotechnique 27:53.

    What lies between Roscoe's angle and Coulomb's is admissible.
    """
    return 45.0 + 0.25 * (FRICTION + psi)


def roscoe(psi: float) -> float:
    """45 + psi/2 [degrees]: flow leaves lengths along such a band as they are. Roscoe (1970), Geotechnique 20:129."""
    return 45.0 + 0.5 * psi


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


ENERGY, END = 24.0, 1.2e-3
"""G_f_II [J/m^2], so that rock softens by 0.15 mu and bands within the run, and strain at its end [1]."""


def crush(*, seed: int, psi: float) -> dict:
    """`intact_weibull --quick` to its end: places where particles lost half their cohesion, and peak stress over UCS.

    psi: angle of dilation [degrees]. The rock loses cohesion over ENERGY, a tenth of the scene's own G_f_II.
    """
    scene = load_scene("intact_weibull", quick=True, seed=seed, strain_end=END)
    law = scene.rock.after_failure
    law = replace(law, dilation_angle=psi, softening=replace(law.softening, G_f_II=ENERGY))
    scene = replace(scene, rock=replace(scene.rock, after_failure=law))
    result = simulate(scene, threads=1)
    ucs = scene.rock.criterion.ucs
    return {
        "x": result.events.x[result.events.mode == SHEAR],
        "peak": np.array(result.summary["largest_stress_Pa"] / ucs),
    }


def runs(quick: bool) -> list[Run]:
    """Every seed at every dilation; quick: one seed."""
    seeds = SEEDS[:1] if quick else SEEDS
    return [Run(f"psi{psi:g}_seed{seed}", crush, {"seed": seed, "psi": psi}) for psi in DILATION for seed in seeds]


def steepness(x: np.ndarray) -> float:
    """Angle of the fullest band of places x from the horizontal [degrees]."""
    angle = bands(x)[0].angle
    return min(angle, 180.0 - angle)


def finish(results: dict) -> Outcome:
    rows: list[Row] = []
    found: dict[float, list[float]] = {}
    for tag, result in results.items():
        psi = float(tag.split("_")[0].removeprefix("psi"))
        steep = steepness(result["x"])
        found.setdefault(psi, []).append(steep)
        middle, half = 0.5 * (COULOMB + roscoe(psi)), 0.5 * (COULOMB - roscoe(psi))
        what = f"{tag}: angle of the fullest band from the horizontal [degrees]"
        rows.append(
            difference(what, middle, steep, half, f"between Roscoe's {roscoe(psi):g} and Coulomb's {COULOMB:g}")
        )
        why = "rock with weak places is weaker than without"
        rows.append(at_most(f"{tag}: peak stress over UCS of the uniform rock", float(result["peak"]), 1.0, why))
    for psi, angles in found.items():
        if len(angles) > 1:
            error = np.std(angles, ddof=1) / np.sqrt(len(angles))
            what = f"dilation {psi:g} degrees: mean angle of {len(angles)} bands [degrees]"
            why = f"near Arthur's; standard error of the mean {error:.1f}"
            rows.append(difference(what, arthur(psi), float(np.mean(angles)), CLOSE, why))

    def draw(figure):
        columns = max(len(angles) for angles in found.values())
        figure.set_size_inches(max(1.4 * columns, 4.0), 2.6 * len(found))
        panels = np.atleast_1d(figure.subplots(len(found), columns, sharex=True, sharey=True, squeeze=False))
        for row, psi in zip(panels, found, strict=True):
            tags = [tag for tag in results if tag.startswith(f"psi{psi:g}_")]
            row[0].set_ylabel(f"dilation {psi:g} degrees\ny [mm]")
            for ax, tag in zip(row, tags, strict=False):
                x = results[tag]["x"]
                ax.plot(*(1e3 * x.T), ".", color="0.7", markersize=0.6)
                first, second = bands(x)
                for strip, colour in ((second, "C1"), (first, "C0")):
                    ax.plot(*(1e3 * x[strip.inside].T), ".", color=colour, markersize=0.6)
                ax.set_title(f"{tag.split('_')[1]}: {steepness(x):.1f}", fontsize=8)
                ax.set(aspect="equal", xlim=(-10, 60), ylim=(0, 100))
        for ax in panels[-1]:
            ax.set_xlabel("x [mm]")

    return Outcome(tuple(rows), draw)


STUDIES = (
    Study(
        "shear_band", "angle of shear bands through uneven rock at three angles of dilation, eight seeds", runs, finish
    ),
)
