"""A piece of the plane, with holes or in pieces, that Shapely holds: what an outline or a flat mesh comes to."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.errors import SceneError


def shapely():
    """The library, loaded on first use as it takes a tenth of a second. Raises SceneError where it is missing."""
    try:
        import shapely
    except ImportError as error:
        raise SceneError(f"an outline or a flat mesh needs shapely, `pip install shapely`: {error}") from None
    return shapely


@dataclass(frozen=True)
class PlaneArea:
    """geometry: a valid polygon or multipolygon of Shapely, lengths in metres."""

    geometry: object

    def contains(self, x: np.ndarray) -> np.ndarray:
        """Which points lie inside, edges left out; x [n, 2] -> bool [n]."""
        shapely().prepare(self.geometry)
        return shapely().contains_xy(self.geometry, x[:, 0], x[:, 1])

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        low_x, low_y, high_x, high_y = self.geometry.bounds  # type: ignore[attr-defined]
        return np.array([low_x, low_y]), np.array([high_x, high_y])

    @property
    def area(self) -> float:
        """[m^2]."""
        return float(self.geometry.area)  # type: ignore[attr-defined]

    @property
    def hull(self) -> np.ndarray:
        """Corners of the convex hull [m], [n, 2]."""
        return shapely().get_coordinates(shapely().convex_hull(self.geometry))
