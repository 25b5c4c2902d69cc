"""Files of a run, written from their tables; each under its name only when complete (`records/files.py`)."""

import os
from pathlib import Path

import numpy as np

from rsmpm_ti.records.events import EVENTS, EventTable
from rsmpm_ti.records.files import complete, write_csv
from rsmpm_ti.records.snapshot import INSTANT, MODE_NAMES, PARTICLES, Snapshot
from rsmpm_ti.records.tables import Table


def write_table(path: Path, table: Table, source, dim: int = 2) -> None:
    """A table as CSV, filled from what it is made of."""
    write_csv(path, *table.rows(source, dim))


def write_rows(path: Path, rows: np.ndarray) -> None:
    """A structured array as CSV: its fields are the columns, one line per row."""
    write_csv(path, rows.dtype.names or (), rows.tolist())


def write_events(path: Path, events: EventTable) -> None:
    write_table(path, EVENTS, events, events.x.shape[1])


def write_vtu(path: Path, snapshot: Snapshot, instant: dict[str, float] | None = None) -> None:
    """Particles as vertices for ParaView.

    Positions are in double precision. The rest is in single, which takes half of the time and of the disk; a checkpoint
    holds every digit. instant: numbers of the whole specimen then (INSTANT), which become field data, with the codes
    of failure modes; those that are not known are left out.
    """
    import meshio

    dim, columns = snapshot.x.shape[1], PARTICLES.filled(snapshot, 3)
    fields = {name: _as_point_data(np.asarray(entries), dim) for name, entries in columns.items()}
    for name, entries in snapshot.history.items():
        fields[f"law_{name}" if name in fields else name] = _as_point_data(entries, dim)
    mesh = meshio.Mesh(_padded(snapshot.x), [("vertex", np.arange(len(snapshot.x))[:, None])], point_data=fields)
    with complete(path) as part:
        meshio.write(part, mesh, file_format="vtu", binary=True, compression="zlib")
        grid = b"<UnstructuredGrid>"
        before, _, after = part.read_bytes().partition(grid)  # meshio writes no field data
        part.write_bytes(b"".join((before, _legend(), grid, _field_data(instant or {}), after)))


def _field_data(instant: dict[str, float]) -> bytes:
    """Numbers, since readers such as meshio know no texts: a code is a field of its name."""
    known = {name: float(number) for name, number in instant.items() if np.isfinite(number)}
    numbers = [("Float64", name, f"{number:.17g}") for name, number in known.items()]
    numbers += [("Int8", f"failure_mode_{name}", str(mode)) for mode, name in enumerate(MODE_NAMES)]
    arrays = "".join(
        f'<DataArray type="{kind}" Name="{name}" NumberOfTuples="1" format="ascii">{number}</DataArray>\n'
        for kind, name, number in numbers
    )
    return f"<FieldData>\n{arrays}</FieldData>\n".encode()


def _legend() -> bytes:
    """What each array is, for whoever opens the file as text."""
    columns = [*INSTANT.columns, *PARTICLES.columns]
    lines = [f"{column.name} [{column.unit}]: {column.about}".replace("--", "-") for column in columns]
    return "\n".join(["<!-- SI units, tension positive", *lines, "-->", ""]).encode()


def _as_point_data(entries: np.ndarray, dim: int) -> np.ndarray:
    """Vectors with three components, tensors with nine."""
    entries = _single(entries)
    if entries.ndim == 3:
        return entries.reshape(len(entries), 9)
    return _padded(entries) if entries.ndim == 2 and entries.shape[1] == dim else entries


def _single(entries: np.ndarray) -> np.ndarray:
    return entries.astype(np.float32) if entries.dtype == np.float64 else entries


def _padded(vectors: np.ndarray) -> np.ndarray:
    return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))


def write_pvd(path: Path, entries: list[tuple[float, str]]) -> None:
    """ParaView collection: (time [s], file name) of each VTU."""
    lines = [f'    <DataSet timestep="{time:.10g}" file="{name}"/>' for time, name in entries]
    text = "\n".join(
        ['<?xml version="1.0"?>', '<VTKFile type="Collection" version="0.1">', "  <Collection>", *lines,
         "  </Collection>", "</VTKFile>", ""]
    )  # fmt: skip
    with complete(path) as part:
        part.write_text(text, encoding="utf-8")


CHECKPOINTS = ("checkpoint.npz", "checkpoint.previous.npz")
"""The latest and the one before, which is used where the latest is damaged."""


def write_checkpoint(folder: Path, arrays: dict[str, np.ndarray]) -> None:
    """Arrays only, no pickle: loading a checkpoint runs nobody's code."""
    latest, previous = (Path(folder) / name for name in CHECKPOINTS)
    with complete(latest) as part:
        with open(part, "wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]  # no array is named like its keyword allow_pickle
        if latest.exists():
            os.replace(latest, previous)


COLLECTION = "particles.pvd"


def frame_name(kind: str, number: int) -> str:
    """Of a picture, within the folder of its run."""
    return f"frames/{kind}_{number:04d}.png"


def vtu_name(number: int) -> str:
    return f"particles_{number:04d}.vtu"


def number_of(name: str) -> int:
    """The number in the name of a frame or a particle file."""
    return int(name.rpartition("_")[2].partition(".")[0])


ENDS = {".png": b"\x00\x00\x00\x00IEND\xaeB`\x82", ".vtu": b"</VTKFile>"}
"""Files of these kinds end so; one that was cut or emptied does not."""


def whole(path: Path) -> bool:
    """Whether a picture or particle file has its end."""
    try:
        with open(path, "rb") as file:
            file.seek(-min(64, os.fstat(file.fileno()).st_size), os.SEEK_END)
            return file.read().rstrip().endswith(ENDS[path.suffix])
    except OSError:
        return False
