"""Regions of space that bodies fill: `contains(x)` in NumPy. Lengths in metres, angles in degrees.

Combine with `Union` and `Difference`, turn with `Turned`. A slit is a region like any other; what makes it a flaw is
that the particles in it are removed and that its faces really separate, which `slit_check.slit_tie` measures. Outlines,
images and meshes are in `drawings`; an object of another class will do if it answers as `drawings.answers` says.
"""

import itertools
import math
import os
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Annotated

import numpy as np
from annotated_types import Interval
from pydantic import AfterValidator

from rsmpm_ti.checks import MIN_POSITIVE, ByType, Coordinate, Position, Size, checked
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.drawings.answers import inside, sound
from rsmpm_ti.spec.drawings.mask import Mask
from rsmpm_ti.spec.drawings.mesh import Mesh
from rsmpm_ti.spec.drawings.polygon import Polygon
from rsmpm_ti.spec.drawings.traces import Traces, read_traces
from rsmpm_ti.units import Angle

MAX_DEPTH, MAX_PARTS = 20, 10_000
"""Regions within regions, and all of them: every point of a specimen is asked of each."""

Turning = Annotated[Angle, Interval(ge=-360.0, le=360.0)]


def _dimensions(parts: tuple) -> set[int]:
    """The dimensions of regions; a flaw, which goes through the thickness in 3D, has none of its own."""
    return {len(part.bounds()[0]) for part in parts if not _is_flaw(part)}


def _is_flaw(part) -> bool:
    return _is_flaw(part.region) if isinstance(part, Turned) else isinstance(part, Slit | Segments)


def _parts(region) -> tuple:
    """The regions that a region is made of."""
    if isinstance(region, Union):
        return region.parts
    if isinstance(region, Turned):
        return (region.region,)
    return (region.whole, *region.removed) if isinstance(region, Difference) else ()


def _check_nest(name: str, parts: tuple) -> None:
    level, count = parts, len(parts)
    for _ in range(MAX_DEPTH):
        level = tuple(inner for part in level for inner in _parts(part))
        count += len(level)
    if level or count > MAX_PARTS:
        raise refuse(name, parts, f"at most {MAX_PARTS} regions, nested at most {MAX_DEPTH} deep")


