"""The two wings of one flaw: bands of failed particles from its tips, where they start, lean and end. NumPy only."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.crack_path import REACH
from rsmpm_ti.analysis.neighbours import components, pairs_within
from rsmpm_ti.spec.regions import Slit

TIP_RADIUS = 3.0e-3
"""A crack belongs to a tip when its first failed particle lies within this distance of the flaw's end [m]."""

FIT_LENGTH = 3.0e-3
"""The initiation angle is fitted over this length from the first failed particle [m]."""

MIN_PARTICLES = 6
"""Fewer failed particles than this make no line."""


@dataclass(frozen=True)
class Wing:
    """The crack that grew from one tip. `points` [n, 2] are failure places in order of time."""

    tip: np.ndarray
    start: np.ndarray
    points: np.ndarray


def wings(x: np.ndarray, slit: Slit, spacing: float) -> list[Wing | None]:
    """The crack at each end of a flaw, the end along +direction first; None where nothing has grown.

    x [e, 2]: places of tension failures in order of time; spacing: initial particle spacing [m]. Failed particles are
    one crack when each is within REACH spacings of another.
    """
    return [_wing(x, slit, spacing, sign) for sign in (1.0, -1.0)]


def _wing(x: np.ndarray, slit: Slit, spacing: float, sign: float) -> Wing | None:
    outward = sign * slit.direction
    tip = np.array(slit.centre[:2]) + 0.5 * slit.length * outward
    near = np.flatnonzero(np.linalg.norm(x - tip, axis=1) < TIP_RADIUS)
    if len(near) == 0:
        return None
    half = (x - np.array(slit.centre[:2])) @ outward > 0.0  # the other tip's crack is never part of this one
    member = _connected(x, REACH * spacing, near[0], half)
    points, start = x[member], x[near[0]]
    return Wing(tip=tip, start=start, points=points)


def leaving_angle(points: np.ndarray, start: np.ndarray, outward: np.ndarray) -> float:
    """Angle between `outward` and the line fitted to a crack's places within FIT_LENGTH of its start, degrees in
    [0, 180]; NaN for fewer than MIN_PARTICLES such places. points [e, 2], start [2] [m]; outward: unit vector [2]."""
    close = points[np.linalg.norm(points - start, axis=1) < FIT_LENGTH]
    if len(close) < MIN_PARTICLES:
        return float("nan")
    centred = close - close.mean(axis=0)
    direction = np.linalg.svd(centred, full_matrices=False)[2][0]
    if direction @ (close.mean(axis=0) - start) < 0.0:
        direction = -direction
    return float(np.degrees(np.arccos(np.clip(direction @ outward, -1.0, 1.0))))


def crack_directions(local: np.ndarray, normal: np.ndarray, half: float) -> np.ndarray:
    """Angles from a flaw's plane, outwards, at which cracks beside it point away from it [k], [degrees].

    local [k, 2]: places along and across the flaw from its middle [m]; normal [k]: of the cracks, from the flaw's plane
    [rad]; half: of the flaw's length, between the centres of its round ends [m]. A crack is a line; of its two
    directions the one counts that leads away from the flaw's face beside it.
    """
    end = np.sign(local[:, 0])
    face = np.stack([end * np.maximum(np.abs(local[:, 0]) - half, 0.0), local[:, 1]], axis=1)
    line = np.stack([-np.sin(normal), np.cos(normal)], axis=1)
    along = line[:, 0] * np.where(np.sum(line * face, axis=1) < 0.0, -1.0, 1.0)
    return np.degrees(np.arccos(np.clip(end * along, -1.0, 1.0)))


def first_crack_angles(x: np.ndarray, normal: np.ndarray, slit: Slit) -> list[float]:
    """Mean angle from the flaw's plane of the FEWEST first cracks at each end, the end along +direction first; NaN for
    fewer. x [e, 2] [m], normal [e] [rad from +x]: of tension failures in order of time."""
    local, normal = slit.frame(x), normal - np.radians(slit.angle)
    ends = np.array([[0.5 * slit.length, 0.0], [-0.5 * slit.length, 0.0]])
    near = [np.flatnonzero(np.linalg.norm(local - end, axis=1) < TIP_RADIUS + 0.5 * slit.width) for end in ends]
    angles, half = [], 0.5 * (slit.length - slit.width)
    for k in near:
        first = crack_directions(local[k[:MIN_PARTICLES]], normal[k[:MIN_PARTICLES]], half)
        angles.append(float(first.mean()) if len(first) == MIN_PARTICLES else float("nan"))
    return angles


def _connected(x: np.ndarray, reach: float, seed: int, allowed: np.ndarray) -> np.ndarray:
    """Indices of the points joined to `seed` through gaps of at most `reach`."""
    a, b = pairs_within(x, reach)
    both = allowed[a] & allowed[b]
    labels = components(len(x), a[both], b[both])
    return np.flatnonzero((labels == labels[seed]) & allowed)


def centre_line(points: np.ndarray, axis: int, bin_size: float) -> tuple[np.ndarray, np.ndarray]:
    """Mean lateral place of a crack in bins along the loading axis: (along, lateral) [m]."""
    bins = np.floor(points[:, axis] / bin_size).astype(int)
    along = np.unique(bins)
    lateral = np.array([points[bins == b, 1 - axis].mean() for b in along])
    return (along + 0.5) * bin_size, lateral


def half_turn_mismatch(pair: list[Wing | None], slit: Slit, axis: int, length: float, bin_size: float) -> float:
    """Largest lateral distance [m] between one wing and the other turned by 180 degrees, over the first `length` [m]
    along the loading axis; NaN unless both wings are that long."""
    centre = np.array(slit.centre[:2])
    lines = []
    for wing, sign in zip(pair, (1.0, -1.0), strict=True):
        if wing is None:
            return float("nan")
        local = sign * (wing.points - centre)
        rise = np.abs(local[:, axis] - sign * (wing.tip - centre)[axis])
        along, lateral = centre_line(local[rise <= length], axis, bin_size)
        if len(along) < 0.9 * length / bin_size:
            return float("nan")
        lines.append(dict(zip(np.round(along / bin_size, 1), lateral, strict=True)))
    common = lines[0].keys() & lines[1].keys()
    return float(max(abs(lines[0][b] - lines[1][b]) for b in common))
