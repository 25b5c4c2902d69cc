"""Traces of flaws from a table: x1, y1, x2, y2 and perhaps a width, a row each, as a trace map gives them."""

import csv
import os
from pathlib import Path
from typing import Annotated

from annotated_types import Len
from pydantic import BeforeValidator

from rsmpm_ti.checks import Coordinate
from rsmpm_ti.errors import SceneError, reason, shown
from rsmpm_ti.spec.drawings.drawn_file import read
from rsmpm_ti.spec.drawings.polygon import rows

MAX_BYTES = 16 * 2**20

MAX_TRACES = 1000
"""Flaws of a set: whether the faces of one separate is statics of its own."""

Traces = Annotated[tuple[Annotated[tuple[Coordinate, ...], Len(4, 5)], ...], Len(1, MAX_TRACES), BeforeValidator(rows)]
"""Rows of x1, y1, x2, y2 and perhaps a width [m]; a list or an array [n, 4] will do."""


def read_traces(file: str | os.PathLike, scale: float) -> tuple[tuple[float, ...], ...]:
    """Rows of a CSV of 4 or 5 numbers, times `scale`; commas, semicolons or tabs; a first row of names and rows that
    begin with # are passed over. Raises SceneError, which names the line."""
    name = os.fspath(file)
    data = read("segments.file", name, None, MAX_BYTES).data
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise SceneError(f"{name} is no table: {reason(error)}") from None
    rows: list[tuple[float, ...]] = []
    for line, row in enumerate(_cells(text), start=1):
        if not row or row[0].startswith("#"):
            continue
        try:
            numbers = tuple(float(cell) * scale for cell in row)
        except ValueError:
            if not rows and line == 1 and not any(map(_is_number, row)):
                continue
            raise SceneError(f"{Path(name).name} line {line}: {shown(row)} are no numbers x1, y1, x2, y2") from None
        if len(numbers) not in (4, 5):
            wanted = "it must hold x1, y1, x2, y2 and perhaps a width"
            raise SceneError(f"{Path(name).name} line {line} has {len(numbers)} numbers: {wanted}")
        rows.append(numbers)
    if not rows:
        raise SceneError(f"{name} holds no trace: a row each of x1, y1, x2, y2 and perhaps a width")
    return tuple(rows)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True


def _cells(text: str):
    """Cells of each line, of which the last may be empty."""
    for line in text.splitlines():
        mark = next((mark for mark in (";", "\t", ",") if mark in line), ",")
        cells = [cell.strip() for cell in next(csv.reader([line], delimiter=mark), [])]
        yield cells[:-1] if cells and not cells[-1] else cells
