"""Rows of named columns as a user holds them: a structured NumPy array that also becomes a frame of pandas."""

from typing import Any

import numpy as np

from rsmpm_ti.errors import SceneError


class Rows(np.ndarray):
    """A structured array, [rows], a float64 field for each column; made by `array.view(Rows)`.

    A slice, or several columns, are Rows again. A single column, and an answer of yes and no, are plain arrays.
    """

    def __getitem__(self, key) -> Any:
        return plain_unless_named(super().__getitem__(key))

    def __eq__(self, other) -> Any:
        return plain_unless_named(super().__eq__(other))

    def __ne__(self, other) -> Any:
        return plain_unless_named(super().__ne__(other))

    def to_frame(self):
        """A pandas.DataFrame, a column for each of the names, the rows numbered from 0; a copy.

        Raises SceneError where pandas is not installed.
        """
        return data_frame({name: self[name].copy() for name in self.dtype.names or ()})


def plain_unless_named(found):
    return found.view(np.ndarray) if isinstance(found, Rows) and found.dtype.names is None else found


def data_frame(columns: dict):
    """Name -> entries, all of one length, as a pandas.DataFrame. Raises SceneError where pandas is not installed."""
    try:
        import pandas
    except ImportError as error:
        raise SceneError(f"to_frame needs pandas, `pip install rsmpm_ti[pandas]`: {error}") from None
    return pandas.DataFrame(columns)
