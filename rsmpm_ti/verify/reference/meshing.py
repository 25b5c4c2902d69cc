"""Slit specimens with their loading, and graded triangular meshes of them by gmsh. Lengths in mm in this file."""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.spec.regions import Slit

ARC = math.radians(5.0)
"""Half-angle of the loaded arcs of a disc [rad]."""

ON_EDGE = 1e-6
"""Places closer than this are one place [mm]."""


@dataclass(frozen=True, kw_only=True)
class Plate:
    """Rectangle from the origin, shortened along y between frictionless platens, sides free.

    The nominal stress S is the platen force over the width.
    """

    slit: Slit
    width: float = 50.0
    height: float = 100.0
    pressure = 0.0
    load_edges = ()
    nominal = "S = platen force / width"

    @property
    def box(self) -> tuple[float, float]:
        """Upper right corner of the bounding box; its lower left one is the origin."""
        return self.width, self.height

    def outline(self, geo) -> list[int]:
        """Add the outer boundary to gmsh's model; returns its curves in order."""
        corners = ((0.0, 0.0), (self.width, 0.0), (self.width, self.height), (0.0, self.height))
        return _closed(geo, [geo.addPoint(x, y, 0.0) for x, y in corners])

    def depth(self, x: np.ndarray) -> np.ndarray:
        """Distance below the outer boundary; x [n, 2] -> [n]."""
        return np.min(np.concatenate([x, np.array(self.box) - x], axis=1), axis=1)

    def on_outline(self, x: np.ndarray) -> np.ndarray:
        """Midpoints of boundary edges moved onto the boundary: these are straight."""
        return x

    def pressed(self, x: np.ndarray) -> np.ndarray:
        """Which boundary places bear the pressure; x [n, 2] -> bool [n]."""
        return np.zeros(len(x), dtype=bool)

    def prescribed(self, x: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Which displacement components are given, bool [n], and their values [mm, n]; axis [n] is 0 or 1."""
        top, bottom = self.top(x), self.bottom(x)
        pin = bottom & (x[:, 0] < ON_EDGE)  # without it the plate could slide
        return np.where(axis == 1, top | bottom, pin), np.where((axis == 1) & top, -1.0, 0.0)

    def top(self, x: np.ndarray) -> np.ndarray:
        """Places under the upper platen; x [n, 2] -> bool [n]."""
        return x[:, 1] > self.height - ON_EDGE

    def bottom(self, x: np.ndarray) -> np.ndarray:
        return x[:, 1] < ON_EDGE

    def nominal_stress(self, platen_force: float) -> float:
        """S [MPa] from the force of the top platen [N/mm]."""
        return platen_force / self.width


@dataclass(frozen=True, kw_only=True)
class Disc:
    """Disc under uniform radial pressure p on two arcs of half-angle alpha = ARC, at its top and bottom.

    Hondros (1959): P = 2 alpha R B p, and the nominal stress is s0 = P / (pi R B), so p = pi s0 / (2 alpha). P is not
    quite the force along y, which is P sin(alpha) / alpha.
    """

    slit: Slit
    radius: float = 50.0
    centre = (50.0, 50.0)
    pressure = math.pi / (2.0 * ARC)  # [MPa], for s0 = 1 MPa
    nominal = "s0 = P / (pi R B) with P = 2 alpha R B p (Hondros), alpha = 5 deg"

    @property
    def box(self) -> tuple[float, float]:
        """Upper right corner of the bounding box; its lower left one is the origin."""
        return 2.0 * self.centre[0], 2.0 * self.centre[1]

    @property
    def load_edges(self) -> tuple[tuple[float, float], ...]:
        """Where the pressure ends and the stress jumps."""
        return tuple(self.point(s * 0.5 * math.pi + a) for s in (1.0, -1.0) for a in (-ARC, ARC))

    def point(self, angle: float) -> tuple[float, float]:
        return self.centre[0] + self.radius * math.cos(angle), self.centre[1] + self.radius * math.sin(angle)

    def outline(self, geo) -> list[int]:
        """Add the outer boundary to gmsh's model; returns its curves in order, each shorter than half a turn."""
        q = 0.5 * math.pi
        angles = (0.0, q - ARC, q, q + ARC, math.pi, -q - ARC, -q, -q + ARC)
        points = [geo.addPoint(*self.point(angle), 0.0) for angle in angles]
        centre = geo.addPoint(*self.centre, 0.0)
        return [geo.addCircleArc(a, centre, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]

    def depth(self, x: np.ndarray) -> np.ndarray:
        """Distance below the outer boundary; x [n, 2] -> [n]."""
        return self.radius - np.linalg.norm(x - np.array(self.centre), axis=1)

    def on_outline(self, x: np.ndarray) -> np.ndarray:
        """Midpoints of boundary edges moved from the chord to the circle."""
        d = x - np.array(self.centre)
        return np.array(self.centre) + self.radius * d / np.linalg.norm(d, axis=1, keepdims=True)

    def pressed(self, x: np.ndarray) -> np.ndarray:
        """Which boundary places bear the pressure; x [n, 2] -> bool [n]."""
        return np.abs(x[:, 0] - self.centre[0]) < self.radius * math.sin(ARC)

    def prescribed(self, x: np.ndarray, axis: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Three components at the ends of the horizontal diameter, only against rigid motion: the load balances."""
        right, left = (np.linalg.norm(x - np.array(self.point(angle)), axis=1) < ON_EDGE for angle in (0.0, math.pi))
        return np.where(axis == 1, right | left, left), np.zeros(len(x))

    def top(self, x: np.ndarray) -> np.ndarray:
        """The upper pole; x [n, 2] -> bool [n]."""
        return x[:, 1] > self.centre[1] + self.radius - ON_EDGE

    def bottom(self, x: np.ndarray) -> np.ndarray:
        return x[:, 1] < self.centre[1] - self.radius + ON_EDGE

    def nominal_stress(self, platen_force: float) -> float:
        """The pressure is that of s0 = 1 MPa."""
        return 1.0


@dataclass(frozen=True, kw_only=True)
class Spacing:
    """Edge lengths of triangles [mm] at these places, each growing with the distance from there up to `far`."""

    corner: float  # corners of square ends
    end: float  # round ends
    face: float  # faces of the slit
    load_edge: float  # where the pressure on a disc ends
    far: float
    growth: float  # from the slit [1]
    load_growth: float  # from a load edge [1]

    def scaled(self, factor: float) -> "Spacing":
        return Spacing(**{name: factor * value for name, value in vars(self).items()})


def slit_distance(slit: Slit, x: np.ndarray) -> np.ndarray:
    """Distance from the rectangle of the slit, 0 inside; x [n, 2] -> [n]."""
    outside = np.abs(slit.frame(x)) - 0.5 * np.array([slit.length, slit.width])
    return np.linalg.norm(np.maximum(outside, 0.0), axis=1)


def from_frame(slit: Slit, s: np.ndarray) -> np.ndarray:
    """Places from their coordinates along and across the slit, the inverse of `Slit.frame`; [n, 2] -> [n, 2]."""
    t = slit.direction
    return np.array(slit.centre) + s @ np.array([t, [-t[1], t[0]]])


def on_boundary(specimen: Plate | Disc, ends: str, x: np.ndarray) -> np.ndarray:
    """Midpoints of straight boundary edges moved onto the circles that the edges stand for; x [n, 2] -> [n, 2]."""
    slit = specimen.slit
    outer = specimen.depth(x) < 1.0  # every slit lies deeper
    s = slit.frame(x)
    c = np.clip(s[:, :1], -0.5 * (slit.length - slit.width), 0.5 * (slit.length - slit.width)) * [1.0, 0.0]
    round_end = (c[:, 0] != s[:, 0]) & ~outer & (ends == "round")
    d = s - c
    s = c + 0.5 * slit.width * d / np.linalg.norm(d, axis=1, keepdims=True)
    x = np.where(outer[:, None], specimen.on_outline(x), x)
    return np.where(round_end[:, None], from_frame(slit, s), x)


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
    order = np.argsort(tags)
    x = x.reshape(-1, 3)[order[np.searchsorted(tags[order], used)], :2]
    return x, corners.reshape(-1, 3)


def _closed(geo, points: list[int]) -> list[int]:
    return [geo.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]


def _slit_outline(geo, slit: Slit, ends: str) -> list[int]:
    def position(along, across):
        return geo.addPoint(*from_frame(slit, np.array([along, across])), 0.0)

    a, b = 0.5 * slit.length, 0.5 * slit.width
    if ends == "square":
        return _closed(geo, [position(-a, -b), position(a, -b), position(a, b), position(-a, b)])
    c = a - b
    lower_left, lower_right, upper_right, upper_left = (
        position(-c, -b),
        position(c, -b),
        position(c, b),
        position(-c, b),
    )
    right, right_end, left, left_end = position(c, 0.0), position(a, 0.0), position(-c, 0.0), position(-a, 0.0)
    return [
        geo.addLine(lower_left, lower_right),
        geo.addCircleArc(lower_right, right, right_end),
        geo.addCircleArc(right_end, right, upper_right),
        geo.addLine(upper_right, upper_left),
        geo.addCircleArc(upper_left, left, left_end),
        geo.addCircleArc(left_end, left, lower_left),
    ]


def _size(specimen: Plate | Disc, ends: str, spacing: Spacing):
    """gmsh's size callback; plain floats, since it is called for every candidate point."""
    slit, s, load_edges = specimen.slit, spacing, specimen.load_edges
    (cx, cy), (tx, ty) = slit.centre, slit.direction.tolist()
    a, b = 0.5 * slit.length, 0.5 * slit.width

    def size(_dim, _tag, x, y, _z, _lc):
        h = min((s.load_edge + s.load_growth * math.hypot(x - px, y - py) for px, py in load_edges), default=s.far)
        if ends == "none":
            return min(h, s.far)
        # folded into the first quadrant of the flaw's frame, where one corner and one end stand for all
        along = abs((x - cx) * tx + (y - cy) * ty)
        across = abs((y - cy) * tx - (x - cx) * ty)
        if ends == "square":
            tip = s.corner + s.growth * math.hypot(along - a, across - b)
        else:
            tip = s.end + s.growth * abs(math.hypot(along - (a - b), across) - b)
        face = s.face + s.growth * math.hypot(max(along - a, 0.0), max(across - b, 0.0))
        return min(h, tip, face, s.far)

    return size
