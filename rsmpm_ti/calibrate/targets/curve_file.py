"""A measured curve of stress against strain: a CSV of two columns, `strain` and `stress_MPa`."""

import csv
import math
import stat
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import SceneError, reason, refuse, shown

HEADER = ["strain", "stress_MPa"]
MAX_BYTES, LEAST_ROWS, MOST_ROWS = 2**20, 3, 20_000
MOST_STRAIN, MOST_STRESS = 0.5, 10_000.0
"""Strain [1] and stress [MPa] that no rock reaches."""


def read_curve(name: object, folder: Path, field: str) -> tuple[np.ndarray, np.ndarray]:
    """Strain [1] and stress [Pa], each [rows]; name: from the folder of the targets; field: for refusals.

    Raises SceneError.
    """
    if not isinstance(name, str) or not name or "\0" in name:
        raise refuse(field, name, "the name of a CSV file")
    path = folder / name
    try:
        if not stat.S_ISREG(path.stat().st_mode) or path.stat().st_size > MAX_BYTES:
            raise refuse(field, name, f"a regular file of at most {MAX_BYTES} bytes")
        with open(path, newline="", encoding="utf-8-sig") as file:
            header, *rows = list(csv.reader(file)) or [[]]
    except (UnicodeDecodeError, csv.Error):
        raise refuse(field, name, "a CSV in UTF-8") from None
    except OSError as error:
        raise refuse(field, name, "a file that can be read", reason(error)) from None
    if [cell.strip() for cell in header] != HEADER:
        raise SceneError(f"{field}: the first line of {name} is {shown(','.join(header))}, not {','.join(HEADER)}")
    rows = [row for row in rows if row]
    if not LEAST_ROWS <= len(rows) <= MOST_ROWS:
        raise refuse(field, name, f"a curve of {LEAST_ROWS} to {MOST_ROWS} rows", f"it has {len(rows)}")
    values = np.array([_row(row, k + 2, field) for k, row in enumerate(rows)])
    if values[:, 1].max() <= 0.0:
        raise refuse(field, name, "a curve with a stress above 0")
    return values[:, 0], 1e6 * values[:, 1]


def _row(row: list[str], line: int, field: str) -> tuple[float, float]:
    try:
        strain, stress = map(float, row)
    except ValueError:
        raise SceneError(f"{field}: line {line} is {shown(','.join(row))}, not two numbers") from None
    good = math.isfinite(strain) and math.isfinite(stress)
    if not good or not 0.0 <= strain <= MOST_STRAIN or abs(stress) > MOST_STRESS:
        allowed = f"a strain from 0 to {MOST_STRAIN:g} (no percentage) and a stress up to {MOST_STRESS:g} MPa"
        raise SceneError(f"{field}: line {line} is {shown(','.join(row))}; it must be {allowed}")
    return strain, stress
