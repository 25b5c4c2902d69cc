"""A scene as JSON and back, without executing anyone's code: names are looked up in a fixed list of classes."""

import dataclasses
import json

from rsmpm_ti import boundaries, laws, regions, seeding, shape, spec, transfer
from rsmpm_ti.errors import SceneError

KNOWN = {
    name: thing
    for module in (boundaries, laws, regions, seeding, shape, spec, transfer)
    for name, thing in vars(module).items()
    if dataclasses.is_dataclass(thing) and isinstance(thing, type)
}
"""Every class that a recorded scene may name."""


def to_plain(value):
    """Dataclasses -> {"type": name, field: ...}; tuples -> lists; numbers and strings stay."""
    if dataclasses.is_dataclass(value):
        fields = {f.name: to_plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, (tuple, list)):
        return [to_plain(v) for v in value]
    return value


def from_plain(value, where: str = "scene"):
    """The inverse of `to_plain`; raises SceneError for unknown types and fields, naming the place."""
    if isinstance(value, list):
        return tuple(from_plain(v, f"{where}[{k}]") for k, v in enumerate(value))
    if not isinstance(value, dict):
        return value
    kind = KNOWN.get(str(value.get("type")))
    if kind is None:
        raise SceneError(f"{where}: unknown type {value.get('type')!r}; known types are {', '.join(sorted(KNOWN))}")
    names = {f.name for f in dataclasses.fields(kind)}
    unknown = set(value) - names - {"type"}
    if unknown:
        raise SceneError(f"{where}: {kind.__name__} has no field {sorted(unknown)}; it has {sorted(names)}")
    fields = {k: from_plain(v, f"{where}.{k}") for k, v in value.items() if k != "type"}
    try:
        return kind(**fields)
    except SceneError:
        raise
    except (TypeError, ValueError, AttributeError) as error:
        raise SceneError(f"{where}: {kind.__name__} cannot be built: {error}") from None


def read_scene(path) -> spec.Scene:
    """A Scene from a recorded `scene.json` (its "scene" entry) or from the bare entry."""
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
    except (OSError, UnicodeDecodeError, json.JSONDecodeError) as error:
        raise SceneError(f"{path} cannot be read as JSON: {error}") from None
    scene = from_plain(data.get("scene", data) if isinstance(data, dict) else data)
    if not isinstance(scene, spec.Scene):
        raise SceneError(f"{path} holds a {type(scene).__name__}, not a Scene")
    return scene
