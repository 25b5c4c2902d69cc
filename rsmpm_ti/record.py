"""A scene as JSON and back, without executing anyone's code: names are looked up in a fixed list of classes.

Also the one check that a value from outside, a text or JSON, is of the kind that its field is annotated with.
"""

import dataclasses
import json
import types
import typing

from rsmpm_ti import (
    averaging,
    boundaries,
    directional,
    heterogeneity,
    laws,
    regions,
    seeding,
    shape,
    softening,
    spec,
    starts,
    transfer,
)
from rsmpm_ti.errors import SceneError, refuse

MODULES = (
    averaging, boundaries, directional, heterogeneity, laws, regions, seeding, shape, softening, spec, starts, transfer,
)  # fmt: skip

KNOWN = {
    name: thing
    for module in MODULES
    for name, thing in vars(module).items()
    if dataclasses.is_dataclass(thing) and isinstance(thing, type)
}
"""Every class that a recorded scene may name."""

PHRASES = {float: "a number", int: "an integer", bool: "true or false", str: "a text", types.NoneType: "none"}


def members(wanted) -> tuple:
    """The alternatives of an annotation: (A, B) of A | B, itself of anything else."""
    return typing.get_args(wanted) if typing.get_origin(wanted) in (typing.Union, types.UnionType) else (wanted,)


def fits(value, wanted) -> bool:
    """Whether a value is what an annotation says. An integer will do for a number, a bool will not."""
    if len(members(wanted)) > 1:
        return any(fits(value, kind) for kind in members(wanted))
    if typing.get_origin(wanted) is tuple:
        if not isinstance(value, tuple):
            return False
        kinds = entry_kinds(wanted, len(value))
        return len(kinds) == len(value) and all(map(fits, value, kinds))
    if wanted in (int, float) and isinstance(value, int):
        return not isinstance(value, bool) and (wanted is int or value.bit_length() < 1000)
    return isinstance(value, wanted)


def entry_kinds(wanted, length: int) -> tuple:
    """The annotations of a tuple's entries, `length` of them where tuple[A, ...] leaves that open."""
    kinds = next((typing.get_args(kind) for kind in members(wanted) if typing.get_origin(kind) is tuple), (object, ...))
    return kinds[:1] * length if kinds[-1] is Ellipsis else kinds


def phrase(wanted) -> str:
    """What a user is told to give: 'Lattice or Jittered', 'a number or none', '2 numbers separated by commas'."""
    if len(members(wanted)) > 1:
        *most, last = map(phrase, members(wanted))
        return f"{', '.join(most)} or {last}"
    if typing.get_origin(wanted) is tuple:
        kinds = typing.get_args(wanted)
        if kinds[0] is not float:
            return f"a list of {phrase(kinds[0])}"
        return f"{'' if kinds[-1] is Ellipsis else f'{len(kinds)} '}numbers separated by commas"
    return PHRASES.get(wanted) or wanted.__name__


def to_plain(value):
    """Dataclasses -> {"type": name, field: ...}; tuples -> lists; numbers and strings stay."""
    if dataclasses.is_dataclass(value):
        fields = {f.name: to_plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, (tuple, list)):
        return [to_plain(v) for v in value]
    return value


def from_plain(value, where: str = "scene"):
    """The inverse of `to_plain`; raises SceneError for unknown types and fields and wrong kinds, naming the place."""
    if isinstance(value, list):
        return tuple(from_plain(v, f"{where}[{k}]") for k, v in enumerate(value))
    if not isinstance(value, dict):
        return value
    kind = KNOWN.get(str(value.get("type")))
    if kind is None:
        raise SceneError(f"{where}: unknown type {value.get('type')!r}; known types are {', '.join(sorted(KNOWN))}")
    wanted = typing.get_type_hints(kind)
    names = {f.name for f in dataclasses.fields(kind)}
    unknown = set(value) - names - {"type"}
    if unknown:
        raise SceneError(f"{where}: {kind.__name__} has no field {sorted(unknown)}; it has {sorted(names)}")
    fields = {k: from_plain(v, f"{where}.{k}") for k, v in value.items() if k != "type"}
    for k, v in fields.items():
        if not fits(v, wanted[k]):
            raise refuse(f"{where}.{k}", v, phrase(wanted[k]))
    try:
        return kind(**fields)
    except SceneError:
        raise
    except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise SceneError(f"{where}: {kind.__name__} cannot be built: {error}") from None


def read_scene(path) -> spec.Scene:
    """A Scene from a recorded `scene.json` (its "scene" entry) or from the bare entry."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        scene = from_plain(data.get("scene", data) if isinstance(data, dict) else data)
    except SceneError:
        raise
    except (OSError, ValueError, RecursionError) as error:  # ValueError: no UTF-8, no JSON, or an endless integer
        raise SceneError(f"{path} cannot be read as JSON: {error}") from None
    if not isinstance(scene, spec.Scene):
        raise SceneError(f"{path} holds a {type(scene).__name__}, not a Scene")
    return scene
