"""Scene data is checked here, once, against its annotations: constructors, recorded JSON and the command line alike.

A class of scene data is a frozen dataclass under `@checked(name)`. Pydantic holds its fields to their annotations when
an object is built: `Annotated[Pressure, Positive]` is a number in pascals within a range. What concerns several fields
stays in `__post_init__`. `refusal` turns pydantic's errors into the one line in which everything is refused.
"""

import dataclasses
import functools
import types
import typing
from collections.abc import Callable

import numpy as np
from annotated_types import Interval, Len
from pydantic import ConfigDict, TypeAdapter, ValidationError
from pydantic_core import ArgsKwargs, PydanticCustomError, core_schema

from rsmpm_ti.errors import SceneError, refuse, shown
from rsmpm_ti.units import LEAST_PRESSURE, Length, Unit

MIN_POSITIVE, MAX_SIZE = 1e-12, 1e18
"""Of what must be positive, in SI units: far beyond any specimen, and squares and ratios of such numbers are finite."""

Positive = Interval(ge=MIN_POSITIVE, le=MAX_SIZE)
NotNegative = Interval(ge=0.0, le=MAX_SIZE)
Finite = Interval(ge=-MAX_SIZE, le=MAX_SIZE)
Seed = typing.Annotated[int, Interval(ge=0, le=2**63 - 1)]
"""A random seed that every record can hold."""

MAX_COORDINATE = 1e9
"""Largest coordinate and length [m]: beyond it a specimen is a mistake, and squares and node numbers overflow."""

Coordinate = typing.Annotated[Length, Interval(ge=-MAX_COORDINATE, le=MAX_COORDINATE)]
Position = typing.Annotated[tuple[Coordinate, ...], Len(2, 3)]
Size = typing.Annotated[Length, Interval(ge=MIN_POSITIVE, le=MAX_COORDINATE)]

STRICT = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)
"""No text is a number, no unknown keyword passes; an integer will do for a number, a bool will not."""

RENAMED = {"Rock": {"averaging": "nonlocal_mean"}, "Nonlocal": {"shade": "exclusion"}}
"""Fields of recorded scenes that have another name today, by class: records of before still load."""

RETIRED = {"Nonlocal": {"wedge"}}
"""Fields of recorded scenes that say nothing today, by class."""

KNOWN: dict[str, type] = {}
"""Every class that a recorded scene may name: those of this package under `checked`."""

OWN = ("rsmpm_ti.rock.", "rsmpm_ti.method.", "rsmpm_ti.spec.")
"""Rooms of scene data: their classes stand in for no others."""

Kind = typing.TypeVar("Kind")

WORDS = {float: "a number", int: "an integer", bool: "true or false", str: "a text", types.NoneType: "none"}


@dataclasses.dataclass(frozen=True)
class Remedy:
    """In the annotation of a field: how its refusal ends, after the semicolon."""

    text: str


def checked(owner: str, *, recorded: bool = True) -> Callable[[type[Kind]], type[Kind]]:
    """Decorator of a keyword-only dataclass: its objects are checked when they are built. `owner` stands before the
    dot in refusals; recorded: whether a recorded scene may name it."""

    def decorate(kind):
        @functools.wraps(kind.__init__)
        def __init__(self, **values):
            values = {name: native(value) for name, value in values.items()}
            try:
                adapter(kind).validator.validate_python(ArgsKwargs((), values), self_instance=self)
            except ValidationError as error:
                raise refusal(owner, kind, values, error) from None

        def __init_subclass__(cls, **_):
            raise TypeError(
                f"{kind.__name__} is final, as an heir would not be checked: wrap it, or write a class apart"
            )

        kind.__init__ = __init__
        kind.__init_subclass__ = classmethod(__init_subclass__)
        kind.__pydantic_config__ = STRICT
        kind.__get_pydantic_core_schema__ = classmethod(_schema_with_type)
        kind.__get_pydantic_json_schema__ = classmethod(_json_schema_with_type)
        if recorded and kind.__module__.startswith(OWN):
            KNOWN[kind.__name__] = kind
        return kind

    return decorate


def native(value):
    """Scalars of NumPy as Python's own, also in tuples: pydantic takes a bool of NumPy for a number."""
    if isinstance(value, tuple):
        return tuple(map(native, value)) if any(isinstance(v, np.generic) for v in value) else value
    return value.item() if isinstance(value, np.generic) else value


