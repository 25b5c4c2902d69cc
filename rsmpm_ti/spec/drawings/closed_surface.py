"""What lies within a closed surface of triangles in 3D: rays along z and how often they cross it. NumPy only.

A ray crosses a triangle where its point lies in the triangle's shadow on the x-y plane. Whether it does is counted by
its edges, each computed in one way for both of its triangles, so that shadows of neighbours meet without gap or overlap
and a ray through an edge crosses once. A triangle along z has a shadow without area: its neighbours' edges say enough.
"""

from typing import NamedTuple

import numpy as np

PAIRS = 200_000
"""Points and triangles that are held against each other at one time."""

MAX_BINS, MAX_MEMBERS = 512, 20_000_000
"""Bins along an axis, and triangles in all of them together: large triangles lie in many."""


class ClosedSurface(NamedTuple):
    """vertices [n, 3] in metres; triangles [m, 3], numbers of vertices. Columns of the x-y plane hold the triangles
    above them: those of column c are `members[starts[c] : starts[c + 1]]`. shadows: lower and upper corner of each
    triangle's in that plane, [4, m]."""

    vertices: np.ndarray
    triangles: np.ndarray
    shadows: np.ndarray
    bins: np.ndarray
    starts: np.ndarray
    members: np.ndarray

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, 3] -> bool [n]."""
        low, high = self.bounds()
        near = np.flatnonzero(np.all((x > low) & (x < high), axis=1))
        column = _column(_cells(x[near, :2], low, high, self.bins), self.bins)
        ends = np.cumsum(self.starts[column + 1] - self.starts[column])
        inside, first = np.zeros(len(x), dtype=bool), 0
        while first < len(near):
            before = ends[first - 1] if first else 0
            last = max(first + 1, int(np.searchsorted(ends, before + PAIRS)))
            inside[near[first:last]] = self._odd(x[near[first:last]], column[first:last])
            first = last
        return inside

    def _odd(self, x: np.ndarray, column: np.ndarray) -> np.ndarray:
        """Whether a ray upwards from each point crosses the surface an odd number of times, bool [n]."""
        counts = self.starts[column + 1] - self.starts[column]
        point = np.repeat(np.arange(len(x)), counts)
        nth = np.arange(len(point)) - np.repeat(np.cumsum(counts) - counts, counts)
        triangle = self.members[np.repeat(self.starts[column], counts) + nth]
        near = np.ones(len(point), dtype=bool)
        for d in (0, 1):
            place = x[:, d][point]
            near &= (place >= self.shadows[d][triangle]) & (place <= self.shadows[2 + d][triangle])
        point, corner = point[near], self.triangles[triangle[near]]
        p, within = x[point], np.zeros(len(point), dtype=bool)
        for a, b in ((0, 1), (1, 2), (2, 0)):
            first, second = np.minimum(corner[:, a], corner[:, b]), np.maximum(corner[:, a], corner[:, b])
            start, end = self.vertices[first, :2], self.vertices[second, :2]
            spans = np.flatnonzero((start[:, 1] > p[:, 1]) != (end[:, 1] > p[:, 1]))
            s, e, y = start[spans], end[spans], p[spans, 1]
            at = s[:, 0] + (y - s[:, 1]) / (e[:, 1] - s[:, 1]) * (e[:, 0] - s[:, 0])
            at = np.clip(at, np.minimum(s[:, 0], e[:, 0]), np.maximum(s[:, 0], e[:, 0]))  # within the shadow
            within[spans] ^= p[spans, 0] < at
        hit = np.flatnonzero(within)
        a, b, c = (self.vertices[corner[hit, k]] for k in range(3))
        normal = np.cross(b - a, c - a)
        # (p - a) . normal has the sign of the point's height above the plane where the normal looks up
        height = np.einsum("nd,nd->n", p[hit] - a, normal) * np.sign(normal[:, 2])
        crossings = np.bincount(point[hit[height < 0.0]], minlength=len(x))
        return crossings % 2 == 1

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @property
    def hull(self) -> np.ndarray:
        """Points whose convex hull is that of the body [m], [n, 3]."""
        return self.vertices


def closed_surface(vertices: np.ndarray, triangles: np.ndarray) -> ClosedSurface:
    """Of vertices [n, 3], all of which are used, and triangles [m, 3] without open edges (`open_edges`)."""
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    corners = vertices[triangles][:, :, :2]
    shadows = np.concatenate([corners.min(axis=1).T, corners.max(axis=1).T])
    bins = np.full(2, int(np.clip(2.0 * np.sqrt(len(triangles)), 1, MAX_BINS)))
    while True:
        first = _cells(shadows[:2].T, low, high, bins)
        count = _cells(shadows[2:].T, low, high, bins) - first + 1
        each = count.prod(axis=1)
        if each.sum() <= MAX_MEMBERS or bins[0] == 1:
            break
        bins = bins // 2
    triangle = np.repeat(np.arange(len(triangles)), each)
    nth = np.arange(len(triangle)) - np.repeat(np.cumsum(each) - each, each)
    height = count[triangle, 1]
    column = _column(first[triangle] + np.stack([nth // height, nth % height], axis=1), bins)
    order = np.argsort(column, kind="stable")
    starts = np.searchsorted(column[order], np.arange(bins.prod() + 1))
    return ClosedSurface(vertices, triangles, shadows, bins, starts, triangle[order])


def open_edges(triangles: np.ndarray) -> int:
    """Edges that an odd number of triangles [m, 3] have: a ray may enter there and never leave."""
    edges = np.sort(np.concatenate([triangles[:, [0, 1]], triangles[:, [1, 2]], triangles[:, [2, 0]]]), axis=1)
    _, counts = np.unique(edges, axis=0, return_counts=True)
    return int(np.count_nonzero(counts % 2))


def _cells(x: np.ndarray, low: np.ndarray, high: np.ndarray, bins: np.ndarray) -> np.ndarray:
    """The bin of points of the x-y plane along both axes, [n, 2]."""
    fraction = (x - low[:2]) / (high - low)[:2]
    return np.clip((fraction * bins).astype(int), 0, bins - 1)


def _column(cell: np.ndarray, bins: np.ndarray) -> np.ndarray:
    return cell[:, 0] * bins[1] + cell[:, 1]
