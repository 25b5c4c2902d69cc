"""Slit specimens as outlines, and graded triangular meshes of them by gmsh. Lengths in mm in this file."""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.regions import Slit

ARC = math.radians(5.0)
"""Half-angle of the loaded arcs of a disc [rad]."""


@dataclass(frozen=True, kw_only=True)
class Plate:
    """Rectangle with its lower left corner at the origin, compressed along y between frictionless platens."""

    slit: Slit
    width: float = 50.0
    height: float = 100.0
    load_edges = ()

    @property
    def area(self) -> float:
        return self.width * self.height

    def outline(self, geo) -> list[int]:
        """Add the outer boundary to gmsh's model; returns its curves in order."""
        corners = ((0.0, 0.0), (self.width, 0.0), (self.width, self.height), (0.0, self.height))
        return _closed(geo, [geo.addPoint(x, y, 0.0) for x, y in corners])

    def depth(self, x: np.ndarray) -> np.ndarray:
        """Distance below the outer boundary; x [n, 2] -> [n]."""
        return np.min(np.concatenate([x, np.array([self.width, self.height]) - x], axis=1), axis=1)

    def on_outline(self, x: np.ndarray) -> np.ndarray:
        """Places on straight edges need no correction."""
        return x


@dataclass(frozen=True, kw_only=True)
class Disc:
    """Disc under uniform radial pressure on two arcs of half-angle ARC, at its top and bottom (Hondros)."""

    slit: Slit
    radius: float = 50.0
    centre = (50.0, 50.0)

    @property
    def area(self) -> float:
        return math.pi * self.radius**2

    @property
    def load_edges(self) -> tuple[tuple[float, float], ...]:
        """Where the pressure ends and the stress jumps."""
        quarter = 0.5 * math.pi
        return tuple(self.point(s * quarter + a) for s in (1.0, -1.0) for a in (-ARC, ARC))

    def point(self, angle: float) -> tuple[float, float]:
        return self.centre[0] + self.radius * math.cos(angle), self.centre[1] + self.radius * math.sin(angle)

    def outline(self, geo) -> list[int]:
        """Add the outer boundary to gmsh's model; returns its curves in order, each shorter than half a turn."""
        quarter = 0.5 * math.pi
        angles = (0.0, quarter - ARC, quarter, quarter + ARC, math.pi, -quarter - ARC, -quarter, -quarter + ARC)
        points = [geo.addPoint(*self.point(angle), 0.0) for angle in angles]
        centre = geo.addPoint(*self.centre, 0.0)
        return [geo.addCircleArc(a, centre, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]

    def depth(self, x: np.ndarray) -> np.ndarray:
        """Distance below the outer boundary; x [n, 2] -> [n]."""
        return self.radius - np.linalg.norm(x - np.array(self.centre), axis=1)

    def on_outline(self, x: np.ndarray) -> np.ndarray:
        """Midpoints of chords pushed out to the circle."""
        d = x - np.array(self.centre)
        return np.array(self.centre) + self.radius * d / np.linalg.norm(d, axis=1, keepdims=True)


@dataclass(frozen=True, kw_only=True)
class Spacing:
    """Edge length of triangles: each place asks for a length that grows by `growth` per unit of distance from it."""

    corner: float  # at the corners of square ends
    end: float  # on round ends
    face: float  # on the faces of the slit
    load_edge: float  # where the pressure on a disc ends
    far: float  # largest
    growth: float
    face_growth: float

    def scaled(self, factor: float) -> "Spacing":
        return Spacing(**{name: factor * value for name, value in vars(self).items()})


def slit_distance(slit: Slit, x: np.ndarray) -> np.ndarray:
    """Distance from the rectangle of the slit, 0 inside; x [n, 2] -> [n]."""
    outside = np.abs(slit.frame(x)) - 0.5 * np.array([slit.length, slit.width])
    return np.linalg.norm(np.maximum(outside, 0.0), axis=1)


def triangles(specimen: Plate | Disc, ends: str, spacing: Spacing) -> tuple[np.ndarray, np.ndarray]:
    """Points [n, 2] and triangles [t, 3] of a specimen whose slit has `square` or `round` ends, or is left out: `none`.

    Round ends are semicircles, and the slit has the same total length with them as without.
    """
    import gmsh

    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        for name in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
            gmsh.option.setNumber(f"Mesh.{name}", 0)  # the callback alone decides
        gmsh.option.setNumber("Mesh.Algorithm", 6)  # frontal Delaunay: the most regular triangles
        geo = gmsh.model.geo
        loops = [geo.addCurveLoop(specimen.outline(geo))]
        if ends != "none":
            loops.append(geo.addCurveLoop(_slit_outline(geo, specimen.slit, ends)))
        geo.addPlaneSurface(loops)
        geo.synchronize()
        gmsh.model.mesh.setSizeCallback(_size(specimen, ends, spacing))
        gmsh.model.mesh.generate(2)
        tags, x, _ = gmsh.model.mesh.getNodes()
        _, corners = gmsh.model.mesh.getElementsByType(2)
    finally:
        gmsh.finalize()
    used, corners = np.unique(corners, return_inverse=True)  # leaves out the centres of arcs
    row = np.searchsorted(tags, used, sorter=np.argsort(tags))
    return x.reshape(-1, 3)[np.argsort(tags)[row], :2], corners.reshape(-1, 3)


def _closed(geo, points: list[int]) -> list[int]:
    return [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]


def _slit_outline(geo, slit: Slit, ends: str) -> list[int]:
    t = slit.direction

    def place(along, across):
        x = np.array(slit.centre) + along * t + across * np.array([-t[1], t[0]])
        return geo.addPoint(*x, 0.0)

    a, b = 0.5 * slit.length, 0.5 * slit.width
    if ends == "square":
        return _closed(geo, [place(-a, -b), place(a, -b), place(a, b), place(-a, b)])
    c = a - b
    right, left = [(place(s * c, 0.0), place(s * a, 0.0)) for s in (1.0, -1.0)]
    lower_left, lower_right, upper_right, upper_left = place(-c, -b), place(c, -b), place(c, b), place(-c, b)
    arc = geo.addCircleArc  # (from, centre, to)
    return [
        geo.addLine(lower_left, lower_right),
        arc(lower_right, right[0], right[1]),
        arc(right[1], right[0], upper_right),
        geo.addLine(upper_right, upper_left),
        arc(upper_left, left[0], left[1]),
        arc(left[1], left[0], lower_left),
    ]


def _size(specimen: Plate | Disc, ends: str, spacing: Spacing):
    """gmsh's size callback; plain floats, since it is called once per candidate point."""
    slit = specimen.slit
    (cx, cy), (tx, ty) = slit.centre, slit.direction.tolist()
    a, b, s = 0.5 * slit.length, 0.5 * slit.width, spacing

    def size(_dim, _tag, x, y, _z, _lc):
        h = s.far
        for px, py in specimen_edges:
            h = min(h, s.load_edge + s.growth * math.hypot(x - px, y - py))
        if ends == "none":
            return h
        # the four corners and the two ends are equal in the first quadrant of the flaw's frame
        along = abs((x - cx) * tx + (y - cy) * ty)
        across = abs((y - cy) * tx - (x - cx) * ty)
        if ends == "square":
            h = min(h, s.corner + s.growth * math.hypot(along - a, across - b))
        else:
            h = min(h, s.end + s.growth * abs(math.hypot(along - (a - b), across) - b))
        return min(h, s.face + s.face_growth * math.hypot(max(along - a, 0.0), max(across - b, 0.0)))

    specimen_edges = specimen.load_edges
    return size
