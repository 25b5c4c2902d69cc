"""A data sheet from keywords or from a TOML file, with units written out; each mistake is one line.

A file is data: nothing of it is executed. It holds texts with units in the tables `[rock]`, what the source gives, and
`[estimated]`, what it does not; `[sources]` says by key where a value is from, or why it was estimated so.
"""

import contextlib
import dataclasses
import difflib
import math
import warnings
from pathlib import Path

from annotated_types import Interval

from rsmpm_ti.checks import annotations, phrase, remedy, unit_of, within
from rsmpm_ti.errors import RockWarning, SceneError, refuse, short, shown
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.toml_file import tables_of
from rsmpm_ti.units import Unit, advice, percentage, quantity

SHELF, EXAMPLE = "give a .toml file, or a name of the shelf", 'E = "55 GPa"'

ABOUT = ("name", "source", "estimated", "sources")
"""Fields of a sheet that are no property of the rock."""

KEYS = tuple(field.name for field in dataclasses.fields(DataSheet) if field.name not in ABOUT)
NEEDED = ("density", "E", "nu", "phi")

OTHER_NAMES = {
    "young": "E", "youngs_modulus": "E", "modulus": "E", "poisson": "nu", "poissons_ratio": "nu", "rho": "density",
    "c": "cohesion", "friction_angle": "phi", "friction": "phi", "tensile_strength": "sigma_t", "f_t": "sigma_t",
    "ft": "sigma_t", "sigma_c": "UCS", "compressive_strength": "UCS", "ucs_mpa": "UCS", "brazilian": "BTS",
    "brazilian_strength": "BTS", "toughness": "K_Ic", "kic": "K_Ic", "k_1c": "K_Ic", "g_f_i": "G_f", "g_ic": "G_f",
    "g_iic": "G_f_II", "residual_friction_angle": "phi_r", "length": "averaging_length", "type": "kind",
}  # fmt: skip
"""What else a value is called, in small letters -> its key."""

DISPLAYED = {
    "Pa": ("MPa", 1e6), "kg/m^3": ("kg/m^3", 1.0), "degrees": ("deg", 1.0), "J/m^2": ("J/m^2", 1.0), "m": ("mm", 1e-3),
    "Pa*m^0.5": ("MPa*m^0.5", 1e6),
}  # fmt: skip
"""SI unit -> the one of laboratories, with its size."""

MISTAKEN = (1e3, 1e6, 1e9, 180.0 / math.pi)
"""Factors between units that are taken for each other."""


def displayed(key: str, value: float) -> str:
    """A value of a sheet [SI] in the unit of laboratories: `55 GPa`."""
    unit = unit_of(annotations(DataSheet)[key])
    name, size = ("", 1.0) if unit is None else ("GPa", 1e9) if key == "E" else DISPLAYED[unit.name]
    return f"{value / size:.6g} {name}".strip()


def from_keywords(**given: object) -> DataSheet:
    """A sheet of numbers [SI, degrees], or of texts with units. Raises SceneError."""
    about = {name: given.pop(name) for name in ABOUT if name in given}
    return DataSheet(**about, **_values(given, bare=True))


def read_sheet(path: str | Path) -> DataSheet:
    """The sheet that a TOML file holds. Raises SceneError, which names the file and the key."""
    try:
        return _sheet(tables_of(Path(path), "data sheet", SHELF, EXAMPLE), Path(path).stem)
    except SceneError as error:
        raise SceneError(f"{short(str(path))}: {error}") from None


def warn_of(sheet: DataSheet, dx: float | None) -> None:
    """Say by Python's warnings what is hard to believe in a sheet."""
    for said in sheet.doubts(dx):
        warnings.warn(said, RockWarning, stacklevel=3)


