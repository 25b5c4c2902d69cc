"""A scene as JSON and back, without executing anyone's code: names are looked up in a fixed list of classes."""

import dataclasses
import json
import typing

from rsmpm_ti.checks import fits, members, phrase
from rsmpm_ti.errors import SceneError, refuse, short, shown
from rsmpm_ti.spec.scene import Scene


def _reachable(annotation, found: dict[str, type]) -> None:
    """Add every dataclass that an annotation names, directly or through fields, to `found`."""
    for kind in (annotation, *typing.get_args(annotation)):
        if isinstance(kind, type) and dataclasses.is_dataclass(kind):
            if kind.__name__ not in found:
                found[kind.__name__] = kind
                for inner in typing.get_type_hints(kind).values():
                    _reachable(inner, found)
        elif kind is not annotation:
            _reachable(kind, found)


KNOWN: dict[str, type] = {}
"""Every class that a recorded scene may name: those within reach of the annotations of `Scene`."""
_reachable(Scene, KNOWN)


def family_of(kind: type) -> tuple[type, ...]:
    """The classes that may stand where one of scene data stands: the alternatives of an annotation that names it."""
    for owner in KNOWN.values():
        for annotation in typing.get_type_hints(owner).values():
            for alternatives in (annotation, *typing.get_args(annotation)):
                if kind in members(alternatives) and len(members(alternatives)) > 1:
                    return tuple(
                        k for k in members(alternatives) if isinstance(k, type) and dataclasses.is_dataclass(k)
                    )
    return (kind,)


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
        raise SceneError(
            f"{where}: unknown type {shown(value.get('type'))}; known types are {', '.join(sorted(KNOWN))}"
        )
    wanted = typing.get_type_hints(kind)
    names = {f.name for f in dataclasses.fields(kind)}
    unknown = set(value) - names - {"type"}
    if unknown:
        raise SceneError(f"{where}: {kind.__name__} has no field {shown(sorted(unknown))}; it has {sorted(names)}")
    fields = {k: from_plain(v, f"{where}.{k}") for k, v in value.items() if k != "type"}
    for k, v in fields.items():
        if not fits(v, wanted[k]):
            raise refuse(f"{where}.{k}", v, phrase(wanted[k]))
    try:
        return kind(**fields)
    except SceneError as error:
        raise SceneError(f"{where}: {error}") from None
    except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise SceneError(f"{where}: {kind.__name__} cannot be built: {error}") from None


def _once(pairs: list[tuple]) -> dict:
    """An object of JSON, where the last of two equal keys would win without a word."""
    found = dict(pairs)
    if len(found) < len(pairs):
        keys = [key for key, _ in pairs]
        twice = next(key for key in keys if keys.count(key) > 1)
        raise SceneError(f"scene: {shown(twice)} stands twice in one object; say it once")
    return found


def read_scene(path) -> Scene:
    """A Scene from a recorded `scene.json` (its "scene" entry) or from the bare entry."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file, object_pairs_hook=_once)
        scene = from_plain(data.get("scene", data) if isinstance(data, dict) else data)
    except SceneError:
        raise
    except (OSError, ValueError, RecursionError) as error:  # ValueError: no UTF-8, no JSON, or an endless integer
        raise SceneError(f"{path} cannot be read as JSON: {short(str(error))}") from None
    if not isinstance(scene, Scene):
        raise SceneError(f"{path} holds a {type(scene).__name__}, not a Scene")
    return scene
