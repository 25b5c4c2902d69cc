"""How far the wings of a flaw follow columns, and what else the paper's example is held to. NumPy only."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from rsmpm_ti.analysis.crack_bands import find_bands
from rsmpm_ti.analysis.wing_cracks import Wing, centre_line, half_turn_mismatch, leaving_angle, wings
from rsmpm_ti.records.snapshot import TENSION
from rsmpm_ti.results.result import Result
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.spec.scene import Scene

NEAR = 3.0
"""A failed particle further than this many cells from every crack is a speck."""

LOAD_AXIS = 1


@dataclass(frozen=True, kw_only=True)
class Picture:
    """What a run's wings look like. Lengths in m, angles in degrees; of each wing, that of the upper end first."""

    column: tuple[float, ...]  # longest stretch whose middle stays within one particle spacing
    cell: tuple[float, ...]  # longest stretch whose middle stays within one cell
    to_platen: tuple[float, ...]  # from the wing's end to the platen that it grows towards
    angle: tuple[float, ...]  # from the flaw's plane
    width: tuple[float, ...]  # area of the wing's particles over its extent along the load
    mismatch: float  # of one wing with the other turned by 180 degrees, over the length that both have
    specks: int  # failed particles further than NEAR cells from every crack
    first: float  # nominal stress at first failure [Pa]


def picture_of(result: Result, scene: Scene) -> Picture:
    """Measure the wings of a scene with one slit in a plate between two platens, loaded along y."""
    dx, spacing, slit = scene.domain.dx, spacing_of(result), slit_of(scene)
    tension = result.events.mode == TENSION
    pair = wings(result.events.x[tension].astype(float), slit, spacing)
    assert None not in pair, "both wings have grown"
    lower, upper = scene.bodies[0].region.bounds()
    ends = ((upper[1], max), (lower[1], min))
    tops = [float(end(wing.points[:, 1])) for wing, (_, end) in zip(pair, ends, strict=True)]
    rises = [abs(top - wing.tip[1]) for wing, top in zip(pair, tops, strict=True)]
    return Picture(
        column=tuple(longest_stretch(wing, spacing, dx) for wing in pair),
        cell=tuple(longest_stretch(wing, dx, dx) for wing in pair),
        to_platen=tuple(float(abs(end - top)) for top, (end, _) in zip(tops, ends, strict=True)),
        angle=tuple(
            leaving_angle(wing.points, wing.start, sign * slit.direction)
            for wing, sign in zip(pair, (1.0, -1.0), strict=True)
        ),
        width=tuple(len(wing.points) * spacing**2 / rise for wing, rise in zip(pair, rises, strict=True)),
        mismatch=half_turn_mismatch(pair, slit, LOAD_AXIS, min(rises), 2.0 * dx),
        specks=specks(result, spacing, dx),
        first=result.summary["first_failure_stress_Pa"],
    )


def slit_of(scene: Scene) -> Slit:
    (slit,) = scene.bodies[0].region.removed
    return slit


def spacing_of(result: Result) -> float:
    """Particle spacing, from the area of a particle [m]."""
    return float(np.sqrt(np.median(result.snapshot.volume)))


def longest_stretch(wing: Wing, strip: float, dx: float) -> float:
    """Longest extent along the load over which the middle of a wing stays within a strip along the load [m].

    The middle is the mean lateral place of the failures in bins of one cell along the load, so a band several particles
    wide counts as one line. strip: width [m].
    """
    along, lateral = centre_line(wing.points, LOAD_AXIS, dx)
    longest, first = 0.0, 0
    for last in range(len(along)):
        while np.ptp(lateral[first : last + 1]) > strip:
            first += 1
        longest = max(longest, along[last] - along[first] + dx)
    return float(longest)


def specks(result: Result, spacing: float, dx: float) -> int:
    """Failures further than NEAR cells from every crack, a band of several failed particles."""
    bands, _ = find_bands(result.events, spacing)
    x = result.events.x.astype(float)
    if not bands:
        return len(x)
    return int(np.sum(cKDTree(x[np.concatenate(bands)]).query(x)[0] > NEAR * dx))
