"""Ends of flaws, and where, when and how rock first breaks at each. NumPy only, 2D."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from rsmpm_ti.analysis.load_curve import load_at
from rsmpm_ti.analysis.wing_cracks import FIT_LENGTH, MIN_PARTICLES, TIP_RADIUS, crack_directions, leaving_angle
from rsmpm_ti.records.snapshot import MODE_NAMES, TENSION
from rsmpm_ti.spec.regions import Slit


@dataclass(frozen=True, kw_only=True)
class FlawTip:
    """One end of a flaw. name: "0+" is the end of the first flaw along its direction, "0-" the other."""

    name: str
    position: np.ndarray  # [m], [2]
    outward: np.ndarray  # unit vector from the flaw's middle to this end, [2]
    reach: float  # what breaks first within this distance broke at this end [m]
    flaw: Slit


def flaw_tips(slits: tuple[Slit, ...]) -> tuple[FlawTip, ...]:
    """Both ends of each flaw, the one along +direction first.

    An end's reach is TIP_RADIUS from its corners, which lie half a width from its middle.
    """
    return tuple(
        FlawTip(
            name=f"{k}{'+' if sign > 0.0 else '-'}",
            position=np.array(slit.centre[:2]) + 0.5 * sign * slit.length * slit.direction,
            outward=sign * slit.direction,
            reach=TIP_RADIUS + 0.5 * slit.width,
            flaw=slit,
        )
        for k, slit in enumerate(slits)
        for sign in (1.0, -1.0)
    )


def nearest_tip(x: np.ndarray, tips: tuple[FlawTip, ...]) -> np.ndarray:
    """Index of the nearest tip to each place x [e, 2], -1 where that is beyond the tip's reach, [e]."""
    if not tips or len(x) == 0:
        return np.full(len(x), -1)
    far, nearest = cKDTree(np.stack([tip.position for tip in tips])).query(x[:, :2])
    return np.where(far < np.array([tip.reach for tip in tips])[nearest], nearest, -1)


FIRST = 20
"""At most so many failures at a tip give the angle of the crack that begins there, at least MIN_PARTICLES."""


def first_angle(events, rows: np.ndarray, tip: FlawTip) -> float:
    """Angle from a flaw's continuation at which a crack left its tip [degrees, 0 to 180]; NaN for too few failures.

    rows: of the events (an EventTable), those of one band from the crack's first on, in order of time. A crack in rock
    whose cracks have a direction has the median of the directions of its first failures in tension within the tip's
    reach, FIRST at most: their places say little, since a band of half-broken rock fails here and there. Of other rock,
    and of a crack in shear, it is the line through the places of failure (`wing_cracks.leaving_angle`): of those of the
    first one's mode, and only until the crack is twice FIT_LENGTH away. What crushes at the tip later is no direction
    in which it left.
    """
    x, mode = events.x[rows].astype(float), events.mode[rows]
    normal = events.crack_angle
    if normal is not None and mode[0] == TENSION:
        near = (mode == TENSION) & (np.linalg.norm(x - tip.position, axis=1) < tip.reach)
        first = np.flatnonzero(near)[:FIRST]
        if len(first) < MIN_PARTICLES:
            return float("nan")
        flaw, across = tip.flaw, normal[rows][first] - np.radians(tip.flaw.angle)
        return float(np.median(crack_directions(flaw.frame(x[first]), across, 0.5 * (flaw.length - flaw.width))))
    far = np.linalg.norm(x - x[0], axis=1)
    away = (far > 2.0 * FIT_LENGTH) & (far < 3.0 * FIT_LENGTH)  # farther ones may have come from another tip
    early = np.arange(len(x)) < (int(np.argmax(away)) if away.any() else len(x))
    return leaving_angle(x[early & (mode == mode[0])], x[0], tip.outward)


def initiations(events, bands: list[np.ndarray], tips: tuple[FlawTip, ...], history: np.ndarray) -> list[dict]:
    """The first failure near each tip that became part of a crack: one entry per tip, None in it where nothing grew.

    events: an EventTable; bands: event numbers of each crack. Stress [Pa] and strain are nominal, compression positive;
    the angle is between the flaw's continuation and the crack, degrees.
    """
    tip_of, band_of = nearest_tip(events.x, tips), np.full(len(events), -1)
    for k, band in enumerate(bands):
        band_of[band] = k
    entries = []
    for k, tip in enumerate(tips):
        entry = {"flaw": int(tip.name[:-1]), "tip": tip.name, "tip_m": tip.position.tolist()}
        entry |= dict.fromkeys(
            ("stress_Pa", "strain", "time_s", "true_time_s", "position_m", "angle_deg", "mode", "crack")
        )
        mine = np.flatnonzero((tip_of == k) & (band_of >= 0))
        if len(mine):
            e = mine[0]
            stress, strain = (float(v) for v in load_at(history, events.time[e]))
            band = bands[band_of[e]]
            since = band[band >= e]
            angle = first_angle(events, since, tip)
            entry |= {
                "stress_Pa": stress if np.isfinite(stress) else None,
                "strain": strain if np.isfinite(strain) else None,
                "time_s": float(events.time[e]),
                "true_time_s": float(events.true_time[e]),
                "position_m": events.x[e].tolist(),
                "angle_deg": angle if np.isfinite(angle) else None,
                "mode": MODE_NAMES[events.mode[e]],
                "crack": int(band_of[e]),
            }
        entries.append(entry)
    return entries
