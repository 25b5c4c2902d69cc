"""One measured number beside one predicted number, and what is said about them."""

import math
from dataclasses import dataclass

from rsmpm_ti.cases.case import Row
from rsmpm_ti.cases.report import Layout


@dataclass(frozen=True, kw_only=True)
class Comparison(Row):
    """A prediction `got` beside `reference`, which was measured, or is theory's where a source says so.

    error: got/reference - 1, or in the quantity's own unit where `absolute`; tolerance: the distance that was asked
    for, infinite for a prediction that nothing judges; reason: where the reference comes from. low, high: scatter of
    the experiment, NaN where its source gives none. datum: key of the measured number (data/tables.py). beyond: why
    this model cannot come nearer, where that is known.
    """

    unit: str
    low: float = math.nan
    high: float = math.nan
    datum: str = ""
    beyond: str = ""
    absolute: bool = False

    @property
    def inside(self) -> bool:
        """Whether the prediction lies within the experiment's own scatter."""
        return self.low <= self.got <= self.high

    @property
    def passed(self) -> bool:
        return self.tolerance == math.inf or self.inside or super().passed

    @property
    def distance(self) -> str:
        """How far off, with its unit."""
        if not math.isfinite(self.error):
            return ""
        return f"{self.error:+.3g} {self.unit}" if self.absolute else f"{100.0 * self.error:+.1f} %"

    @property
    def verdict(self) -> str:
        if not math.isfinite(self.got):
            return "nothing predicted"
        if self.tolerance == math.inf:
            return "predicted"
        if self.inside:
            return "inside the band"
        if self.passed:
            return "within the target"
        if self.beyond:
            return "beyond this model"
        if not self.absolute and round(1e3 * abs(self.error)) == round(1e3 * self.tolerance):
            return f"outside by {100.0 * abs(self.error):.2f} %"
        return f"outside by {self.distance.lstrip('+-')}"


def compare(
    quantity: str, unit: str, measured: float, predicted: float, target: float, source: str, *,
    scatter: float = math.nan, band: tuple[float, float] | None = None, datum: str = "", beyond: str = "",
    absolute: bool = False,
) -> Comparison:  # fmt: skip
    """A measured number and its prediction. scatter: of the experiment, relative to it; or its `band` (low, high).

    Raises ValueError for a target below 0, and for a relative distance from 0.
    """
    if not target >= 0.0 or (measured == 0.0 and not absolute):
        raise ValueError(f"{quantity}: a target of 0 or more, and of nothing measured an absolute distance")
    low, high = band or (measured * (1.0 - scatter), measured * (1.0 + scatter))
    low, high = min(low, high), max(low, high)
    error = predicted - measured if absolute else predicted / measured - 1.0
    return Comparison(
        quantity, measured, predicted, error, target, source, unit=unit, low=low, high=high, datum=datum, beyond=beyond,
        absolute=absolute,
    )  # fmt: skip


def predict(quantity: str, unit: str, predicted: float, why: str) -> Comparison:
    """A prediction that nothing judges yet; `why` it is made, or what it is to be held against."""
    return Comparison(quantity, math.nan, predicted, math.nan, math.inf, why, unit=unit)


def _number(value: float) -> str:
    return f"{value:.4g}" if math.isfinite(value) else ""


def cells(name: str, row: Row) -> list[str]:
    assert isinstance(row, Comparison)
    scatter = f"{row.low:.4g} ... {row.high:.4g}" if math.isfinite(row.low) else ""
    target = "" if row.tolerance == math.inf else f"{row.tolerance:.3g} {row.unit}"
    if target and not row.absolute:
        target = f"{100.0 * row.tolerance:.3g} %"
    return [
        name, row.quantity, row.unit, _number(row.reference), scatter, _number(row.got), row.distance, target,
        row.verdict, row.reason, row.datum, row.beyond,
    ]  # fmt: skip


def _remark(row: Row) -> str:
    assert isinstance(row, Comparison)
    return row.beyond if not row.passed else ""


LAYOUT = Layout(
    columns=(
        "case",
        "quantity",
        "unit",
        "reference",
        "scatter",
        "predicted",
        "distance",
        "target",
        "verdict",
        "source",
        "datum",
        "why",
    ),  # fmt: skip
    cells=cells,
    line="{0:<12} {1:<54} {3:>9} {5:>9} {2:<6} {6:>12} {7:>8}  {8}",
    remark=_remark,
)
