"""TARGETS.toml: what is fitted, to what, and for how long; each mistake is one line before anything runs.

A file is data: nothing of it is executed. `[parameters]` holds bounds of keys of the sheet, `[targets]` measured
quantities by test and name, `[confinements]` pressures of triaxial and shear, `[budget]` runs and seeds.
"""

import difflib
import math
from pathlib import Path

from rsmpm_ti.calibrate.targets.curve_file import read_curve
from rsmpm_ti.calibrate.targets.measured import Curve, Number, Wanted
from rsmpm_ti.calibrate.targets.names import AT, CURVES, QUANTITIES, name_at, pressure_in, unit_of_name
from rsmpm_ti.calibrate.targets.parameter import INSTEAD, Parameter
from rsmpm_ti.errors import SceneError, refuse, short, shown
from rsmpm_ti.rock.sheet.reading import KEYS, displayed, meant_key, value_of
from rsmpm_ti.rock.sheet.toml_file import tables_of
from rsmpm_ti.units import Unit, advice, percentage, quantity

TABLES = ("parameters", "targets", "confinements", "budget")
WORDS = ("kind", "law", "softening")
"""Keys of a sheet that are no numbers."""

RUNS, MOST_RUNS, MOST_SEEDS = 40, 10_000, 20
MOST_PARAMETERS, MOST_TARGETS, MOST_PRESSURES = 6, 40, 10

ASSUMED = 0.05
"""Error of a target that gives none, over its value."""

NEAREST = 1.01
"""Upper over lower bound: closer ones leave nothing to fit."""

PINT = {"Pa m^0.5": "Pa*m^0.5"}
"""Unit of a report -> as pint writes it, where that is another."""


def read_wanted(path: Path) -> Wanted:
    """The calibration that a file asks for. Raises SceneError, which names the file, the key and the allowed range."""
    try:
        return _wanted(tables_of(path, "file of targets", "give a .toml file", 'E = ["20 GPa", "60 GPa"]'), path.parent)
    except SceneError as error:
        raise SceneError(f"{short(str(path))}: {error}") from None


def _wanted(file: dict, folder: Path) -> Wanted:
    for key, value in file.items():
        if key not in TABLES:
            raise SceneError(f"it has no place for {shown(key)}: it holds {_listed(TABLES)}{_near(key, TABLES)}")
        _table(key, value)
    parameters = _parameters(file.get("parameters", {}))
    targets = tuple(_target(test, name, given, folder) for test, name, given in _named(file.get("targets", {})))
    if not targets:
        raise SceneError('[targets] is missing or empty; give one, such as ucs.UCS = { value = "160 MPa" }')
    if len(targets) > MOST_TARGETS:
        raise refuse("targets", len(targets), f"at most {MOST_TARGETS} of them")
    runs, seeds = _budget(file.get("budget", {}), len(parameters))
    pressures = _confinements(file.get("confinements", {}), targets)
    return Wanted(parameters=parameters, targets=targets, confinements=pressures, runs=runs, seeds=seeds)


def _table(key: str, value: object) -> dict:
    if not isinstance(value, dict):
        raise refuse(key, value, f"a table, [{key}] in a line of its own")
    return value


def _listed(names) -> str:
    return ", ".join(names)


def _near(name: object, names) -> str:
    small = {known.lower(): known for known in names}
    close = difflib.get_close_matches(str(name)[:100].lower(), small, n=1)
    return f"; did you mean {small[close[0]]}?" if close else ""


def _only(where: str, given: dict, keys: tuple[str, ...]) -> None:
    for key in given:
        if key not in keys:
            raise SceneError(f"{where} has no {shown(key)}; it has {_listed(keys)}{_near(key, keys)}")


def _parameters(given: dict) -> tuple[Parameter, ...]:
    numbers = [key for key in KEYS if key not in WORDS]
    for key in given:
        if key not in numbers:
            meant = meant_key(key)
            hint = f"; did you mean {meant}?" if meant in numbers else ""
            raise SceneError(f"[parameters] has {shown(key)}, which is none of {_listed(numbers)}{hint}")
        if INSTEAD.get(key) in given:
            raise SceneError(f"[parameters] has {key} and {INSTEAD[key]}, which say the same; leave one out")
    if not 1 <= len(given) <= MOST_PARAMETERS:
        raise refuse("parameters", len(given), f"1 to {MOST_PARAMETERS} keys of the sheet with their bounds")
    return tuple(_parameter(key, bounds) for key, bounds in given.items())


def _parameter(key: str, bounds: object) -> Parameter:
    field = f"parameters.{key}"
    if not isinstance(bounds, list) or len(bounds) != 2:
        raise refuse(field, bounds, "a lower and an upper bound", f'such as {key} = ["...", "..."]')
    try:
        lower, upper = (value_of(key, bound, bare=False) for bound in bounds)
    except SceneError as error:
        raise SceneError(f"[parameters] {error}") from None
    if upper < max(lower * NEAREST, lower + 1e-9):
        allowed = f"a lower bound and an upper one, {100.0 * (NEAREST - 1.0):.0f} % above it or more"
        raise refuse(field, bounds, allowed, "are they exchanged?" if upper < lower else "")
    return Parameter(key=key, lower=lower, upper=upper)


def _named(given: dict):
    """(test, name, what is given) of every target."""
    for test, names in given.items():
        if test not in QUANTITIES:
            raise SceneError(
                f"[targets] has {shown(test)}, which is no test; the tests are {_listed(QUANTITIES)}"
                f"{_near(test, QUANTITIES)}"
            )
        if not isinstance(names, dict):
            raise refuse(f"targets.{test}", names, f'a quantity of the test, {test}.NAME = {{ value = "..." }}')
        for name, value in names.items():
            yield test, name, value


