"""Units at the scene's surface; everything inside is SI. `12 * MPa` is 12e6 Pa.

A number's dimension stands in its annotation, `flaw_length: Length`. A text with a unit, such as `--set
flaw_length=15mm`, is then read as that many metres, and one of another dimension is refused.
"""

import functools
import re
from dataclasses import dataclass
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

QUANTITY = re.compile(
    r"([-+]?[\d.]+(?:[eE][-+]?\d+)?)\s*([A-Za-zµμ°]{1,20}(?:\^?-?\d)?(?:[*/][A-Za-z]{1,20}(?:\^?-?\d)?){0,4})"
)
"""A number and its unit: `15mm`, `2.6 g/cm^3` or `2.6 g/cm3`. Nothing longer goes to pint, which would also compute
9^9^9."""

POWER = re.compile(r"([A-Za-z])(-?\d)")
"""Where pint wants a sign for a power: m2 is m^2."""


def quantity(text: str, unit: Unit, dim: int = 2) -> float | None:
    """A text such as `15 mm` as a number in a unit; None where it is no such text or of another dimension."""
    parts = QUANTITY.fullmatch(text.strip())
    if parts is None:
        return None
    registry = _registry()
    try:
        given = registry.Quantity(float(parts[1]), registry.parse_units(POWER.sub(r"\1^\2", parts[2])))
    except (AttributeError, ValueError, ArithmeticError):  # pint: no such unit; float: two points
        return None
    names = unit.name.split(" or ")  # of a unit that depends on the scene's dimension: in 2D, in 3D
    for name in names[dim - 2 :][:1] if len(names) > 1 else names:
        # the units at the root tell also degrees from pure numbers, and rad/s from Hz: both have no dimension
        if registry.get_root_units(given.units)[1] == registry.get_root_units(name)[1]:
            return float(given.to(name).magnitude)
    return None


@functools.cache
def _registry():
    from pint import UnitRegistry  # half a second, which a scene without a unit in a text need not wait for

    return UnitRegistry()
