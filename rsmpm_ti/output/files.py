"""Files of a run, written so that what is already there is never lost: each under its name only when complete."""

import csv
import json
import os
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from rsmpm_ti.records.snapshot import HISTORY_COLUMNS, MODE_NAMES, Snapshot


@contextmanager
def complete(path: Path):
    """Yield a temporary name in the same folder; it becomes `path` only if the block succeeds."""
    path = Path(path)
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(f".{path.stem}.part{path.suffix}")
    try:
        yield part
        os.replace(part, path)
    finally:
        part.unlink(missing_ok=True)


def write_json(path: Path, data: dict) -> None:
    with complete(path) as part, open(part, "w", encoding="utf-8") as file:
        json.dump(data, file, indent=2, allow_nan=False)
        file.write("\n")


def write_history(path: Path, history: np.ndarray) -> None:
    """history.csv: a header of HISTORY_COLUMNS, one line per row."""
    with complete(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(HISTORY_COLUMNS)
        writer.writerows([f"{value:.10g}" for value in row] for row in history.tolist())


def write_events(path: Path, events) -> None:
    """events.csv: time, place, mode, extreme principal stresses and released energy of each failure.

    Of rock with a direction also the angle of the crack's normal from +x [degrees].
    """
    axes = "xyz"[: events.x.shape[1]]
    header = ["time_s", *(f"{a}_m" for a in axes), "mode", "sigma_1_Pa", "sigma_3_Pa", "released_energy_J"]
    directional = events.crack_angle is not None
    if directional:
        header.append("crack_normal_deg")
    with complete(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        for e in range(len(events)):
            numbers = [events.time[e], *events.x[e]]
            stresses = [events.sigma_1[e], events.sigma_3[e], events.released[e]]
            if directional:
                stresses.append(np.degrees(events.crack_angle[e]))
            writer.writerow(
                [*(f"{v:.10g}" for v in numbers), MODE_NAMES[events.mode[e]], *(f"{v:.10g}" for v in stresses)]
            )


def write_table(path: Path, header: tuple[str, ...], rows) -> None:
    """A CSV of one header and any rows; numbers to ten digits, an empty cell for what is None or not finite."""

    def cell(value) -> str:
        if value is None or (isinstance(value, float | np.floating) and not np.isfinite(value)):
            return ""
        return f"{value:.10g}" if isinstance(value, float | np.floating) else str(value)

    with complete(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([cell(value) for value in row] for row in rows)


def write_vtu(path: Path, snapshot: Snapshot) -> None:
    """Particles as vertices for ParaView; vectors and points padded to 3D, stress as 9 components.

    Places are in double precision. The rest is in single, which takes half of the time and of the disk; a checkpoint
    holds every digit.
    """
    import meshio

    n = len(snapshot.x)

    def padded(vectors):
        return np.pad(vectors, ((0, 0), (0, 3 - vectors.shape[1])))

    fields = {
        "displacement": padded(snapshot.displacement),
        "velocity": padded(snapshot.velocity),
        "stress": snapshot.sigma.reshape(n, 9),
        "sigma_1": snapshot.sigma_1,
        "sigma_3": snapshot.sigma_3,
        "failure_mode": snapshot.failure_mode,
        "failure_time": snapshot.failure_time,
        "volume": snapshot.volume,
        "strength_factor": snapshot.strength,
        "margin": snapshot.margin,
        "governs": snapshot.governs,
        "damage": snapshot.damage,
        "aperture_m": snapshot.aperture,
    }
    single = {name: a.astype(np.float32) if a.dtype == np.float64 else a for name, a in fields.items()}
    mesh = meshio.Mesh(padded(snapshot.x), [("vertex", np.arange(n)[:, None])], point_data=single)
    with complete(path) as part:
        meshio.write(part, mesh, file_format="vtu", binary=True, compression="zlib")


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
    """Arrays only, no pickle: loading a checkpoint runs nobody's code. It is on the disk before it gets its name."""
    latest, previous = (Path(folder) / name for name in CHECKPOINTS)
    with complete(latest) as part:
        with open(part, "wb") as file:
            np.savez(file, **arrays)  # type: ignore[arg-type]  # no array is named like its keyword allow_pickle
            file.flush()
            os.fsync(file.fileno())
        if latest.exists():
            os.replace(latest, previous)