adapter = functools.cache(TypeAdapter)
"""Of a class, made on first use: schemas of classes that a scene does not use are never built."""


def _schema_with_type(kind: type, source, handler):
    """Pydantic's schema of a class, which also reads what `to_plain` writes: a dict that names the class as "type"."""

    def fields_of(value):
        if not isinstance(value, dict):
            return value
        if value.get("type") != kind.__name__:
            raise PydanticCustomError("other_type", "another type")
        names, gone = RENAMED.get(kind.__name__, {}), {"type", *RETIRED.get(kind.__name__, ())}
        return {names.get(key, key): field for key, field in value.items() if key not in gone}

    schema = dict(handler.resolve_ref_schema(handler(source)))
    schema["strict"] = False  # of a dataclass: its fields stay strict, but a dict may stand for it
    # the name under which other schemas refer to the class is given to the whole, so that they too read "type"
    return core_schema.no_info_before_validator_function(fields_of, schema, ref=schema.pop("ref"))


def _json_schema_with_type(kind: type, schema, handler) -> dict:
    described = handler(schema)
    inner = handler.resolve_ref_schema(described)
    inner["properties"] = {"type": {"const": kind.__name__}, **inner.get("properties", {})}
    needed = [name for name in inner.get("required", []) if name != "type"]  # pydantic 2.8 asks twice for one class
    inner["required"] = ["type", *needed]
    for name, field in inner["properties"].items():
        if dataclasses.is_dataclass(getattr(kind, name, None)):  # a default, which pydantic writes without its class
            field["default"]["type"] = type(getattr(kind, name)).__name__
    return described


class ByType:
    """In the annotation of a field: its class is chosen by the object's, in JSON by "type". An object of a class from
    outside, as a scene file may bring, will do if it has what all alternatives have in common."""

    @staticmethod
    def __get_pydantic_core_schema__(source, handler):
        kinds = {kind.__name__: kind for kind in members(source)}
        names = frozenset.intersection(*(frozenset(n for n in dir(k) if n[0] != "_") for k in kinds.values()))

        def stands_in(value, inner):
            own = isinstance(value, type) or type(value).__module__.startswith((*OWN, "builtins"))
            return value if not own and all(hasattr(value, name) for name in names) else inner(value)

        def name_of(value):
            return value.get("type") if isinstance(value, dict) else type(value).__name__

        choices = {name: handler.generate_schema(kind) for name, kind in kinds.items()}
        return core_schema.no_info_wrap_validator_function(stands_in, core_schema.tagged_union_schema(choices, name_of))


@functools.cache
def annotations(kind: type) -> dict:
    """Field -> annotation, with its range, unit and remedy."""
    return typing.get_type_hints(kind, include_extras=True)


def refusal(owner: str, kind: type, values, error: ValidationError) -> SceneError:
    """The first of pydantic's errors in our one line, an unknown keyword before all others: it is often why one is
    missing. `values`: what was to become an object of a class."""
    problems = error.errors(include_url=False)
    first = next((problem for problem in problems if problem["type"] == UNKNOWN), problems[0])
    position, field, wanted, value = owner, (owner, values), kind, values
    for step in first["loc"]:  # names, indices, and the alternatives that pydantic tried, which are no place
        if isinstance(value, dict) and step in annotations(kind):
            position, wanted, value = f"{position}.{step}", annotations(kind)[step], value.get(step)
            field = (position, value)
        elif isinstance(step, int) and isinstance(value, tuple) and step < len(value):
            position, value = f"{position}[{step}]", value[step]  # of numbers the whole tuple is shown: `field` stays
        if isinstance(value, dict):
            kind = KNOWN.get(str(value.get("type")), kind)
    last = first["loc"][-1] if first["loc"] else None
    alike = [
        str(p["loc"][-1])
        for p in problems
        if p["type"] == first["type"] and p["loc"][:-1] == first["loc"][:-1] != p["loc"]
    ]
    if first["type"] == UNKNOWN:
        names = sorted(annotations(kind))
        return SceneError(f"{position}: {kind.__name__} has no field {shown(sorted(alike))}; it has {names}")
    if first["type"] == MISSING and isinstance(last, str):
        return SceneError(f"{position.removesuffix(f'.{last}')}: {kind.__name__} needs {', '.join(alike)}")
    if first["type"] != BY_HAND:
        return refuse(*field, phrase(wanted), remedy(wanted))
    cause = first["ctx"]["error"]
    if not isinstance(cause, SceneError):
        return SceneError(f"{position}: {kind.__name__} cannot be built: {cause}")
    cause = SceneError(f"{cause}{_without_unit(kind, value)}")
    return SceneError(f"{position}: {cause}") if first["loc"] else cause


