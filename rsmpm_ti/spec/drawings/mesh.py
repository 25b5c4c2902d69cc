"""A region that a mesh fills, or that a surface of triangles closes in."""

import itertools
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval, Len

from rsmpm_ti.checks import MAX_COORDINATE, Position, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.drawings.closed_surface import ClosedSurface, closed_surface, open_edges
from rsmpm_ti.spec.drawings.drawn_file import FileName, read
from rsmpm_ti.spec.drawings.mesh_file import MAX_BYTES, Cells, read_cells
from rsmpm_ti.spec.drawings.plane_area import PlaneArea, shapely

FLAT = 1e-9
"""Largest height of a flat mesh, over its size."""


@checked("mesh")
@dataclass(frozen=True, kw_only=True)
class Mesh:
    """The body of a mesh that meshio reads: .msh of gmsh, .stl, .vtu or .obj.

    Triangles and quads in the x-y plane are a region in 2D, what any of them covers. Tetrahedra are one in 3D, and so
    are triangles in space that close a surface in. Of curved cells the corners count. scale: metres per unit of the
    file (1e-3 for millimetres). origin: where the file's (0, 0, 0) goes [m]. group: a physical group of gmsh, by its
    name; without one all cells count. sha256: of the file, filled in when it is read (see `drawn_file.py`). Raises
    SceneError where the file is no such mesh, and for a surface with open edges.
    """

    file: FileName
    scale: Annotated[float, Interval(ge=1e-9, le=1e9)] = 1.0
    origin: Position | None = None
    group: Annotated[str, Len(1, 200)] | None = None
    sha256: str | None = None

    def __post_init__(self):
        file = read("mesh.file", self.file, self.sha256, MAX_BYTES)
        cells = read_cells(self.file, file.data, self.group)
        vertices = cells.vertices * self.scale
        size = float(np.ptp(vertices, axis=0).max())
        flat = "tetra" not in cells.by_kind and np.ptp(vertices[:, 2]) <= FLAT * size
        if self.origin is not None:
            if len(self.origin) != (2 if flat else 3):
                raise refuse("mesh.origin", self.origin, f"{2 if flat else 3} coordinates, as the mesh has")
            vertices = vertices + np.array((*self.origin, 0.0)[:3])
        if not (np.abs(vertices).max() <= MAX_COORDINATE and size > 0.0):
            raise refuse("mesh.scale", self.scale, f"such that {size:g} m, the size of the mesh, is one of a body")
        moved = Cells(vertices, cells.by_kind)
        drawn = _plane_area(self.file, moved) if flat else _volume(self.file, moved)
        self.__dict__.update({"sha256": file.sha256, "drawn": drawn})

    @property
    def _inside(self) -> PlaneArea | ClosedSurface:
        return self.__dict__["drawn"]

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, dim] -> bool [n]."""
        return self._inside.contains(x)

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        return self._inside.bounds()

    @property
    def area(self) -> float | None:
        """[m^2] in 2D; None in 3D, where it is counted."""
        return self._inside.area if isinstance(self._inside, PlaneArea) else None

    @property
    def hull(self) -> np.ndarray:
        """Points whose convex hull is that of the region [m], [n, dim]."""
        return self._inside.hull


def _plane_area(name: str, cells: Cells) -> PlaneArea:
    rings = [cells.vertices[corners][:, :, :2] for corners in cells.by_kind.values()]
    drawn = np.concatenate([shapely().polygons(ring) for ring in rings])
    drawn = drawn[shapely().area(drawn) > 0.0]
    if not len(drawn) or not shapely().is_valid(drawn).all():
        raise refuse("mesh.file", name, "a mesh of cells that have an area and cross themselves nowhere")
    return PlaneArea(shapely().union_all(drawn))


def _volume(name: str, cells: Cells) -> ClosedSurface:
    """Within the faces that only one of the tetrahedra has, or within the surface."""
    if "tetra" in cells.by_kind:
        tetra = cells.by_kind["tetra"]
        faces = np.sort(
            np.concatenate([tetra[:, list(three)] for three in itertools.combinations(range(4), 3)]), axis=1
        )
        faces, counts = np.unique(faces, axis=0, return_counts=True)
        triangles = faces[counts % 2 == 1]
    else:
        quads = cells.by_kind.get("quad", np.zeros((0, 4), dtype=int))
        halves = [cells.by_kind.get("triangle", np.zeros((0, 3), dtype=int)), quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]
        triangles = np.concatenate(halves)
    distinct = (np.diff(np.sort(triangles, axis=1), axis=1) > 0).all(axis=1)
    triangles = triangles[distinct]
    if gaps := open_edges(triangles):
        remedy = f"{gaps} of its edges are open; close it, or lay it flat in the x-y plane for a scene in 2D"
        raise refuse("mesh.file", name, "a flat mesh or a closed surface", remedy)
    used, numbers = np.unique(triangles, return_inverse=True)
    if not len(used) or not (np.ptp(cells.vertices[used], axis=0) > 0.0).all():
        raise refuse("mesh.file", name, "a mesh in the x-y plane, or one with a volume")
    return closed_surface(cells.vertices[used], numbers.reshape(-1, 3))
