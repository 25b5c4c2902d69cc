"""python -m rsmpm_ti.verify.reference.finite_elements [NAME ...]: finite-element fields of slit specimens.

P2 triangles on graded meshes, curved (isoparametric) at round boundaries; plane strain, small strain, E = 17 GPa,
nu = 0.14. Every field is for a nominal stress of 1 MPa, tension positive. Inside this file: mm, N, MPa.
"""

import argparse
import json
import sys
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.records.files import complete, write_json
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.verify.reference.fe_field import METADATA, REFERENCE, STRESSES, read_field
from rsmpm_ti.verify.reference.meshing import Disc, Plate, Spacing, on_boundary, slit_distance, triangles

E, NU = 17e3, 0.14
LAMBDA, MU = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))

SPECIMENS = {
    "slit_specimen_1mm": Plate(slit=Slit(centre=(25.0, 50.0), length=15.0, width=1.0, angle=45.0)),
    "slit_specimen_2mm": Plate(slit=Slit(centre=(25.0, 50.0), length=15.0, width=2.0, angle=45.0)),
    "slit_disc_1mm": Disc(slit=Slit(centre=(50.0, 50.0), length=30.0, width=1.0, angle=90.0)),
}

FINE = Spacing(corner=0.002, end=0.01, face=0.2, load_edge=0.02, far=1.0, growth=0.07, load_growth=0.07)
"""The mesh of the solution. Much finer at the corners than away from them is needed: grading makes that cheap."""

COARSE = FINE.scaled(2.0)
"""Solved too, for the change that says how far FINE has converged."""

SAMPLING = {
    Plate: Spacing(corner=0.08, end=0.1, face=0.15, load_edge=1.0, far=1.5, growth=0.1, load_growth=1.0),
    Disc: Spacing(corner=0.1, end=0.1, face=0.25, load_edge=0.25, far=2.3, growth=0.15, load_growth=0.065),
}
"""The mesh that is written: a disc's stress varies most beside the loaded arcs."""

AWAY = 1.5
"""Errors of fields are stated for places farther than this from the slit [mm]."""

INSIDE = 5.0
"""The same for places also deeper than this below the outer boundary, hence out of the reach of loaded arcs [mm]."""

PLACES = 20_000
"""Number of random places, uniform over the specimen, at which fields are compared."""


@dataclass(frozen=True, eq=False)
class Solution:
    """Nodal values [6, n] of u_x, u_y [mm] and STRESSES [MPa] on a P2 mesh, for a nominal stress of 1 MPa."""

    basis: object  # skfem's, of a scalar
    values: np.ndarray
    shortening: float  # of the loaded height [mm]
    slit_nodes: np.ndarray
    unknowns: int

    def at(self, x: np.ndarray) -> np.ndarray:
        """u_x, u_y and STRESSES at positions x [m, 2] -> [m, 6]."""
        basis, cells = self.basis, _cells(self.basis.mesh, x)
        local = np.full((2, len(x), 1), 1.0 / 3.0)
        for _ in range(5):  # Newton; not skfem's invF, which never ends for places 1e-12 outside of their triangle
            miss = x.T[:, :, None] - basis.mapping.F(local, tind=cells)
            local += np.einsum("ijmk,jmk->imk", basis.mapping.invDF(local, tind=cells), miss)
        weights = [basis.elem.gbasis(basis.mapping, local, k, tind=cells)[0].value[:, 0] for k in range(basis.Nbfun)]
        return np.einsum("vkm,km->mv", self.values[:, basis.element_dofs[:, cells]], np.stack(weights))

    def largest_tension(self, slit: Slit) -> tuple[float, list[float]]:
        """sigma_1 at the node of the slit where it is largest [MPa], and its place along and across the flaw [mm]."""
        xx, yy, _, xy = self.values[2:, self.slit_nodes]
        sigma_1 = 0.5 * (xx + yy) + np.hypot(0.5 * (xx - yy), xy)
        s = slit.frame(self.basis.doflocs[:, self.slit_nodes[[np.argmax(sigma_1)]]].T)[0]
        return float(sigma_1.max()), (s if s[0] > 0.0 else -s).tolist()  # half a turn maps a specimen on itself


