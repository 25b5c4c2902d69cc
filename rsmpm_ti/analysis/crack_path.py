"""The line through a band of failed particles, and how it lengthens: path, growth, tip speed and what bounds it.

The band's neighbour graph joins places at most `reach` apart; a distance within the band is the shortest way along
joined places (Dijkstra 1959). The path follows the band's geodesic diameter, so a branch shorter than it is not in it,
and a closed ring counts half its way round.
"""

import numpy as np
from scipy.optimize import brentq
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra
from scipy.spatial import cKDTree

BIN = 2.0
"""Places are averaged over this many initial spacings along the path: one cell with two particles per axis."""

ROUNDS = 2
"""Times the line is centred, and smoothed."""

REACH = 2.5
"""Failed particles are one band when each is within this many initial spacings of another: one full cell between
neighbours still reads as joined."""


WINDOW = 20e-6
"""Tip speed is the growth over this time [s], times the scene's time_scale: particles fail one by one, so over shorter
times the speed would be that of single failures. At the Rayleigh speed of rock a crack grows 30 mm in it."""


def distances(graph: csr_array, source: int) -> np.ndarray:
    """Shortest way within the band from one place to each [m], [e]."""
    return dijkstra(graph, directed=False, indices=source)


def centre_path(x: np.ndarray, graph: csr_array, spacing: float, seed: int = 0) -> np.ndarray:
    """Polyline [k, 2] along the middle of one connected band x [e, 2] [m], from one of its ends to the other, k >= 2.

    Two sweeps give the ends: the place furthest from `seed`, and the place furthest from that one. Those places of the
    band that lie within `REACH` spacings of the shortest way between them, so none far out on a branch, are averaged in
    bins of `BIN` spacings of their distance from the first end. That is done again about the line found, which brings
    it from the inside of a bend to the middle of the band. The averages are smoothed by (1, 2, 1)/4 twice, since
    the scatter of a ragged band's bins would otherwise lengthen it by some percent, and the ends prolonged to where
    the band ends.
    """
    first = int(np.argmax(distances(graph, seed)))
    along, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
    route = [int(np.argmax(along))]
    while route[-1] != first:
        route.append(int(before[route[-1]]))
    count = max(2, round(along[route[0]] / (BIN * spacing)))
    bins = np.minimum((along / along[route[0]] * count).astype(int), count - 1)
    path = x[route]
    for _ in range(ROUNDS):
        near = cKDTree(path).query(x)[0] <= REACH * spacing
        used, bin_of = np.unique(bins[near], return_inverse=True)
        path = np.stack([np.bincount(bin_of, x[near, a]) / np.bincount(bin_of) for a in range(2)], axis=1)
    if len(path) < 2 or path_length(path) == 0.0:
        return x[[first, route[0]]]
    for _ in range(ROUNDS):
        path[1:-1] = 0.25 * (path[:-2] + 2.0 * path[1:-1] + path[2:])
    ends = []
    for end, inner, last in ((path[0], path[1], 0), (path[-1], path[-2], len(used) - 1)):
        outward = (end - inner) / np.linalg.norm(end - inner)
        ends.append(end + max(0.0, float(((x[near][bin_of == last] - end) @ outward).max())) * outward)
    path[0], path[-1] = ends
    return path


def path_length(path: np.ndarray) -> float:
    """Length of a polyline [k, 2] [m]."""
    return float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum())


def tortuosity(path: np.ndarray) -> float:
    """Length of the path over the distance of its ends, at least 1."""
    return path_length(path) / float(np.linalg.norm(path[-1] - path[0]))


def mean_direction(path: np.ndarray) -> float:
    """Axial mean of the segments' directions weighted by length, from +x, degrees in [0, 180).

    A line has no sense, so angles are doubled before they are averaged (Mardia 1972).
    """
    d = np.diff(path, axis=0)
    length = np.linalg.norm(d, axis=1)
    angle = 2.0 * np.arctan2(d[:, 1], d[:, 0])
    return float(np.degrees(0.5 * np.arctan2(length @ np.sin(angle), length @ np.cos(angle))) % 180.0)


def rayleigh_speed(shear_speed: float, wave_speed: float) -> float:
    """Speed of surface waves [m/s], the limit of a crack in tension (Freund 1990, sec. 7.4), from c_s and c_p [m/s].

    xi^3 - 8 xi^2 + 8 xi (3 - 2 k) - 16 (1 - k) = 0, xi = (c_R/c_s)^2, k = (c_s/c_p)^2 (Rayleigh 1885): the left side
    is negative at xi = 0 and 1 at xi = 1, and has one root between.
    """
    k = (shear_speed / wave_speed) ** 2
    xi = brentq(lambda xi: xi**3 - 8.0 * xi**2 + 8.0 * xi * (3.0 - 2.0 * k) - 16.0 * (1.0 - k), 0.0, 1.0, xtol=1e-15)
    return shear_speed * float(np.sqrt(xi))


def growth(time: np.ndarray, distance: np.ndarray) -> np.ndarray:
    """Length [m] at each failure, [e]: the furthest distance from the first failure so far.

    time [s], ascending, and distance within the band from the first failure [m], both [e].
    """
    # failures of one instant, which one step records in no physical order, all count from it
    last = np.searchsorted(time, time, side="right") - 1
    return np.maximum.accumulate(distance)[last]


def tip_speed(time: np.ndarray, length: np.ndarray, window: float) -> np.ndarray:
    """Growth over the `window` [s] that ends at each failure, over the window [m/s], [e]; before the first, length 0.

    A crack that runs into one that began elsewhere lengthens at a stroke; that is no speed of a tip, and may exceed
    the Rayleigh speed.
    """
    before = np.searchsorted(time, time - window, side="right") - 1
    return (length - np.where(before >= 0, length[np.maximum(before, 0)], 0.0)) / window
