"""What a verification case is: a run of the real solver, its rows of reference against result, and a picture."""

import math
from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Row:
    """One compared number. `error` is held against `tolerance`; `reason` says why that tolerance."""

    quantity: str
    reference: float
    got: float
    error: float
    tolerance: float
    reason: str

    @property
    def passed(self) -> bool:
        return math.isfinite(self.error) and abs(self.error) <= self.tolerance


def relative(quantity: str, reference: float, got: float, tolerance: float, reason: str) -> Row:
    """got/reference - 1 within the tolerance."""
    return Row(quantity, reference, got, got / reference - 1.0, tolerance, reason)


def difference(quantity: str, reference: float, got: float, tolerance: float, reason: str) -> Row:
    """got - reference within the tolerance, in the quantity's own unit."""
    return Row(quantity, reference, got, got - reference, tolerance, reason)


def at_most(quantity: str, got: float, limit: float, reason: str) -> Row:
    """An error measure `got`, ideally 0, below a limit."""
    return Row(quantity, 0.0, got, got, limit, reason)


def at_least(quantity: str, got: float, least: float, reason: str) -> Row:
    """A number, such as an order of convergence, that must not fall below `least`; more is welcome."""
    return Row(quantity, least, got, 0.0 if got >= least else got - least, 0.0, reason)  # NaN stays NaN


def seen(quantity: str, got: float, why: str) -> Row:
    """A number that is reported and not judged: a limit found, of which no theory says what it ought to be."""
    return Row(quantity, math.nan, got, 0.0, math.inf, why)


@dataclass(frozen=True)
class Outcome:
    """Rows of one case, and how to draw it if there is something to see: `draw` fills a matplotlib Figure."""

    rows: tuple[Row, ...]
    draw: Callable | None = None


@dataclass(frozen=True)
class Case:
    """`run(full)` returns an Outcome; `full` is the long tier: finer, longer or more of it.

    quick: whether the case has a quick form, which `make test` runs. Taichi is started (f64, CPU) before each.
    """

    name: str
    about: str
    run: Callable[[bool], Outcome]
    quick: bool = True

    def in_full(self, asked: bool) -> bool:
        """Whether it is run in its full form, where that is `asked` for or it has no other."""
        return asked or not self.quick
