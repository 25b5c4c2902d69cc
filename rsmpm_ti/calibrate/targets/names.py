"""What the laboratory's reports hold, known before a test is run: names of quantities, with their units."""

import re

BROKEN = {
    "failures in tension": "1", "failures in shear": "1", "fragments": "1", "acoustic events": "1",
    "work of the load": "J/m", "energy dissipated": "J/m", "energy stored at most": "J/m",
}  # fmt: skip

ENVELOPE = {"cohesion": "Pa", "friction angle": "degrees"}

BENT = {
    "K_Ic by the work of fracture": "Pa m^0.5", "K_Ic by the peak load": "Pa m^0.5", "work of fracture G_f": "J/m^2",
    "peak load": "N/m", "crack mouth opening at the peak": "m", **BROKEN,
}  # fmt: skip

QUANTITIES = {
    "ucs": {
        "UCS": "Pa", "E tangent": "Pa", "E secant": "Pa", "E average": "Pa", "Poisson's ratio": "1",
        "crack initiation stress": "Pa", "first loss of strength": "Pa", "crack damage stress": "Pa",
        "axial strain at the peak": "1", **BROKEN,
    },
    "brazilian": {
        "BTS": "Pa", "BTS less the arc's part": "Pa", "BTS at the first failure": "Pa",
        "place of the first failure": "1", **BROKEN,
    },
    "tension": {"tensile strength": "Pa", "E in tension": "Pa", **BROKEN},
    "triaxial": ENVELOPE,
    "shear": ENVELOPE,
    "bend": {
        "K_Ic by the effective crack": "Pa m^0.5", "effective crack": "m", "nominal strength": "Pa", **BENT,
    },
    "scb": BENT,
}  # fmt: skip
"""Test -> name -> unit; `crack closure stress` is left out, as the model's rock has none."""

AT = {
    "triaxial": ("peak", "residual"),
    "shear": ("peak shear stress", "residual shear stress"),
}
"""Test at pressures -> what it reports at each, as `peak at 10 MPa`."""

CURVES = ("ucs", "tension")
"""Tests whose curve of stress against strain may be a target."""

NUMBERED = re.compile(r"(.{1,40}) at (\d{1,5}(?:\.\d{1,4})?) MPa")


def pressure_in(test: str, name: str) -> float | None:
    """The pressure of a name such as `peak at 10 MPa` [Pa]; None of other names, and of those that no report has."""
    parts = NUMBERED.fullmatch(name)
    if parts is None or parts[1] not in AT.get(test, ()):
        return None
    pressure = float(parts[2]) * 1e6
    return pressure if name == name_at(parts[1], pressure) and (pressure > 0.0 or parts[1] == "peak") else None


def name_at(what: str, pressure: float) -> str:
    """As the report writes it; pressure [Pa]."""
    return f"{what} at {1e-6 * pressure:g} MPa"


def unit_of_name(test: str, name: str) -> str | None:
    """None where a report has no such quantity."""
    return "Pa" if pressure_in(test, name) is not None else QUANTITIES[test].get(name)
