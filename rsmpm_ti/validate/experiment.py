"""What a case of validation is: a case of the harness that declares what it was given and what judges it."""

import functools
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rsmpm_ti.cases.case import Case, Outcome
from rsmpm_ti.validate.comparison import Comparison
from rsmpm_ti.validate.data.tables import FOLDER

KEY = re.compile(r"(\w+\.csv)(?::([1-9]\d*))?")
"""Of a measured number: a table of the package, and its line; without one, all of it."""

SI = {"MPa": 1e6, "GPa": 1e9, "kN/m": 1e3, "mm": 1e-3, "um": 1e-6, "us": 1e-6}
"""Units of rows and inputs that are none of SI."""


@dataclass(frozen=True)
class Input:
    """One number that a prediction starts from. fitted_on: keys of the measured numbers that it was made of, none for
    what its source measured by other tests."""

    name: str
    value: float
    unit: str
    source: str
    fitted_on: tuple[str, ...] = ()


def _parsed(case: str, keys: Iterable[str]) -> dict[str, tuple[str, int]]:
    """(table, line) of each key, line 0 for all of a table. Raises ValueError for what is no key."""
    if isinstance(keys, str):
        raise ValueError(f"{case}: keys are a tuple of texts, not the text {keys!r}")
    found = {}
    for key in keys:
        match = KEY.fullmatch(key)
        table, line = match.groups() if match else ("", None)
        lines = len((FOLDER / table).read_text(encoding="utf-8").splitlines()) if (FOLDER / table).is_file() else 0
        if not 2 <= int(line or 2) <= lines:
            raise ValueError(f"{case}: {key!r} is no measured number: TABLE.csv:LINE of {FOLDER.name}/, or TABLE.csv")
        found[key] = (table, int(line or 0))
    return found


def _common(one: dict[str, tuple[str, int]], other: dict[str, tuple[str, int]]) -> list[str]:
    """Keys of the first that are in the second, where a whole table holds each of its lines."""
    return [
        key
        for key, (table, line) in one.items()
        if any(table == its and (line == at or not line or not at) for its, at in other.values())
    ]


@dataclass(frozen=True, kw_only=True)
class Experiment(Case):
    """A case, the numbers that its rock is made of, and keys of all measured numbers that judge it.

    Raises ValueError where a number would judge what it was fitted to, when it is made; and when it is run, where a row
    is judged by a number that is not declared, or that is an input.
    """

    inputs: tuple[Input, ...]
    judged: tuple[str, ...] = ()

    def __post_init__(self):
        if not self.inputs:
            raise ValueError(f"{self.name} declares no input")
        both = _common(_parsed(self.name, self.judged), self._fitted())
        if both:
            raise ValueError(f"{self.name} is judged by what it was fitted on: {', '.join(both)}")
        object.__setattr__(self, "run", functools.partial(self._held, self.run))

    def _fitted(self) -> dict[str, tuple[str, int]]:
        return {key: at for given in self.inputs for key, at in _parsed(self.name, given.fitted_on).items()}

    def _held(self, run: Callable[[bool], Outcome], full: bool) -> Outcome:
        """The outcome of a run, if its rows are judged as was declared."""
        outcome, declared = run(full), _parsed(self.name, self.judged)
        for row in outcome.rows:
            if not isinstance(row, Comparison) or not row.datum:
                continue
            used = _parsed(self.name, row.datum.split(", "))
            unknown = set(used) - set(_common(used, declared))
            if unknown:
                raise ValueError(
                    f"{self.name}: {row.quantity} is judged by {', '.join(unknown)}, which is not declared"
                )
            measured = row.reference * SI.get(row.unit, 1.0)
            for given in self.inputs:
                if abs(given.value * SI.get(given.unit, 1.0) - measured) <= 1e-9 * abs(measured):
                    raise ValueError(f"{self.name}: {row.quantity} is judged by its input {given.name}")
        return outcome