@checked("box")
@dataclass(frozen=True, kw_only=True)
class Box:
    """Axis-aligned box between two corners."""

    lower: Position
    upper: Position

    def __post_init__(self):
        edges = [b - a for a, b in zip(self.lower, self.upper, strict=False)]
        if len(self.lower) != len(self.upper) or not min(edges) >= MIN_POSITIVE:
            raise refuse("box.upper", self.upper, f"above box.lower = {self.lower} by {MIN_POSITIVE:g} m on every axis")

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, dim] -> bool [n]."""
        return np.all((x > np.array(self.lower)) & (x < np.array(self.upper)), axis=1)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self.lower), np.array(self.upper)


@checked("disc")
@dataclass(frozen=True, kw_only=True)
class Disc:
    """Disc in 2D, ball in 3D."""

    centre: Position
    radius: Size

    def contains(self, x: np.ndarray) -> np.ndarray:
        return np.sum((x - np.array(self.centre)) ** 2, axis=1) < self.radius**2

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return np.array(self.centre) - self.radius, np.array(self.centre) + self.radius


@checked("slit")
@dataclass(frozen=True, kw_only=True)
class Slit:
    """A straight flaw: a rectangle `length` x `width` at `angle` degrees from +x, through the thickness in 3D.

    `rounded`: its ends are half circles, as a saw or a drill leaves them; `length` is from end to end either way.
    """

    centre: Position
    length: Size
    width: Size
    angle: Turning
    rounded: bool = False

    def __post_init__(self):
        if self.width > self.length:
            raise refuse("slit.width", self.width, f"at most slit.length = {self.length} m")

    @property
    def direction(self) -> np.ndarray:
        """Unit vector along the flaw in the x-y plane, [2]."""
        return np.array([math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))])

    def frame(self, x: np.ndarray) -> np.ndarray:
        """Coordinates along and across the flaw [m]; x [n, dim] -> [n, 2]."""
        t = self.direction
        d = x[:, :2] - np.array(self.centre[:2])
        return np.stack([d @ t, d @ np.array([-t[1], t[0]])], axis=1)

    def contains(self, x: np.ndarray) -> np.ndarray:
        s = np.abs(self.frame(x))
        if self.rounded:
            beyond = np.maximum(s[:, 0] - 0.5 * (self.length - self.width), 0.0)
            return np.hypot(beyond, s[:, 1]) < 0.5 * self.width
        return (s[:, 0] < 0.5 * self.length) & (s[:, 1] < 0.5 * self.width)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        t = np.abs(self.direction)
        half = 0.5 * (self.length * t + self.width * t[::-1])
        return np.array(self.centre[:2]) - half, np.array(self.centre[:2]) + half


@checked("segments")
@dataclass(frozen=True, kw_only=True)
class Segments:
    """A set of straight flaws, each a `Slit` from end to end: the trace map of a fracture network.

    traces: rows of x1, y1, x2, y2 and perhaps a width of its own [m]; a list or an array [n, 4] will do. width: of the
    others [m]. Flaws are numbered as the rows are. Raises SceneError for a row without a width, or wider than long.
    """

    traces: Traces
    width: Size | None = None
    rounded: bool = False

    @staticmethod
    def from_csv(
        file: str | os.PathLike, *, width: float | None = None, scale: float = 1.0, rounded: bool = False
    ) -> "Segments":
        """Of a table, a row for each flaw; scale: metres per unit of the table, for the widths in it too."""
        return Segments(traces=read_traces(file, scale), width=width, rounded=rounded)

    def __post_init__(self):
        for k in range(len(self.traces)):
            try:
                self._slit(k)
            except SceneError as error:
                raise SceneError(f"segments.traces[{k}]: {error}") from None

    def _slit(self, k: int) -> Slit:
        x1, y1, x2, y2, *own = self.traces[k]
        width = own[0] if own else self.width
        if width is None:
            raise refuse("segments.width", None, "given where a row has no width of its own")
        centre, angle = (0.5 * (x1 + x2), 0.5 * (y1 + y2)), math.degrees(math.atan2(y2 - y1, x2 - x1))
        length = math.hypot(x2 - x1, y2 - y1)
        return Slit(centre=centre, length=length, width=width, angle=angle, rounded=self.rounded)

    @cached_property
    def slits(self) -> tuple[Slit, ...]:
        return tuple(map(self._slit, range(len(self.traces))))

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, dim] -> bool [n]. A flaw is asked only of points between its ends along x."""
        order = np.argsort(x[:, 0])
        low, high = (np.array(bounds) for bounds in zip(*(slit.bounds() for slit in self.slits), strict=True))
        first = np.searchsorted(x[order, 0], low[:, 0], side="left")
        last = np.searchsorted(x[order, 0], high[:, 0], side="right")
        found = np.zeros(len(x), dtype=bool)
        for slit, a, b in zip(self.slits, first, last, strict=True):
            near = order[a:b]
            found[near] |= slit.contains(x[near])
        return found

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = zip(*(slit.bounds() for slit in self.slits), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)


@checked("union")
@dataclass(frozen=True, kw_only=True)
class Union:
    """What lies in any of the parts."""

    parts: "tuple[Region, ...]"

    def __post_init__(self):
        _check_nest("union.parts", self.parts)
        if not self.parts or len({len(part.bounds()[0]) for part in self.parts}) > 1:
            raise refuse("union.parts", self.parts, "at least one region, and all of one dimension")

    def contains(self, x: np.ndarray) -> np.ndarray:
        return np.any([inside(part, x) for part in self.parts], axis=0)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        lower, upper = zip(*(part.bounds() for part in self.parts), strict=True)
        return np.min(lower, axis=0), np.max(upper, axis=0)


@checked("difference")
@dataclass(frozen=True, kw_only=True)
class Difference:
    """What lies in `whole` and in none of `removed`."""

    whole: "Region"
    removed: "tuple[Region, ...]"

    def __post_init__(self):
        _check_nest("difference.whole", (self.whole,))
        _check_nest("difference.removed", self.removed)
        if len(_dimensions((self.whole, *self.removed))) > 1:
            raise refuse("difference.removed", self.removed, "regions of the dimension of difference.whole")

    def contains(self, x: np.ndarray) -> np.ndarray:
        left = inside(self.whole, x).copy()
        for part in self.removed:
            left &= ~inside(part, x)
        return left

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self.whole.bounds()


