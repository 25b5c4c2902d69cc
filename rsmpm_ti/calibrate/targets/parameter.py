"""A key of a data sheet that is fitted: its bounds, its scale, and the sheet with other values."""

import math
from dataclasses import dataclass, replace
from typing import Any

from rsmpm_ti.checks import annotations, unit_of
from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.sheet.data_sheet import DIRECT_OVER_BRAZILIAN, DataSheet
from rsmpm_ti.rock.sheet.reading import KEYS

WIDE = 10.0
"""Upper over lower bound from which the scale of a parameter is logarithmic."""

INSTEAD = {"UCS": "cohesion", "cohesion": "UCS", "sigma_t": "BTS", "BTS": "sigma_t", "K_Ic": "G_f", "G_f": "K_Ic"}
"""Key -> the one that says the same in its place."""

DIGITS = 6
"""Of every value that is tried: as many as a sheet's file holds, so that what is written is what was run."""


@dataclass(frozen=True, kw_only=True)
class Parameter:
    """key: of the sheet; lower, upper: bounds [SI, degrees]."""

    key: str
    lower: float
    upper: float

    @property
    def logarithmic(self) -> bool:
        return 0.0 < self.lower * WIDE <= self.upper

    @property
    def unit(self) -> str:
        """In SI, or degrees; "1" of a pure number."""
        unit = unit_of(annotations(DataSheet)[self.key])
        return "1" if unit is None else unit.name

    def at(self, place: float) -> float:
        """The value at a place in [0, 1] between the bounds [SI, degrees]."""
        if self.logarithmic:
            value = self.lower * (self.upper / self.lower) ** place
        else:
            value = self.lower + (self.upper - self.lower) * place
        return min(max(float(f"{value:.{DIGITS}g}"), self.lower), self.upper)

    def place(self, value: float) -> float:
        """The place of a value [SI, degrees]: 0 at the lower bound, 1 at the upper one, beyond them outside."""
        if self.logarithmic:
            return math.log(value / self.lower) / math.log(self.upper / self.lower) if value > 0.0 else -math.inf
        return (value - self.lower) / (self.upper - self.lower)


def own_value(sheet: DataSheet, key: str) -> float:
    """What a sheet says of a key, or what follows from it [SI, degrees].

    Raises SceneError for BTS of a rock without a kind.
    """
    if key == "BTS" and sheet.kind is None:
        ratios = ", ".join(DIRECT_OVER_BRAZILIAN)
        raise SceneError(f"BTS needs the rock's kind, {ratios}: give kind in the sheet, or fit sigma_t")
    derived = {
        "UCS": sheet.compressive_strength, "cohesion": sheet.shear_strength, "sigma_t": sheet.tensile_strength,
        "K_Ic": sheet.toughness, "G_f": sheet.tension_energy, "G_f_II": sheet.shear_energy,
        "phi_r": sheet.residual_friction, "averaging_length": sheet.length(None),
    }  # fmt: skip
    given = getattr(sheet, key)
    if given is None and key == "BTS":
        return sheet.tensile_strength / DIRECT_OVER_BRAZILIAN[sheet.kind or ""]
    return derived[key] if given is None else given


def with_values(sheet: DataSheet, values: dict[str, float], why: str = "") -> DataSheet:
    """The sheet with other values [SI, degrees], which are then estimates of this source; what said the same goes.

    Raises SceneError where the values contradict each other.
    """
    gone = {INSTEAD[key] for key in values if key in INSTEAD}
    estimated = tuple(key for key in KEYS if key in values or (key in sheet.estimated and key not in gone))
    sources = [(key, text) for key, text in sheet.sources if key not in gone | values.keys()]
    about = {"estimated": estimated, "sources": (*sources, *((key, why) for key in values if why))}
    given: dict[str, Any] = dict.fromkeys(sorted(gone), None) | values | about
    return replace(sheet, **given)
