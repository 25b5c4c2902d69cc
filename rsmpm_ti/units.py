"""Units at the scene's surface; everything inside is SI. `12 * MPa` is 12e6 Pa.

A number's dimension stands in its annotation, `flaw_length: Length`. A text with a unit, such as `--set
flaw_length=15mm`, is then read as that many metres, and one of another dimension is refused.
"""

import functools
import re
from dataclasses import dataclass
from decimal import Decimal
from typing import Annotated

GPa = 1e9
MPa = 1e6
kPa = 1e3
cm = 1e-2
mm = 1e-3
ms = 1e-3
us = 1e-6


@dataclass(frozen=True)
class Unit:
    """The unit in which a field holds its number, by a name that pint knows; `m or m^2` where the dimension of the
    scene decides."""

    name: str

    def __get_pydantic_json_schema__(self, schema, handler) -> dict:
        return handler(schema) | {"description": f"[{self.name}]"}


Length = Annotated[float, Unit("m")]
LengthOrArea = Annotated[float, Unit("m or m^2")]
AreaOrVolume = Annotated[float, Unit("m^2 or m^3")]
Angle = Annotated[float, Unit("degrees")]
Time = Annotated[float, Unit("s")]
Velocity = Annotated[float, Unit("m/s")]
Acceleration = Annotated[float, Unit("m/s^2")]
Spin = Annotated[float, Unit("rad/s")]
Pressure = Annotated[float, Unit("Pa")]
ForceOrLineLoad = Annotated[float, Unit("N/m or N")]
Density = Annotated[float, Unit("kg/m^3")]
FractureEnergy = Annotated[float, Unit("J/m^2")]
Toughness = Annotated[float, Unit("Pa*m^0.5")]

QUANTITY = re.compile(
    r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*"
    r"([A-Za-zµμ°]{1,20}(?:\^?-?\d(?:\.5)?)?(?:(?:[*/]|\s)[A-Za-z]{1,20}(?:\^?-?\d(?:\.5)?)?){0,4})"
)
"""A number and its unit: `15mm`, `2.6 g/cm^3`, `2.6 g/cm3` or `2600 kg m^-3`. Nothing longer goes to pint, which would
also compute 9^9^9."""

ROOT = re.compile(r"[*\s]{0,3}(?:√|sqrt) ?\(?(mm|m)\)?")
HALVES = re.compile(r"\^?\(?(-?[13])/2\)?")
"""Other spellings of a power that is a half: `MPa sqrt(m)`, `MPa√m`, `MPa m^(1/2)`, `MN m^-3/2`."""

POWER = re.compile(r"([A-Za-z])(-?\d)")
"""Where pint wants a sign for a power: m2 is m^2."""


PERCENTAGE = re.compile(r"([-+]?(?:\d{1,20}\.?\d{0,20}|\.\d{1,20}))\s*%")

LEAST_PRESSURE = 1e3
"""No stress of rock is smaller [Pa]: a number below it is one in MPa that lost its unit."""

COMMON = {
    "m": "mm cm um m km in",
    "m^2": "mm^2 cm^2 m^2",
    "m^3": "mm^3 cm^3 m^3",
    "degrees": "deg degrees rad",
    "s": "us ms s min h",
    "m/s": "mm/s m/s mm/min",
    "m/s^2": "mm/s^2 m/s^2",
    "rad/s": "deg/s rad/s",
    "Pa": "MPa GPa kPa Pa bar psi",
    "N/m": "kN/m MN/m N/m N/mm",
    "N": "kN MN N",
    "kg/m^3": "kg/m^3 g/cm^3",
    "J/m^2": "J/m^2 kJ/m^2 N/m N/mm",
    "Pa*m^0.5": "MPa*m^0.5 kPa*m^0.5 MN/m^1.5 N/mm^1.5",
}
"""Unit of a field -> what is typed for it. Another spelling in capitals and small letters is none of pint's, such as
mpa, or one that no laboratory has, such as mPa and Mm."""


def quantity(text: str, unit: Unit, dim: int = 2) -> float | None:
    """A text such as `15 mm` as a number in a unit; None where it is no such text, of another dimension, or a common
    unit but for capital letters."""
    parts = QUANTITY.fullmatch(_spelled(text))
    if parts is None or _meant(parts[2], unit, dim):
        return None
    registry = _registry()
    try:
        given = registry.Quantity(float(parts[1]), registry.parse_units(_product(parts[2])))
        for name in _names(unit, dim):
            # the units at the root tell also degrees from pure numbers, and rad/s from Hz: both have no dimension
            if registry.get_root_units(given.units)[1] == registry.get_root_units(name)[1]:
                return float(given.to(name).magnitude)
    # pint: no such unit, k^0, a decibel, a millidegree Celsius; float: two points
    except (AttributeError, KeyError, TypeError, ValueError, ArithmeticError):
        return None
    return None


def percentage(text: str) -> float | None:
    """A text such as `0.35%` as a pure number, 0.0035; None where it is no such text."""
    parts = PERCENTAGE.fullmatch(text.strip())
    return None if parts is None else float(Decimal(parts[1]).scaleb(-2))


def advice(text: str, unit: Unit | None, dim: int = 2) -> str:
    """What to type in place of a number with a unit that a field does not take; "" for any other text. unit: of the
    field, None for a pure number."""
    parts = QUANTITY.fullmatch(_spelled(text))
    if unit is None:
        return "it has no unit" if parts else ""
    if parts is None:
        return f"give its unit, such as {_common(unit, dim)[0]}" if PERCENTAGE.fullmatch(text.strip()) else ""
    if meant := _meant(parts[2], unit, dim):
        return f"capital letters count: did you mean '{parts[1]} {meant}'?"
    return f"its units are {', '.join(_common(unit, dim))}, and others of that dimension"


def _spelled(text: str) -> str:
    """A text with its roots as powers: `1.8 MPa√m` is `1.8 MPa*m^0.5`."""
    text = ROOT.sub(r"*\1^0.5", text.strip().replace("·", "*").replace("**", "^"))
    return HALVES.sub(lambda power: f"^{int(power[1]) / 2}", text)


def _product(word: str) -> str:
    """A unit as pint reads it: `kg m-3` is `kg*m^-3`."""
    return POWER.sub(r"\1^\2", re.sub(r"\s", "*", word))


def _names(unit: Unit, dim: int) -> list[str]:
    """Of a unit that depends on the scene's dimension (in 2D, in 3D) the one."""
    names = unit.name.split(" or ")
    return names[dim - 2 :][:1] if len(names) > 1 else names


def _common(unit: Unit, dim: int) -> list[str]:
    return [word for name in _names(unit, dim) for word in COMMON.get(name, name).split()]


def _meant(word: str, unit: Unit, dim: int) -> str:
    """The common unit that a word would be but for capital letters; "" where it is one as it stands, or none."""
    word = _product(word)
    common = _common(unit, dim)
    return "" if word in common else next((name for name in common if name.lower() == word.lower()), "")


@functools.cache
def _registry():
    from pint import UnitRegistry  # half a second, which a scene without a unit in a text need not wait for

    return UnitRegistry()
