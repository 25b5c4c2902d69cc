"""Files of meshes, read by meshio: their vertices, and the cells of the highest dimension that fill a body."""

import contextlib
import io
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np

from rsmpm_ti.errors import SceneError, reason, refuse

MAX_BYTES, MAX_CELLS = 64 * 2**20, 500_000

FORMATS = {".msh": "gmsh", ".stl": "stl", ".vtu": "vtu", ".obj": "obj"}
"""That are one file and nothing else: others may name further files, which would be read too."""

CORNERS = {"triangle": 3, "quad": 4, "tetra": 4}
"""Kinds of cells that fill a body; meshio puts the corners of curved ones (triangle6) first."""


class Cells(NamedTuple):
    """vertices [n, 3] in units of the file; cells of one dimension, arrays [m, corners] by kind."""

    vertices: np.ndarray
    by_kind: dict[str, np.ndarray]


def read_cells(name: str, data: bytes, group: str | None) -> Cells:
    """The cells of a file that lie in a physical group of gmsh, or all; tetrahedra, or else triangles and quads.

    Raises SceneError for a file that is no such mesh or is without the group.
    """
    suffix = Path(name).suffix.lower()
    if suffix not in FORMATS:
        raise refuse("mesh.file", name, f"a mesh, one of {', '.join(FORMATS)}", "`meshio convert` makes one of others")
    if suffix == ".vtu":
        _check_vtu(name, data)
    try:
        mesh = _read(data, suffix)
        with np.errstate(all="ignore"):  # of numbers that are none, which are refused below
            vertices = np.asarray(mesh.points, dtype=float)
        if vertices.ndim != 2 or vertices.shape[1] not in (2, 3):
            raise ValueError(f"its points are {list(vertices.shape)}")
        blocks = [(block.type.rstrip("0123456789"), np.asarray(block.data)) for block in mesh.cells]
        tags = _tags(mesh, group, name)
    except SceneError:
        raise
    except (Exception, SystemExit) as error:  # a damaged file makes meshio raise whatever it meets
        raise refuse("mesh.file", name, f"a mesh as {FORMATS[suffix]} writes it", reason(error)) from None
    vertices = np.column_stack([vertices, np.zeros((len(vertices), 3 - vertices.shape[1]))])
    found = _of_highest_dimension(blocks, tags)
    used = np.concatenate([cells.ravel() for cells in found.values()]) if found else np.zeros(0, dtype=int)
    if not len(used):
        where = "" if group is None else f" in the group {group!r}"
        raise refuse("mesh.file", name, "a mesh of triangles, quads or tetrahedra", f"it has none{where}")
    if used.min() < 0 or used.max() >= len(vertices) or not np.isfinite(vertices[used]).all():
        raise refuse("mesh.file", name, "a mesh", "some of its cells have a corner that is nowhere")
    if sum(map(len, found.values())) > MAX_CELLS:
        raise refuse("mesh.file", name, f"a mesh of at most {MAX_CELLS:,} cells", "an outline alone will do")
    return Cells(*_merged(vertices, found))


def _check_vtu(name: str, data: bytes) -> None:
    """Refuse what could unfold to any size."""
    if b"<!" in data[:4096].replace(b"<!--", b"") or b"<!ENTITY" in data:
        raise refuse("mesh.file", name, "XML without definitions of its own")
    if b"compressor=" in data:
        raise refuse("mesh.file", name, "a VTU that is not compressed", "`meshio decompress` makes it one")


def _read(data: bytes, suffix: str):
    """By meshio, from a copy: what was measured and what is read are then the same."""
    import meshio  # a third of a second, for scenes with a mesh

    with tempfile.TemporaryDirectory(prefix="rsmpm_ti-") as folder:
        copy = Path(folder) / f"mesh{suffix}"
        copy.write_bytes(data)
        quiet = io.StringIO()  # its warnings would come once for every copy of a scene
        with np.errstate(all="ignore"), contextlib.redirect_stdout(quiet), contextlib.redirect_stderr(quiet):
            return getattr(meshio, FORMATS[suffix]).read(str(copy))


def _tags(mesh, group: str | None, name: str) -> list[np.ndarray] | None:
    """Whether each cell of each block lies in a group; None where all do."""
    if group is None:
        return None
    if group not in mesh.field_data:
        there = ", ".join(sorted(mesh.field_data)) or "none"
        raise refuse("mesh.group", group, f"a physical group of {name}, which has: {there}")
    tag, dim = (int(number) for number in mesh.field_data[group])
    marks = mesh.cell_data["gmsh:physical"]
    return [(np.asarray(mark) == tag) & (block.dim == dim) for mark, block in zip(marks, mesh.cells, strict=True)]


def _of_highest_dimension(blocks: list, tags: list[np.ndarray] | None) -> dict[str, np.ndarray]:
    found: dict[str, list[np.ndarray]] = {}
    for k, (kind, cells) in enumerate(blocks):
        if kind in CORNERS:
            chosen = cells if tags is None else cells[tags[k]]
            found.setdefault(kind, []).append(chosen[:, : CORNERS[kind]].astype(int))
    joined = {kind: np.concatenate(parts) for kind, parts in found.items()}
    full = {kind: cells for kind, cells in joined.items() if len(cells)}
    return {"tetra": full["tetra"]} if "tetra" in full else full


def _merged(vertices: np.ndarray, by_kind: dict[str, np.ndarray]) -> tuple[np.ndarray, dict[str, np.ndarray]]:
    """Vertices that are used, each once: an STL has one for every triangle that meets there."""
    used = np.unique(np.concatenate([cells.ravel() for cells in by_kind.values()]))
    kept, number = np.unique(vertices[used], axis=0, return_inverse=True)
    new = np.zeros(len(vertices), dtype=int)
    new[used] = number.ravel()
    return kept, {kind: new[cells] for kind, cells in by_kind.items()}
