"""Finite-element truth for slit specimens, read from the committed files: NumPy, meshio and matplotlib's finder only.

Made by `python -m rsmpm_ti.verify.reference.finite_elements`; plane strain, E = 17 GPa, nu = 0.14, tension positive.
"""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import refuse

REFERENCE = Path(__file__).parent
METADATA = "finite_elements.json"
STRESSES = ("sigma_xx", "sigma_yy", "sigma_zz", "sigma_xy")


@dataclass(frozen=True, eq=False)
class FiniteElementField:
    """A field at the points of a graded triangular mesh, linear between them, NaN outside the specimen.

    points [n, 2] in metres; triangles [t, 3]; stress [n, 4]: STRESSES over the nominal stress of the specimen;
    u [n, 2]: displacement in metres when that nominal stress is 1 MPa; metadata: how it was made and how good it is.
    """

    points: np.ndarray
    triangles: np.ndarray
    stress: np.ndarray
    u: np.ndarray
    metadata: dict
    find: object  # matplotlib's triangle finder: (x, y) -> triangle, -1 outside

    def sigma(self, x: np.ndarray) -> np.ndarray:
        """Cauchy stress over the nominal stress at positions x [m, 2] in metres; [m, 3, 3], tension positive."""
        xx, yy, zz, xy = self._interpolated(self.stress, x).T
        o = np.where(np.isnan(xx), np.nan, 0.0)
        return np.stack([xx, xy, o, xy, yy, o, o, o, zz], axis=1).reshape(-1, 3, 3)

    def displacement(self, x: np.ndarray) -> np.ndarray:
        """Displacement [m] for a nominal stress of 1 MPa at positions x [m, 2] in metres; [m, 2]."""
        return self._interpolated(self.u, x)

    def _interpolated(self, values: np.ndarray, x: np.ndarray) -> np.ndarray:
        x = np.asarray(x, dtype=float)
        t = self.find(x[:, 0], x[:, 1])
        corner = self.triangles[t]
        a, b, c = (self.points[corner[:, k]] for k in range(3))
        w = np.stack([_area(x, b, c), _area(a, x, c), _area(a, b, x)]) / _area(a, b, c)
        found = np.einsum("kn,nkd->nd", w, values[corner])
        return np.where(t[:, None] < 0, np.nan, found)


def _area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles, each corner [n, 2] -> [n]."""
    return (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])


def names() -> list[str]:
    """The specimens there are committed fields of."""
    return sorted(path.stem for path in REFERENCE.glob("*.vtu"))


def load_field(name: str) -> FiniteElementField:
    """The committed field of one specimen, by its name."""
    if name not in names():
        raise refuse("finite-element field", name, f"one of {', '.join(names())}")
    return read_field(REFERENCE / f"{name}.vtu", json.loads((REFERENCE / METADATA).read_text(encoding="utf-8"))[name])


def read_field(path: Path, metadata: dict) -> FiniteElementField:
    import meshio
    from matplotlib.tri import Triangulation

    mesh = meshio.read(path)
    points = mesh.points[:, :2].astype(float)
    triangles = mesh.cells_dict["triangle"].astype(int)
    return FiniteElementField(
        points=points,
        triangles=triangles,
        stress=np.stack([mesh.point_data[key] for key in STRESSES], axis=1).astype(float),
        u=mesh.point_data["displacement"][:, :2].astype(float),
        metadata=metadata,
        find=Triangulation(*points.T, triangles).get_trifinder(),
    )