def _area(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Twice the signed area of triangles with corners [2, ...]."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _cells(mesh, x: np.ndarray) -> np.ndarray:
    """The triangle that holds each place, x [m, 2] -> [m]: of the dozen nearest, the one it is least outside of."""
    from scipy.spatial import cKDTree

    near = cKDTree(mesh.p[:, mesh.t].mean(axis=1).T).query(x, 12)[1]
    a, b, c = (mesh.p[:, mesh.t[k, near]] for k in range(3))
    y = x.T[:, :, None]
    weights = np.stack([_area(y, b, c), _area(a, y, c), _area(a, b, y)]) / _area(a, b, c)
    return np.take_along_axis(near, weights.min(axis=0).argmax(axis=1)[:, None], axis=1)[:, 0]


def _curved_mesh(specimen: Plate | Disc, ends: str, spacing: Spacing):
    """skfem's MeshTri2 whose edges follow round boundaries; with its outer boundary edges and those of the slit."""
    from skfem import MeshTri1, MeshTri2

    points, cells = triangles(specimen, ends, spacing)
    mesh = MeshTri2.from_mesh(MeshTri1(np.ascontiguousarray(points.T), np.ascontiguousarray(cells.T)))
    x, edges = mesh.doflocs.copy(), mesh.boundary_facets()
    middle = mesh.dofs.facet_dofs[0, edges]
    x[:, middle] = on_boundary(specimen, ends, x[:, middle].T).T
    outer = specimen.depth(x[:, middle].T) < 1.0  # every slit lies deeper
    return replace(mesh, doflocs=x), edges[outer], edges[~outer]


def _pressure_forces(specimen: Plate | Disc, mesh, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes of the pressed boundary edges [f, 3] and f_a = -p int N_a n ds on them [N/mm, f, 3, 2].

    Not by skfem's FacetBasis: it inverts the curved mapping to 1e-12, which short edges far from the origin miss.
    """
    edges = edges[specimen.pressed(mesh.doflocs[:, mesh.dofs.facet_dofs[0, edges]].T)]
    nodes = np.vstack([mesh.facets[:, edges], mesh.dofs.facet_dofs[:, edges]]).T
    s, w = np.polynomial.legendre.leggauss(4)
    shape = np.stack([0.5 * s * (s - 1.0), 0.5 * s * (s + 1.0), 1.0 - s**2])
    slope = np.stack([s - 0.5, s + 0.5, -2.0 * s])
    x = mesh.doflocs.T[nodes]
    tangent = np.einsum("ag,fad->fgd", slope, x)
    normal = np.stack([tangent[:, :, 1], -tangent[:, :, 0]], axis=-1)
    outward = np.sign(np.einsum("fd,fd->f", normal.sum(axis=1), x[:, 2] - np.array(specimen.slit.centre)))
    return nodes, -specimen.pressure * np.einsum("f,g,ag,fgd->fad", outward, w, shape, normal)


def solve(specimen: Plate | Disc, ends: str, spacing: Spacing) -> Solution:
    """K u = f with the specimen's loading, scaled to a nominal stress of 1 MPa; mean u_x is zero."""
    import skfem
    from scipy.sparse.linalg import splu
    from skfem.models.elasticity import linear_elasticity

    mesh, outer, inner = _curved_mesh(specimen, ends, spacing)
    basis = skfem.Basis(mesh, skfem.ElementVector(skfem.ElementTriP2()), intorder=4)
    scalar = basis.with_element(skfem.ElementTriP2())
    K = linear_elasticity(LAMBDA, MU).assemble(basis).tocsr()  # plane strain: the constants of three dimensions
    x, components = basis.doflocs.T, basis.split_indices()
    axis = np.zeros(basis.N, dtype=int)
    axis[components[1]] = 1
    fixed, u = specimen.prescribed(x, axis)
    f = np.zeros(basis.N)
    nodes, forces = _pressure_forces(specimen, mesh, outer)
    for d in range(2):
        np.add.at(f, components[d][nodes], forces[:, :, d])
    free = np.flatnonzero(~fixed)
    symmetric = {"permc_spec": "MMD_AT_PLUS_A", "diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    u[free] = splu(K[free][:, free].tocsc(), **symmetric).solve((f - K @ u)[free])

    top, bottom = specimen.top(x) & (axis == 1), specimen.bottom(x) & (axis == 1)
    u /= specimen.nominal_stress(-(K @ u)[top].sum())
    measure = skfem.LinearForm(lambda v, w: v).assemble(scalar)
    u[components[0]] -= measure @ u[components[0]] / measure.sum()  # takes out the sliding that nothing holds
    return Solution(
        basis=scalar,
        values=np.concatenate([u[np.stack(components)], _nodal_stress(basis, scalar, u)]),
        shortening=float(u[bottom].mean() - u[top].mean()),
        slit_nodes=scalar.get_dofs(inner).flatten(),
        unknowns=len(free),
    )


def _nodal_stress(basis, scalar, u: np.ndarray) -> np.ndarray:
    """STRESSES [4, n]: those of each triangle at its six nodes, averaged over triangles by their areas."""
    import skfem
    from skfem.helpers import sym_grad

    at_nodes = skfem.Basis(basis.mesh, basis.elem, quadrature=(skfem.ElementTriP2.doflocs.T, np.ones(6)))
    strain = np.array(sym_grad(at_nodes.interpolate(u)))
    mean = LAMBDA * (strain[0, 0] + strain[1, 1])
    stress = (mean + 2.0 * MU * strain[0, 0], mean + 2.0 * MU * strain[1, 1], mean, 2.0 * MU * strain[0, 1])
    area, nodes = basis.dx.sum(axis=1), scalar.element_dofs.T  # nodes [t, 6]
    total = [np.bincount(nodes.ravel(), (s * area[:, None]).ravel()) for s in (*stress, np.ones(nodes.shape))]
    return np.stack(total[:4]) / total[4]


def sample(solution: Solution, specimen: Plate | Disc) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points [n, 2], triangles [t, 3] and values [n, 6] of the mesh that is written.

    At the corners of the slit, where the exact stress has no bound, stands its mean over the triangles around them.
    """
    points, cells = triangles(specimen, "square", SAMPLING[type(specimen)])
    order = np.lexsort((points[:, 1], np.floor(points[:, 0])))  # neighbours close together compress better
    points, cells = points[order], np.argsort(order)[cells]
    cells = cells[np.lexsort(cells.T)]
    values = solution.at(points)
    half = 0.5 * np.array([specimen.slit.length, specimen.slit.width])
    for corner in np.flatnonzero(np.all(np.abs(np.abs(specimen.slit.frame(points)) - half) < 1e-6, axis=1)):
        around = points[cells[np.any(cells == corner, axis=1)]].mean(axis=1)
        values[corner, 2:] = solution.at(around)[:, 2:].mean(axis=0)
    return points, cells, values


def write(path: Path, points: np.ndarray, cells: np.ndarray, values: np.ndarray) -> None:
    """VTU in metres, with stresses over the nominal one and the displacement for a nominal stress of 1 MPa."""
    import meshio

    def padded(x):
        return np.pad(x, ((0, 0), (0, 3 - x.shape[1]))).astype(np.float32)

    mantissa, exponent = np.frexp(values[:, 2:])  # 13 bits, 6e-5 of the stress: more would be noise to compress
    stress = np.ldexp(np.round(mantissa * 2.0**13), exponent - 13).astype(np.float32)
    data = {"displacement": padded(1e-3 * values[:, :2]), **dict(zip(STRESSES, stress.T, strict=True))}
    mesh = meshio.Mesh(padded(1e-3 * points), [("triangle", cells.astype(np.int32))], point_data=data)
    with complete(path) as part:
        meshio.write(part, mesh, file_format="vtu", binary=True, compression="zlib")


def positions_away(specimen: Plate | Disc) -> np.ndarray:
    """Random places in the specimen, farther than AWAY from the slit; [m, 2]."""
    x = np.random.default_rng(1).uniform(0.0, 1.0, (PLACES, 2)) * specimen.box
    return x[(specimen.depth(x) > 0.01) & (slit_distance(specimen.slit, x) > AWAY)]


def _errors(specimen: Plate | Disc, x: np.ndarray, difference: np.ndarray) -> dict:
    """Root mean square, of the worst of STRESSES, and largest size of a difference of stresses [m, 4]."""
    known = ~np.isnan(difference[:, 0])  # a few places lie between the circle and the edges that stand for it
    inside = known & (specimen.depth(x) > INSIDE)
    return {
        "rms": float(np.sqrt(np.mean(difference[known] ** 2, axis=0)).max()),
        "rms_inside": float(np.sqrt(np.mean(difference[inside] ** 2, axis=0)).max()),
        "largest": float(np.abs(difference[known]).max()),
        "largest_inside": float(np.abs(difference[inside]).max()),
    }


def make(name: str, out: Path) -> dict:
    """Solve one specimen, write its VTU, and return what is to be known about it."""
    specimen = SPECIMENS[name]
    fine = {ends: solve(specimen, ends, FINE) for ends in ("none", "square", "round")}
    coarse = {ends: solve(specimen, ends, COARSE) for ends in ("none", "square", "round")}
    ratios, coarse_ratios = (
        {ends: solutions["none"].shortening / solutions[ends].shortening for ends in ("square", "round")}
        for solutions in (fine, coarse)
    )
    k_t, position = fine["round"].largest_tension(specimen.slit)
    points, cells, values = sample(fine["square"], specimen)
    path = out / f"{name}.vtu"
    write(path, points, cells, values)
    x = positions_away(specimen)
    exact = fine["square"].at(x)[:, 2:]
    read = read_field(path, {}).sigma(1e-3 * x)
    return {
        "command": f"python -m rsmpm_ti.verify.reference.finite_elements {name}",
        "versions": {package: version(package) for package in ("scikit-fem", "gmsh", "meshio", "numpy", "scipy")},
        "nominal_stress": specimen.nominal,
        "stress": "over the nominal stress; P2 gradients at the nodes of triangles, averaged by area; tension positive",
        "displacement": "in metres for a nominal stress of 1 MPa; mean u_x of the specimen is zero",
        "modulus_ratio": {"meaning": "shortening without the slit over shortening with it", **ratios},
        "shortening_mm": {ends: solution.shortening for ends, solution in fine.items()},
        "k_t": {"meaning": "largest sigma_1 on the slit with round ends", "value": k_t, "place_mm": position},
        "mesh": {"spacing": vars(FINE), "unknowns": {ends: solution.unknowns for ends, solution in fine.items()}},
        "change_from_mesh_twice_as_coarse": {
            "modulus_ratio": {ends: ratios[ends] - coarse_ratios[ends] for ends in ratios},
            "k_t": k_t - coarse["round"].largest_tension(specimen.slit)[0],
            "stress": _errors(specimen, x, coarse["square"].at(x)[:, 2:] - exact),
        },
        "sampling": {
            "spacing": vars(SAMPLING[type(specimen)]),
            "points": len(points),
            "stress_error": _errors(specimen, x, read[:, [0, 1, 2, 0], [0, 1, 2, 1]] - exact),
        },
        "errors_hold": f"> {AWAY:g} mm from the slit; inside: also > {INSIDE:g} mm below the outer boundary",
    }


def main(arguments: list[str] | None = None) -> int:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.verify.reference.finite_elements", description="Make reference fields."
    )
    p.add_argument("names", nargs="*", metavar="NAME", help=f"specimens (default all): {', '.join(SPECIMENS)}")
    p.add_argument("--out", type=Path, default=REFERENCE, metavar="DIR", help="output folder (default: the package's)")
    options = p.parse_args(arguments)
    try:
        for name in options.names:
            if name not in SPECIMENS:
                raise refuse("specimen", name, f"one of {', '.join(SPECIMENS)}")
        try:
            import gmsh  # noqa: F401
            import skfem  # noqa: F401
        except (ImportError, OSError) as error:  # OSError: gmsh lacks a system library
            raise SceneError(f"gmsh and scikit-fem are needed ({error}): pip install 'rsmpm_ti[reference]'") from error
        for name in options.names or SPECIMENS:
            path = options.out / METADATA
            found = make(name, options.out)
            known = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
            write_json(path, {**known, name: found})
            print(f"{name}: E_app/E' = {found['modulus_ratio']['square']:.5f} (round ends "
                  f"{found['modulus_ratio']['round']:.5f}), k_t = {found['k_t']['value']:.3f}")  # fmt: skip
    except SceneError as error:
        print(f"rsmpm_ti: {' '.join(str(error).split())}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