def _without_unit(kind, values) -> str:
    """What makes a refusal likely: pressures of an object that look like megapascals."""
    given = values.items() if isinstance(values, dict) else ()
    small = [f"{name} = {pressure_said(v)}" for name, v in given if too_small(v) and is_pressure(kind, name)]
    return f"; likely cause: {'; '.join(small)}" if small else ""


def is_pressure(kind, name: str) -> bool:
    """Whether a class of scene data has a field that is a pressure."""
    unit = unit_of(annotations(kind).get(name))
    return unit is not None and unit.name == "Pa"


def too_small(value) -> bool:
    """Whether a number is too small for a pressure [Pa] that rock would notice; 0 is a choice."""
    return type(value) in (int, float) and 0.0 < abs(value) < LEAST_PRESSURE


def pressure_said(value: float) -> str:
    """Of a pressure [Pa] that is too small, what it looks like and what to write."""
    text = f"{value:g}"
    return f"{text} Pa looks like MPa: write {f'{value * 1e6:g}' if 'e' in text else f'{text}e6'} or '{text} MPa'"


UNKNOWN, MISSING, BY_HAND = "unexpected_keyword_argument", "missing", "value_error"
"""Kinds of pydantic's errors that are no wrong value of a field; the last was raised in a `__post_init__`."""


def members(wanted) -> tuple:
    """The alternatives of an annotation: (A, B) of A | B, itself of anything else; without what is said about them."""
    while typing.get_origin(wanted) is typing.Annotated:
        wanted = wanted.__origin__
    return typing.get_args(wanted) if typing.get_origin(wanted) in (typing.Union, types.UnionType) else (wanted,)


def within(wanted):
    """An annotation and all that it is made of: alternatives, entries, and what stands beside a type."""
    yield wanted
    for inner in typing.get_args(wanted):
        yield from within(inner)


def unit_of(wanted) -> Unit | None:
    return next((part for part in within(wanted) if isinstance(part, Unit)), None)


def remedy(wanted) -> str:
    return next((part.text for part in within(wanted) if isinstance(part, Remedy)), "")


def phrase(wanted) -> str:
    """What a user is told to give: 'Lattice or Jittered', 'a number in (-1, 0.5)', '2 numbers separated by commas'."""
    if len(members(wanted)) > 1:
        return _either(map(phrase, members(wanted)))
    (bare,) = members(wanted)
    if typing.get_origin(bare) is typing.Literal:
        return _either(map(repr, typing.get_args(bare)))
    marks = getattr(wanted, "__metadata__", ())
    bounds = next((mark for mark in marks if isinstance(mark, Interval)), None)
    unit = next((mark for mark in marks if isinstance(mark, Unit)), None)
    length = next((mark for mark in marks if isinstance(mark, Len)), None)
    if typing.get_origin(bare) is tuple:
        *_, last = kinds = typing.get_args(bare)
        count = f"{length.min_length} to {length.max_length}" if length else ""
        if float not in members(kinds[0]):
            return f"a list of {phrase(kinds[0])}" + (f", {count} of them" if count else "")
        size = phrase(kinds[0]).partition("number")[2]
        return f"{count if last is Ellipsis else len(kinds)} numbers separated by commas{size}".strip()
    word = str(WORDS.get(bare) or getattr(bare, "__name__", shown(bare)))
    size = f" {unit.name}" if unit else ""
    if bounds:
        low: typing.Any  # numbers, which the library's type leaves open
        high: typing.Any
        left, low = ("[", bounds.ge) if bounds.gt is None else ("(", bounds.gt)
        right, high = ("]", bounds.le) if bounds.lt is None else (")", bounds.lt)
        word = word.replace("a ", "a positive ") if 0.0 < low < 1e-6 or (left, low) == ("(", 0.0) else word
        size = f" {left}{low:g}, {high:g}{right}{size}"
    return f"{word} in{size}" if size else word


def _either(words) -> str:
    *most, last = words
    return f"{', '.join(most)} or {last}" if most else last