def _target(test: str, name: str, given: object, folder: Path) -> Number | Curve:
    field = f"targets.{test}.{short(name)}"
    curve = name == "curve"
    if curve and test not in CURVES:
        raise SceneError(f"{field}: curves are compared for {_listed(CURVES)} only")
    unit = "Pa" if curve else unit_of_name(test, name)
    if unit is None:
        every = [*QUANTITIES[test], *(name_at(what, 10e6) for what in AT.get(test, ())),
                 *(["curve"] if test in CURVES else [])]  # fmt: skip
        raise SceneError(f"{test} reports no {shown(name)}; it reports {_listed(every)}{_near(name, every)}")
    key = "file" if curve else "value"
    if not isinstance(given, dict):
        raise refuse(field, given, f'{{ {key} = "...", error = "..." }}')
    _only(field, given, (key, "error"))
    if key not in given:
        raise SceneError(f"{field} has no {key}")
    if curve:
        strain, stress = read_curve(given["file"], folder, f"{field}.file")
        value = float(stress.max())
    else:
        value = _number(f"{field}.value", given["value"], unit)
    error = _error(f"{field}.error", given["error"], unit, value) if "error" in given else ASSUMED * value
    assumed = "error" not in given
    if curve:
        file = str(given["file"])
        return Curve(test=test, file=file, strain=strain, stress=stress, error=error, assumed=assumed)
    return Number(test=test, name=name, unit=unit, value=value, error=error, assumed=assumed)


def _number(field: str, given: object, unit: str, example: str = "") -> float:
    """A positive number [unit of the report] from a text with its unit; a pure one also without quotes."""
    pint = None if unit == "1" else Unit(PINT.get(unit, unit))
    value: float | None = None
    if pint is not None and isinstance(given, str):
        value = quantity(given, pint)
    elif pint is None and not isinstance(given, bool) and isinstance(given, int | float | str):
        try:
            value = percentage(given) if isinstance(given, str) and "%" in given else float(given)
        except (ValueError, OverflowError):
            value = None
    if value is None or not math.isfinite(value) or not 1e-12 < value < 1e15:
        allowed = f"a positive number{'' if pint is None else ' with its unit'}{example}"
        raise refuse(field, given, allowed, advice(given, pint) if isinstance(given, str) else "")
    return value


def _error(field: str, given: object, unit: str, value: float) -> float:
    """One standard deviation [unit of the report], also from a percentage of the value."""
    share = percentage(given) if isinstance(given, str) and "%" in given else None
    error = share * value if share is not None else _number(field, given, unit, ", or a percentage")
    if not 1e-6 * value <= error <= 10.0 * value:
        raise refuse(field, given, "from a millionth of the value to ten times as large", "it is a standard deviation")
    return error


def _budget(given: dict, parameters: int) -> tuple[int, int]:
    _only("[budget]", given, ("runs", "seeds"))
    least = 2 * parameters + 2
    why = f"{parameters} parameters need the start, a step, and a difference by each for both"
    runs = _whole("budget.runs", given.get("runs", max(RUNS, least)), least, MOST_RUNS, why)
    return runs, _whole("budget.seeds", given.get("seeds", 1), 1, MOST_SEEDS, "")


def _whole(field: str, value: object, least: int, most: int, remedy: str) -> int:
    if isinstance(value, int) and not isinstance(value, bool) and least <= value <= most:
        return value
    raise refuse(field, value, f"a whole number from {least} to {most}", remedy)


def _confinements(given: dict, targets) -> dict[str, tuple[float, ...]]:
    """Test -> pressures [Pa]: as listed, else those that the targets' names hold."""
    used = {test: sorted({pressure for target in targets if target.test == test
                          and (pressure := pressure_in(test, target.name)) is not None}) for test in AT}  # fmt: skip
    _only("[confinements]", given, tuple(AT))
    found = {}
    for test, named in used.items():
        if not any(target.test == test for target in targets):
            if test in given:
                raise SceneError(f"[confinements] has {test}, and no target needs that test")
            continue
        pressures = _pressures(f"confinements.{test}", given[test]) if test in given else tuple(named)
        for pressure in named:
            if not any(math.isclose(pressure, other) for other in pressures):
                raise refuse(f"confinements.{test}", given[test], f"a list with {1e-6 * pressure:g} MPa too",
                             "a target is measured there")  # fmt: skip
        if pressures:
            found[test] = pressures
        lines = [t.label for t in targets if t.test == test and pressure_in(test, t.name) is None]
        if lines and 0 < len(pressures) < 2:
            raise SceneError(f"{lines[0]} is of a line through peaks at two pressures or more; list them in "
                             f'[confinements], {test} = ["0 MPa", "10 MPa"]')  # fmt: skip
    return found


def _pressures(field: str, given: object) -> tuple[float, ...]:
    if not isinstance(given, list) or not 1 <= len(given) <= MOST_PRESSURES:
        raise refuse(field, given, f"a list of 1 to {MOST_PRESSURES} pressures")
    found = []
    for text in given:
        value = quantity(text, Unit("Pa")) if isinstance(text, str) else None
        if value is None or not (value == 0.0 or 1e3 <= value <= 1e10):
            raise refuse(field, text, "pressures of 0 MPa, or 1 kPa to 10 GPa")
        found.append(value)
    if len(set(found)) < len(found):
        raise refuse(field, given, "pressures that differ")
    return tuple(found)


def described(parameter: Parameter) -> str:
    """`E 20 GPa to 60 GPa`."""
    lower, upper = (displayed(parameter.key, bound) for bound in (parameter.lower, parameter.upper))
    return f"{parameter.key} {lower} to {upper}{', on a scale of factors' * parameter.logarithmic}"
