"""A region within an outline of straight edges."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Len
from pydantic import BeforeValidator

from rsmpm_ti.checks import MIN_POSITIVE, Coordinate, checked, native
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.drawings.plane_area import PlaneArea, shapely

MAX_CORNERS, MAX_HOLES = 10_000, 1000


def rows(value):
    """Points as Python or NumPy hold them, as a tuple of tuples; anything else as it is."""
    if isinstance(value, np.ndarray):
        value = value.tolist()
    if not isinstance(value, list | tuple):
        return value
    return tuple(map(_row, value))


def _row(row):
    if isinstance(row, np.ndarray):
        row = row.tolist()
    return native(tuple(row)) if isinstance(row, list | tuple) else row


def _as_tuple(value):
    return tuple(value) if isinstance(value, list) else value


Ring = Annotated[tuple[tuple[Coordinate, Coordinate], ...], Len(3, MAX_CORNERS), BeforeValidator(rows)]


@checked("polygon")
@dataclass(frozen=True, kw_only=True)
class Polygon:
    """What lies within an outline, 2D, and in none of its holes. A ring closes by itself, and either way round will do.

    points: corners of the outline [m], rows of x and y; a list or an array [n, 2] will do. holes: further rings. Raises
    SceneError for edges that cross and for holes that reach out of the outline or into each other.
    """

    points: Ring
    holes: Annotated[tuple[Ring, ...], Len(0, MAX_HOLES), BeforeValidator(_as_tuple)] = ()

    def __post_init__(self):
        allowed = "corners of an outline that has an area and never crosses itself"
        drawn = _drawn("polygon.points", self.points, (), allowed)
        if self.holes:
            drawn = _drawn("polygon.holes", self.points, self.holes, "rings within the outline that cross nothing")
        self.__dict__["drawn"] = drawn

    @property
    def _inside(self) -> PlaneArea:
        return self.__dict__["drawn"]

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, 2] -> bool [n]."""
        return self._inside.contains(x)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self._inside.bounds()

    @property
    def area(self) -> float:
        """[m^2]."""
        return self._inside.area

    @property
    def hull(self) -> np.ndarray:
        """Corners of the convex hull [m], [n, 2]."""
        return self._inside.hull


def _drawn(field: str, points: tuple, holes: tuple, allowed: str) -> PlaneArea:
    area = shapely().Polygon(points, holes)
    if not area.is_valid or not area.area >= MIN_POSITIVE**2:
        why = shapely().is_valid_reason(area).replace("[", " at (").replace("]", ") m")
        raise refuse(field, holes or points, allowed, "" if area.is_valid else why)
    return PlaneArea(area)
