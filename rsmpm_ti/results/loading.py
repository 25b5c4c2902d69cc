"""A run that is done, read back from its folder: numbers of tables, and nothing of it is executed."""

import csv
import io
import json
import math
import os
from pathlib import Path
from typing import cast

import numpy as np

from rsmpm_ti.errors import SceneError, refuse, short
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.rows import Rows
from rsmpm_ti.records.snapshot import MODE_NAMES, Snapshot
from rsmpm_ti.records.tables import AXES
from rsmpm_ti.results.result import Result
from rsmpm_ti.results.stored import Stored

SUMMARY_BYTES, TABLE_BYTES = 16 * 2**20, 256 * 2**20
"""Most that is read of summary.json and of a table."""

MOST_COLUMNS = 10_000


def load_result(folder: str | os.PathLike) -> Result:
    """The Result of a run from its folder: its tables, in ten digits, its summary, frames and movie.

    What no table holds is not there: `fracture` and `snapshot` are None, and `events.id` is -1. Columns of the history
    are those of the file. A folder may be a stranger's: only regular files on its list are read, of a bounded size.
    Raises SceneError where there is no run, or a file of it is missing or damaged.
    """
    if not isinstance(folder, str | os.PathLike):
        raise refuse("folder", folder, "the path of a folder, as text or a Path")
    there = Stored(Path(folder).absolute())
    summary = _summary(there)
    stopped = summary["stopped"] if isinstance(summary.get("stopped"), str) else ""
    history, events = _rows(there, "history.csv"), _rows(there, "events.csv", texts=("mode",))
    _need(there, "history.csv", history, ("time_s", "axial_strain", "stress_top_Pa", "stress_bottom_Pa"))
    _need(there, "history.csv", history, ("failed_tension", "failed_shear"))
    frames = _rows(there, "frames.csv") if "frames.csv" in there.names else None
    if frames is not None:
        _need(there, "frames.csv", frames, ("frame", "time_s"))
        if not (np.isfinite(frames["frame"]) & np.isfinite(frames["time_s"]) & (abs(frames["frame"]) < 1e9)).all():
            raise SceneError(f"{there.path / 'frames.csv'} is no table of frames")
    return Result(
        history=history, summary=summary, events=_events(there, events, summary), fracture=None,
        snapshot=cast(Snapshot, None), out=there.path, stopped=stopped, frames=frames,
        reactions=_rows(there, "reactions.csv") if "reactions.csv" in there.names else None, run=there.run,
    )  # fmt: skip


def _summary(there: Stored) -> dict:
    try:
        found = json.loads(there.bytes("summary.json", SUMMARY_BYTES))
    except (ValueError, RecursionError) as error:
        raise error if isinstance(error, SceneError) else _damaged(there, "summary.json", "no JSON") from None
    if not isinstance(found, dict):
        raise _damaged(there, "summary.json", "no summary of a run")
    return found


def _damaged(there: Stored, name: str, why: str) -> SceneError:
    return SceneError(f"{there.path / name} is damaged: {short(why)}; run it again")


def _rows(there: Stored, name: str, texts: tuple[str, ...] = ()) -> Rows:
    """A table: float64, NaN for an empty cell; texts: columns of words, int8, the codes of MODE_NAMES."""
    kinds = dict.fromkeys(texts, np.int8)
    try:
        reader = csv.reader(io.StringIO(there.bytes(name, TABLE_BYTES).decode("utf-8"), newline=""), strict=True)
        header = next(reader, [])
        if not 0 < len(header) <= MOST_COLUMNS or len(set(header)) < len(header) or not all(header):
            raise _damaged(there, name, "it has no header")
        dtype = np.dtype([(column, kinds.get(column, np.float64)) for column in header])
        read = [MODE_NAMES.index if column in texts else _number for column in header]
        rows = (tuple(f(cell) for f, cell in zip(read, row, strict=True)) for row in reader)
        return np.fromiter(rows, dtype=dtype).view(Rows)
    except SceneError:
        raise
    except (ValueError, csv.Error) as error:
        raise _damaged(there, name, str(error)) from None


def _number(cell: str) -> float:
    value = float(cell) if cell else math.nan
    return value if math.isfinite(value) else math.nan


def _need(there: Stored, name: str, rows: Rows, columns: tuple[str, ...]) -> None:
    missing = [column for column in columns if column not in (rows.dtype.names or ())]
    if missing:
        raise _damaged(there, name, f"column {missing[0]} is missing")


def _events(there: Stored, rows: Rows, summary: dict) -> EventTable:
    _need(there, "events.csv", rows, ("time_s", "x_m", "y_m", "mode", "sigma_1_Pa", "sigma_3_Pa", "released_energy_J"))
    names = rows.dtype.names or ()
    x = np.column_stack([rows[f"{axis}_m"] for axis in AXES if f"{axis}_m" in names])
    normal = None
    if "crack_normal_deg" in names:
        angle = np.radians(rows["crack_normal_deg"])
        normal = np.column_stack([np.cos(angle), np.sin(angle), *[np.zeros(len(x))] * (x.shape[1] - 2)])
    scale = summary.get("time_scale")
    return EventTable(
        time=rows["time_s"], x=x, mode=rows["mode"], sigma_1=rows["sigma_1_Pa"], sigma_3=rows["sigma_3_Pa"],
        released=rows["released_energy_J"], id=np.full(len(x), -1), normal=normal,
        time_scale=float(scale) if isinstance(scale, int | float) and 0.0 < scale < 1e9 else 1.0,
    )  # fmt: skip
