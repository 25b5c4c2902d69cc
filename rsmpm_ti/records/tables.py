"""Tables with names: one declaration per column, array or key that a run writes, with its unit and its meaning.

Files are written from these declarations, and docs/outputs.md is printed from them (`output/describe.py`), so that the
page cannot say anything else than the files.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class Column:
    """One column of a table.

    name: as it stands in the file; with `{axis}` in it, it is one column for each axis, x, y and in 3D z.
    unit: in SI, "1" for a number without one, "" for a text.
    about: its meaning, with its sign convention and codes.
    value: makes it. For a history column: from a `View` of the run, one number. For the other tables: from what the
    table is made of, an entry per row, and per row and axis where the name has `{axis}`.
    only: where it is present, in words; "" everywhere. wanted: whether it is, of what the table is made of.
    """

    name: str
    unit: str
    about: str
    value: Callable | None = None
    only: str = ""
    wanted: Callable = lambda source: True


@dataclass(frozen=True, kw_only=True)
class Table:
    """The columns of one file."""

    file: str
    about: str
    columns: tuple[Column, ...]

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(column.name for column in self.columns)

    def filled(self, source, dim: int) -> dict[str, list | np.ndarray]:
        """Name -> entries of every column, of what the table is made of."""
        found: dict[str, list | np.ndarray] = {}
        for column in self.columns:
            if not column.wanted(source):
                continue
            assert column.value is not None, f"{column.name} is only described, not made here"
            entries = column.value(source)
            if "{axis}" in column.name:
                by_axis = np.asarray(entries).reshape(-1, dim).T
                found |= {column.name.format(axis=axis): by_axis[k] for k, axis in enumerate(AXES[:dim])}
            else:
                found[column.name] = entries
        return found

    def rows(self, source, dim: int) -> tuple[tuple[str, ...], Iterator[tuple]]:
        """Header and rows, as `files.write_csv` takes them."""
        found = self.filled(source, dim)
        return tuple(found), zip(*found.values(), strict=True)
