"""A number that a test reports, and its mean over specimens of different seeds."""

import math
from dataclasses import dataclass, replace

import numpy as np

SCALES = {"Pa": (1e6, "MPa"), "Pa m^0.5": (1e6, "MPa m^0.5"), "m": (1e-3, "mm"), "N/m": (1e3, "kN/m")}
"""Unit -> what it is shown in, and by which it is divided."""


@dataclass(frozen=True, kw_only=True)
class Quantity:
    """name: as the standard has it; value [unit], NaN where it is not defined; about: how it is read.

    given: what the rock's own sheet says of it, NaN where it says nothing. error: half of the width of its 95 %
    confidence interval, NaN where there is none. values: of each seed.
    """

    name: str
    unit: str
    value: float
    about: str
    given: float = math.nan
    error: float = math.nan
    values: tuple[float, ...] = ()

    def shown(self) -> tuple[str, str]:
        """Value with its error, and unit, as a table shows them."""
        scale, unit = SCALES.get(self.unit, (1.0, self.unit))
        if abs(self.value) >= 1e9 and self.unit == "Pa":
            scale, unit = 1e9, "GPa"
        if math.isnan(self.value):
            return "not defined", ""
        error = "" if math.isnan(self.error) else f" ± {self.error / scale:.2g}"
        return f"{self.value / scale:.4g}{error}", "" if unit == "1" else unit


def over_seeds(found: list[list[Quantity]]) -> list[Quantity]:
    """Quantities of every seed -> their means, each with the 95 % interval of Student's t.

    With one seed they stay as they are: a fit's own error is then the error.
    """
    if len(found) == 1:
        return [replace(quantity, values=(quantity.value,)) for quantity in found[0]]
    return [_mean(list(same)) for same in zip(*found, strict=True)]


def _mean(same: list[Quantity]) -> Quantity:
    from scipy.stats import t

    values = np.array([quantity.value for quantity in same])
    known = values[np.isfinite(values)]
    value = float(known.mean()) if len(known) else math.nan
    error = math.nan
    if len(known) > 1:
        error = float(t.ppf(0.975, len(known) - 1) * known.std(ddof=1) / math.sqrt(len(known)))
    return replace(same[0], value=value, error=error, values=tuple(values.tolist()))
