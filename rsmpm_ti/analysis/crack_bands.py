"""Cracks as measured objects: connected bands of failed particles, with their origin, path, growth and opening.

NumPy and SciPy only. In 3D a band has its failures, its origin and its growth; path, angles and opening are 2D.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from rsmpm_ti.analysis.crack_opening import jumps
from rsmpm_ti.analysis.crack_path import (
    REACH,
    WINDOW,
    centre_path,
    distances,
    growth,
    mean_direction,
    path_length,
    tip_speed,
    tortuosity,
)
from rsmpm_ti.analysis.flaw_tips import FlawTip, first_angle, nearest_tip
from rsmpm_ti.analysis.neighbours import bands_of, neighbour_graph
from rsmpm_ti.analysis.wing_cracks import MIN_PARTICLES
from rsmpm_ti.records.snapshot import INTACT, TENSION, Pattern, Snapshot


@dataclass(frozen=True, kw_only=True)
class Origin:
    """The first failure of a crack: time [s], place [m] [dim], mode; and the flaw tip it is near, "" for none, with the
    angle from the flaw's continuation at which the crack leaves it [degrees], NaN for none."""

    time: float
    position: np.ndarray
    mode: int
    tip: str
    angle: float


@dataclass(frozen=True, kw_only=True)
class Course:
    """A crack's line in 2D: path [k, 2] [m], length [m], tortuosity (length over distance of the ends), mean direction
    from +x [degrees, 0 to 180), and width [m]: the area of its failed particles over its length."""

    path: np.ndarray
    length: float
    tortuosity: float
    direction: float
    width: float


ZONE, CELLS = 0.25, 6.0
"""A band wider than this fraction of its length, and than so many spacings, is a zone in which all has failed: a block
that gave way everywhere, or rubble. The line through it would be that of its own shape."""


@dataclass(frozen=True, kw_only=True)
class Crack:
    """One connected band of failed particles."""

    events: np.ndarray  # its rows of the EventTable, in order of time, [m]
    particles: int  # one that failed twice counts once
    tension: int  # failures in tension
    shear: int  # failures in shear
    released: float  # energy [J], per metre in 2D
    shear_energy: float  # what of it was released by shear failures [J]
    origin: Origin
    length_at: np.ndarray  # furthest distance from the origin at each of its events [m], [m]
    speed_at: np.ndarray  # tip speed at each of its events [m/s of the run's time], [m]
    course: Course | None  # None in 3D, and of a zone


def find_bands(events, spacing: float) -> tuple[list[np.ndarray], csr_array]:
    """Cracks as rows of an EventTable, each in order of time, the crack that began first coming first; and the graph.

    Failures within REACH initial spacings [m] of each other are joined; sets of fewer than MIN_PARTICLES particles are
    no cracks.
    """
    graph = neighbour_graph(events.x, REACH * spacing)
    if len(events) == 0:
        return [], graph
    labels = bands_of(graph)
    order = np.argsort(labels, kind="stable")
    bands = np.split(order, np.cumsum(np.bincount(labels))[:-1])
    bands = [band for band in bands if len(np.unique(events.id[band])) >= MIN_PARTICLES]
    return sorted(bands, key=lambda band: band[0]), graph


def measure_cracks(
    events, bands: list[np.ndarray], graph: csr_array, tips: tuple[FlawTip, ...], spacing: float, time_scale: float
) -> list[Crack]:
    """Each band's numbers; bands and graph from `find_bands`, tips from `flaw_tips`, none in 3D."""
    return [_measure(events, band, graph[band][:, band], tips, spacing, time_scale) for band in bands]


def _measure(events, band, graph, tips, spacing, time_scale) -> Crack:
    x, time, mode = events.x[band], events.time[band], events.mode[band]
    released = events.released[band]
    length = growth(time, distances(graph, 0))
    particles = len(np.unique(events.id[band]))
    course = course_of(x, particles, graph, spacing) if x.shape[1] == 2 else None
    near = int(nearest_tip(x[:1], tips)[0])
    angle = first_angle(events, band, tips[near]) if near >= 0 else np.nan
    return Crack(
        events=band,
        particles=particles,
        tension=int(np.sum(mode == TENSION)),
        shear=int(np.sum(mode != TENSION)),
        released=float(released.sum()),
        shear_energy=float(released[mode != TENSION].sum()),
        origin=Origin(
            time=float(time[0]), position=x[0], mode=int(mode[0]), tip=tips[near].name if near >= 0 else "", angle=angle
        ),
        length_at=length,
        speed_at=tip_speed(time, length, WINDOW * time_scale),
        course=course,
    )


def course_of(x: np.ndarray, particles: int, graph, spacing: float) -> Course | None:
    """The line of a band in 2D, None of a zone; x: places of its failures [n, 2] [m], graph: which of them are near."""
    path = centre_path(x, graph, spacing)
    whole = path_length(path)
    width = particles * spacing**2 / whole
    if width > max(ZONE * whole, CELLS * spacing):
        return None
    return Course(path=path, length=whole, tortuosity=tortuosity(path), direction=mean_direction(path), width=width)


def carried(
    paths: list[np.ndarray], bands: list[np.ndarray], events, pattern: Snapshot | Pattern, spacing: float
) -> list[np.ndarray]:
    """Paths of bands, which are places at failure, carried along with the rock to where it is at one instant.

    A point goes as far as the particles of its band around it have gone since they failed, in the median: one that the
    crack has spat out does not draw it away. Left out are bands that have left the domain.
    """
    x = pattern.x[:, :2]
    moved = []
    for path, band in zip(paths, bands, strict=True):
        kept = band[np.isin(events.id[band], pattern.id)]
        way = x[np.searchsorted(pattern.id, events.id[kept])] - events.x[kept]
        kept, way = kept[np.isfinite(way).all(axis=1)], way[np.isfinite(way).all(axis=1)]
        if len(kept):
            tree = cKDTree(events.x[kept])
            around = tree.query_ball_point(path, REACH * spacing)
            nearest = tree.query(path)[1]
            ways = [np.median(way[near], axis=0) if near else way[nearest[k]] for k, near in enumerate(around)]
            moved.append(path + np.array(ways))
    return moved


def openings(cracks: list[Crack], events, snapshot: Snapshot, dx: float) -> list[np.ndarray]:
    """Opening and slip at each point of each crack's path at the snapshot, list of [k, 2] [m] (`crack_opening.jumps`).

    Paths are places at failure, so they are first taken back to where their particles were seeded, as the intact
    particles are, by those of them that have not left the domain; NaN where all have. No points of a zone.
    """
    whole = (snapshot.failure_mode == INTACT) & np.isfinite(snapshot.x).all(axis=1)
    displacement = snapshot.displacement[whole]
    intact = cKDTree(snapshot.x[whole] - displacement)
    found = []
    for crack in cracks:
        if crack.course is None:
            found.append(np.zeros((0, 2)))
            continue
        x, ids = events.x[crack.events], events.id[crack.events]
        kept = np.isin(ids, snapshot.id)
        if not kept.any():
            found.append(np.full_like(crack.course.path, np.nan))
            continue
        rows = np.searchsorted(snapshot.id, ids[kept])
        moved = np.nan_to_num(x[kept] - (snapshot.x[rows] - snapshot.displacement[rows]))
        nearest = cKDTree(x[kept]).query(crack.course.path)[1]
        found.append(jumps(crack.course.path - moved[nearest], intact, displacement, dx))
    return found
