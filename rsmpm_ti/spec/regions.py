"""Regions of space that bodies fill: `contains(x)` in NumPy. Lengths in metres, angles in degrees.

Combine with `Union` and `Difference`. A slit is a region like any other; what makes it a flaw is that the particles
in it are removed and that its faces really separate, which `slit_check.slit_tie` measures.
"""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len

from rsmpm_ti.checks import MIN_POSITIVE, ByType, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import Angle, Length

MAX_COORDINATE = 1e9
"""Largest coordinate and length [m]: beyond it a specimen is a mistake, and squares and node numbers overflow."""

MAX_DEPTH, MAX_PARTS = 20, 10_000
"""Regions within regions, and all of them: every point of a specimen is asked of each."""


Coordinate = Annotated[Length, Interval(ge=-MAX_COORDINATE, le=MAX_COORDINATE)]
Position = Annotated[tuple[Coordinate, ...], Len(2, 3)]
Size = Annotated[Length, Interval(ge=MIN_POSITIVE, le=MAX_COORDINATE)]


def _dimensions(parts: tuple) -> set[int]:
    """The dimensions of regions; a slit, which goes through the thickness in 3D, has none of its own."""
    return {len(part.bounds()[0]) for part in parts if not isinstance(part, Slit)}


def _parts(region) -> tuple:
    """The regions that a region is made of."""
    if isinstance(region, Union):
        return region.parts
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
    angle: Annotated[Angle, Interval(ge=-360.0, le=360.0)]
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
        return np.any([part.contains(x) for part in self.parts], axis=0)

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
        inside = self.whole.contains(x)
        for part in self.removed:
            inside &= ~part.contains(x)
        return inside

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self.whole.bounds()


Region = Annotated[Box | Disc | Slit | Union | Difference, ByType]
"""What a recorded scene or the command line may give as a region; a scene file may bring its own."""


def parts_of(region) -> int:
    """How many regions a region is made of, itself included."""
    return 1 + sum(map(parts_of, _parts(region)))


def cuts_of(region) -> tuple:
    """(what it is cut from, what is cut) for every region that another one lacks, however nested."""
    if isinstance(region, Union):
        return tuple(cut for part in region.parts for cut in cuts_of(part))
    if isinstance(region, Difference):
        return cuts_of(region.whole) + tuple((filled(region.whole), part) for part in region.removed)
    return ()


def filled(region):
    """A region with all that is cut from it put back."""
    if isinstance(region, Union):
        return Union(parts=tuple(map(filled, region.parts)))
    return filled(region.whole) if isinstance(region, Difference) else region


def slits_of(region) -> tuple[Slit, ...]:
    """Every slit cut from a region, however nested."""
    return tuple(part for _, part in cuts_of(region) if isinstance(part, Slit))
