"""A scene as JSON and back, without executing anyone's code: classes are chosen by "type" among those of an annotation.

`python -m rsmpm_ti.scene --schema > scene.schema.json` prints the JSON schema. An editor that is told of it completes
and checks a scene.json while it is written; in VS Code by
    "json.schemas": [{"fileMatch": ["scene.json"], "url": "./scene.schema.json"}]
"""

import dataclasses
import json

import numpy as np
from pydantic import ValidationError

from rsmpm_ti.checks import adapter, refusal
from rsmpm_ti.errors import SceneError, short, shown
from rsmpm_ti.spec.scene import Scene


def to_plain(value):
    """Dataclasses -> {"type": name, field: ...}; tuples and arrays -> lists; numbers and strings stay. By hand, as a
    scene file may have brought objects of its own, which are told by their class and what they hold."""
    if dataclasses.is_dataclass(value):
        fields = {f.name: to_plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
        return {"type": type(value).__name__, **fields}
    if isinstance(value, (tuple, list)):
        return [to_plain(v) for v in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    held = {name: v for name, v in getattr(value, "__dict__", {}).items() if not name.startswith("_")}
    return {"type": type(value).__name__, **{name: to_plain(v) for name, v in held.items() if not callable(v)}}


def from_plain(plain) -> Scene:
    """The inverse of `to_plain`; raises SceneError for unknown types and fields and wrong kinds, naming the place."""
    plain = _with_tuples(plain)
    try:
        return adapter(Scene).validate_python(plain)
    except ValidationError as error:
        raise refusal("scene", Scene, plain, error) from None
    except (TypeError, AttributeError, ArithmeticError) as error:
        raise SceneError(f"scene: it cannot be built: {error}") from None


def _with_tuples(value):
    """JSON's lists as what scene data holds."""
    if isinstance(value, dict):
        return {key: _with_tuples(field) for key, field in value.items()}
    return tuple(map(_with_tuples, value)) if isinstance(value, list) else value


def schema() -> str:
    """The JSON schema of a scene.json, in which the scene may stand by itself or beside what a run recorded."""
    scene = adapter(Scene).json_schema()
    entry = {"type": "object", "required": ["scene"], "properties": {"scene": {"$ref": "#/$defs/Scene"}}}
    classes = scene.pop("$defs") | {"Scene": scene}
    return json.dumps({"$defs": classes, "anyOf": [entry, {"$ref": "#/$defs/Scene"}]}, indent=1)


def _once(pairs: list[tuple]) -> dict:
    """An object of JSON, where the last of two equal keys would win without a word."""
    found = dict(pairs)
    if len(found) < len(pairs):
        seen: set[str] = set()
        twice = next(key for key, _ in pairs if key in seen or seen.add(key))  # type: ignore[func-returns-value]
        raise SceneError(f"scene: {shown(twice)} stands twice in one object; say it once")
    return found


LARGEST = 16 * 2**20
"""Bytes of a record: one of the most bodies that a scene may have takes half of it."""


def read_scene(path) -> Scene:
    """A Scene from a recorded `scene.json` (its "scene" entry) or from the bare entry."""
    try:
        with open(path, "rb") as file:
            text = file.read(LARGEST + 1)  # a device has no size and no end
        if len(text) > LARGEST:
            raise SceneError(f"{path} is no recorded scene: it is larger than {LARGEST >> 20} MiB")
        data = json.loads(text.decode("utf-8"), object_pairs_hook=_once)
        return from_plain(data.get("scene", data) if isinstance(data, dict) else data)
    except SceneError:
        raise
    except (OSError, ValueError, RecursionError) as error:  # ValueError: no UTF-8, no JSON, or an endless integer
        raise SceneError(f"{path} cannot be read as JSON: {short(str(error))}") from None