@checked("turned")
@dataclass(frozen=True, kw_only=True)
class Turned:
    """A region turned by `angle` degrees, counterclockwise in the x-y plane, about `centre` [m]; in 3D, about the
    parallel to z through it. Without a centre it turns about the middle of its bounds."""

    region: "Region"
    angle: Turning
    centre: tuple[Coordinate, Coordinate] | None = None

    def __post_init__(self):
        _check_nest("turned.region", (self.region,))

    @cached_property
    def about(self) -> tuple[float, float]:
        """What it turns about [m]."""
        x, y, *_ = 0.5 * np.sum(self.region.bounds(), axis=0)
        return (float(x), float(y)) if self.centre is None else self.centre

    def turn(self, x: np.ndarray, sign: float = 1.0) -> np.ndarray:
        """Points [n, dim] turned with the region; sign -1: turned back."""
        c, s = math.cos(math.radians(self.angle)), sign * math.sin(math.radians(self.angle))
        turned, about = np.array(x, dtype=float), np.array(self.about)
        turned[:, :2] = (turned[:, :2] - about) @ np.array([[c, s], [-s, c]]) + about
        return turned

    def contains(self, x: np.ndarray) -> np.ndarray:
        return inside(self.region, self.turn(x, -1.0))

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        ends = [(self.turn(points), radius) for points, radius in _hulls(self.region)]
        low = np.min([points.min(axis=0) - radius for points, radius in ends], axis=0)
        return low, np.max([points.max(axis=0) + radius for points, radius in ends], axis=0)

    def carry(self, part):
        """Another region turned in the same way; a flaw stays one."""
        if not isinstance(part, Slit):
            return Turned(region=part, angle=self.angle, centre=self.about)
        centre = self.turn(np.array([part.centre]))[0].tolist()
        return replace(part, centre=tuple(centre), angle=math.remainder(part.angle + self.angle, 360.0))


def _hulls(region) -> list[tuple[np.ndarray, float]]:
    """(points [n, dim], radius) of each part: it lies within that radius of the convex hull of its points, and needs
    no less but where it is a rounded slit, or of a scene's own, of which the box is taken."""
    if isinstance(region, Union | Segments):
        parts = region.parts if isinstance(region, Union) else region.slits
        return [hull for part in parts for hull in _hulls(part)]
    if isinstance(region, Difference):
        return _hulls(region.whole)
    if isinstance(region, Turned):
        return [(region.turn(points), radius) for points, radius in _hulls(region.region)]
    if isinstance(region, Disc):
        return [(np.array([region.centre]), region.radius)]
    if isinstance(region, Polygon | Mask | Mesh):
        return [(region.hull, 0.0)]
    if isinstance(region, Slit):
        (t_x, t_y), half = region.direction, np.array([0.5 * region.length, 0.5 * region.width])
        corners = half * np.array(list(itertools.product((-1.0, 1.0), repeat=2)))
        return [(region.centre[:2] + corners @ np.array([[t_x, t_y], [-t_y, t_x]]), 0.0)]
    return [(np.array(list(itertools.product(*zip(*region.bounds(), strict=True)))), 0.0)]


Region = Annotated[
    Box | Disc | Slit | Segments | Polygon | Mask | Mesh | Union | Difference | Turned, ByType, AfterValidator(sound)
]
"""What a recorded scene or the command line may give as a region; a scene file may bring its own (`answers.py`)."""


def parts_of(region) -> int:
    """How many regions a region is made of, itself included."""
    return 1 + sum(map(parts_of, _parts(region)))


def removals_of(region) -> tuple:
    """(what it is cut from, what is cut) for every region that another one lacks, however nested."""
    if isinstance(region, Union):
        return tuple(cut for part in region.parts for cut in removals_of(part))
    if isinstance(region, Turned):
        return tuple((region.carry(whole), region.carry(part)) for whole, part in removals_of(region.region))
    if isinstance(region, Difference):
        return removals_of(region.whole) + tuple((filled(region.whole), part) for part in region.removed)
    return ()


def cuts_of(region) -> tuple:
    """The same with a set of flaws taken apart, flaw by flaw."""
    return tuple((whole, cut) for whole, part in removals_of(region) for cut in taken_apart(part))


def taken_apart(part) -> tuple:
    """The slits of a set of flaws, turned ones too; anything else as it is."""
    if isinstance(part, Turned):
        return tuple(map(part.carry, taken_apart(part.region)))
    return part.slits if isinstance(part, Segments) else (part,)


def filled(region):
    """A region with all that is cut from it put back."""
    if isinstance(region, Union):
        return Union(parts=tuple(map(filled, region.parts)))
    if isinstance(region, Turned):
        return region.carry(filled(region.region))
    return filled(region.whole) if isinstance(region, Difference) else region


def slits_of(region) -> tuple[Slit, ...]:
    """Every slit cut from a region, however nested."""
    return tuple(part for _, part in cuts_of(region) if isinstance(part, Slit))