def _sheet(file: dict, stem: str) -> DataSheet:
    for key, value in file.items():
        if key in ("rock", "estimated", "sources"):
            if not isinstance(value, dict):
                raise refuse(key, value, f"a table, [{key}] in a line of its own")
        elif key in ("name", "source"):
            if not (isinstance(value, str) and value.strip() and value.isprintable() and len(value) <= 500):
                raise refuse(key, value, "a text of one line")
        else:
            tables = "name, source, [rock], [estimated] and [sources]"
            hint = f"; {key} belongs in [rock]" if meant_key(key) else ""
            raise SceneError(f"it has no place for {shown(key)}: a sheet holds {tables}{hint}")
    measured, estimated = file.get("rock", {}), file.get("estimated", {})
    if twice := sorted(measured.keys() & estimated.keys()):
        raise SceneError(f"{', '.join(twice)} is in [rock] and in [estimated]; leave it in one of them")
    values = _values(measured | estimated, bare=False)
    sources = file.get("sources", {})
    for key, text in sources.items():
        if key not in measured | estimated:
            raise SceneError(f"[sources] has {shown(key)}, which is no key of [rock] or [estimated]")
        if not isinstance(text, str):
            raise refuse(f"sources.{key}", text, "a text")
    return DataSheet(
        name=file.get("name", stem)[:60] or "rock", source=file.get("source", ""), estimated=tuple(estimated),
        sources=tuple(sources.items()), **values,
    )  # fmt: skip


def _values(given: dict, *, bare: bool) -> dict[str, object]:
    """Numbers and words of a sheet, each within its range; bare: whether a number without a unit is one in SI."""
    for key in given:
        if key not in KEYS:
            meant = meant_key(key)
            raise SceneError(
                f"a sheet has no {shown(key)}; it has {', '.join(KEYS)}{meant and f'; did you mean {meant}?'}"
            )
    if missing := [key for key in NEEDED if given.get(key) is None]:
        remedy = "" if bare else "; what your source lacks stands in [estimated]"
        raise SceneError(f"{', '.join(missing)} {'is' if len(missing) == 1 else 'are'} missing{remedy}")
    return {key: value_of(key, value, bare=bare) for key, value in given.items() if value is not None}


def meant_key(key: str) -> str:
    """The key that another name stands for; "" where none is near."""
    small = {name.lower(): name for name in KEYS}
    word = str(key)[:100].lower().replace(" ", "_").replace("-", "_").replace("'", "")
    found = small.get(word) or OTHER_NAMES.get(word) or small.get(word.replace("_", ""))
    near = difflib.get_close_matches(word, [*small, *OTHER_NAMES], n=1)
    return found or (small.get(near[0]) or OTHER_NAMES[near[0]] if near else "")


def value_of(key: str, value: object, *, bare: bool):
    """The number [SI, degrees] or the word of a key; bare: as in `_values`. Raises SceneError, also out of range."""
    wanted = annotations(DataSheet)[key]
    bounds = next((part for part in within(wanted) if isinstance(part, Interval)), None)
    if bounds is None:  # a word
        allowed = phrase(wanted).removesuffix(" or none")
        if isinstance(value, str) and repr(value) in allowed.replace(" or ", ", ").split(", "):
            return value
        raise refuse(key, value, allowed)
    unit = unit_of(wanted)
    low, high = displayed(key, bounds.ge), displayed(key, bounds.le)
    allowed = f"{low} to {high}" if unit else f"a number from {low} to {high}"
    number = _number(value, unit, bare=bare)
    if number is None:
        raise refuse(key, value, allowed, _unit_advice(key, value, unit))
    if bounds.ge <= number <= bounds.le:
        return number
    near = next((number * f for f in MISTAKEN if unit and bounds.ge <= number * f <= bounds.le), None)
    given = value if isinstance(value, str) else displayed(key, number)
    raise refuse(key, given, allowed, remedy(wanted) if near is None else f"did you mean {displayed(key, near)}?")


def _number(value: object, unit: Unit | None, *, bare: bool) -> float | None:
    """None where a value is no number that may stand there."""
    if isinstance(value, str):
        if unit is not None:
            return quantity(value, unit)
        with contextlib.suppress(ValueError):
            return percentage(value) if "%" in value else float(value)
        return None
    plain = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < 1e300
    return float(value) if plain and (bare or unit is None) else None  # type: ignore[arg-type]


def _unit_advice(key: str, value: object, unit: Unit | None) -> str:
    if unit is None:
        return advice(value, None) if isinstance(value, str) else ""
    said = advice(value, unit) if isinstance(value, str) else ""
    example = {"E": "55 GPa", "density": "2650 kg/m^3", "phi": "45 deg", "phi_r": "30 deg", "K_Ic": "1.2 MPa*m^0.5"}
    return said or f'give a number with its unit, {key} = "{example.get(key, "10 " + DISPLAYED[unit.name][0])}"'
