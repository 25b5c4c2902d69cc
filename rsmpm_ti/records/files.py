"""How every file is written: under its name only when complete, and numbers that are not finite in one way."""

import csv
import json
import os
from collections.abc import Iterable
from contextlib import contextmanager
from pathlib import Path

import numpy as np


@contextmanager
def complete(path: str | os.PathLike):
    """Yield a temporary name in the same folder; it becomes `path` only if the block succeeds, and is then on the disk.

    So what is already there is never lost: a reader finds the old file or the new one, never half of one, after a loss
    of power too. The temporary file is new, so that no link leads elsewhere.
    """
    path = Path(path)
    part = part_of(path)
    part.unlink(missing_ok=True)  # of a process that was killed
    os.close(os.open(part, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o666))
    try:
        yield part
        _sync(part, os.O_RDWR)
        os.replace(part, path)
        if hasattr(os, "O_DIRECTORY"):
            _sync(path.parent, os.O_RDONLY | os.O_DIRECTORY)
    finally:
        part.unlink(missing_ok=True)


def part_of(path: Path) -> Path:
    """The name under which a file is written until it is complete."""
    return path.with_name(f".{path.stem}.part{path.suffix}")


def _sync(path: Path, flags: int) -> None:
    descriptor = os.open(path, flags)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


LARGEST = 1e300
"""No quantity is as large: it is what a minimum over nothing leaves, where several threads take it."""


def known(value):
    """The value; None for a number that is not finite, or as large as a minimum over nothing: it is not defined.

    The one place that decides: an empty cell of a CSV and null of JSON are made of None.
    """
    return None if isinstance(value, float | np.floating) and not abs(value) < LARGEST else value


def cell(value) -> str:
    """One cell of a CSV: numbers to ten digits, nothing for what is not known."""
    value = known(value)
    if value is None:
        return ""
    return f"{value:.10g}" if isinstance(value, float | np.floating) else str(value)


def write_csv(path: str | os.PathLike, header: Iterable[str], rows: Iterable[Iterable]) -> None:
    """A CSV of one header and any rows."""
    with complete(path) as part, open(part, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows([cell(value) for value in row] for row in rows)


def plain(data):
    """Data as JSON can hold it: dicts, lists, texts and finite numbers."""
    if isinstance(data, dict):
        return {name: plain(value) for name, value in data.items()}
    if isinstance(data, tuple | list):
        return [plain(value) for value in data]
    return known(data)


def write_json(path: str | os.PathLike, data: dict) -> None:
    with complete(path) as part, open(part, "w", encoding="utf-8") as file:
        json.dump(plain(data), file, indent=2, allow_nan=False)
        file.write("\n")
