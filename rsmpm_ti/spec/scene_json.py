"""A scene as JSON and back, without executing anyone's code: classes are chosen by "type" among those of an annotation.

`python -m rsmpm_ti.scene --schema > scene.schema.json` prints the JSON schema. An editor that is told of it completes
and checks a scene.json while it is written; in VS Code by
    "json.schemas": [{"fileMatch": ["scene.json"], "url": "./scene.schema.json"}]
"""

import dataclasses
import hashlib
import json

import numpy as np
from pydantic import ValidationError

from rsmpm_ti.checks import KNOWN, adapter, refusal
from rsmpm_ti.errors import SceneError, short, shown
from rsmpm_ti.records.files import LARGEST
from rsmpm_ti.spec.scene import Scene

OWN, UNRECORDED = "own", "unrecorded"
"""Keys that no class of scene data has as a field: what an object of another class holds, and the kind of a thing that
is in no record."""

MAX_ENTRIES, MAX_DEPTH = 10_000, 20
"""Of an array that is written out, a larger one being told by its digest; of objects that hold objects."""


def to_plain(value):
    """Scene data -> {"type": name, field: ...}; tuples and arrays -> lists; numbers and strings stay.

    By hand, as a scene file may have brought objects of its own: {"type": name, "own": {attribute: ...}}, private ones
    left out. Such a record tells one run from another, but builds no scene. Never raises.
    """
    return _plain(value, ())


def _plain(value, holders: tuple[int, ...]):
    if id(value) in holders or len(holders) > MAX_DEPTH:
        return {UNRECORDED: type(value).__name__}
    inside = (*holders, id(value))
    try:
        if value is None or isinstance(value, bool | str):
            return value
        if isinstance(value, int | float) and not isinstance(value, np.generic):
            return value if abs(value) < LARGEST else {UNRECORDED: type(value).__name__}  # NaN too
        if isinstance(value, np.ndarray | np.generic):
            return _array(np.asarray(value))
        if isinstance(value, tuple | list):
            return [_plain(v, inside) for v in value]
        if KNOWN.get(type(value).__name__) is type(value):
            fields = {name: _plain(field, inside) for name, field in _held(value)}
            return {"type": type(value).__name__, **fields}
        if isinstance(value, dict):
            return {OWN: [[_plain(key, inside), _plain(v, inside)] for key, v in value.items()], "type": "dict"}
        if isinstance(value, set | frozenset):
            return {OWN: sorted((_plain(v, inside) for v in value), key=json.dumps), "type": "set"}
        if callable(value):
            return {UNRECORDED: type(value).__name__}
        return {"type": type(value).__name__, OWN: {n: _plain(v, inside) for n, v in _held(value) if n[0] != "_"}}
    except Exception:  # an object of a scene file may do anything when it is asked what it holds
        return {UNRECORDED: type(value).__name__}


def _held(value) -> list[tuple[str, object]]:
    if dataclasses.is_dataclass(value):
        return [(f.name, getattr(value, f.name)) for f in dataclasses.fields(value)]
    return list(vars(value).items())


def _array(array: np.ndarray):
    """Numbers and texts as lists, also of no axis; of many a digest."""
    if array.dtype.kind not in "biufU":
        return {UNRECORDED: f"{array.dtype} {list(array.shape)}"}
    if array.size > MAX_ENTRIES:
        digest = hashlib.sha256(np.ascontiguousarray(array).tobytes()).hexdigest()
        return {UNRECORDED: f"{array.dtype} {list(array.shape)}", "sha256": digest}
    if array.dtype.kind == "f":
        array = np.nan_to_num(array.astype(float), nan=LARGEST, posinf=LARGEST, neginf=-LARGEST)
    return array.tolist()


def from_plain(plain) -> Scene:
    """The inverse of `to_plain`; raises SceneError for unknown types and fields and wrong kinds, naming the place."""
    _refuse_own(plain, "scene")
    plain = _with_tuples(plain)
    try:
        return adapter(Scene).validate_python(plain)
    except ValidationError as error:
        raise refusal("scene", Scene, plain, error) from None
    except (TypeError, AttributeError, ArithmeticError) as error:
        raise SceneError(f"scene: it cannot be built: {error}") from None


def _refuse_own(plain, place: str) -> None:
    """What is of a class that a scene file brought has no record from which it could be built."""
    if isinstance(plain, list):
        for k, entry in enumerate(plain):
            _refuse_own(entry, f"{place}[{k}]")
    elif isinstance(plain, dict):
        if OWN in plain or UNRECORDED in plain:
            kind = shown(plain.get("type", plain.get(UNRECORDED)))
            raise SceneError(f"{place} is of {kind}, a class of the scene file that was run, and a record cannot build "
                             f"it: run that file again")  # fmt: skip
        for name, field in plain.items():
            _refuse_own(field, f"{place}.{short(name)}")


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


LARGEST_BYTES = 16 * 2**20
"""Bytes of a record: one of the most bodies that a scene may have takes half of it."""


def read_scene(path) -> Scene:
    """A Scene from a recorded `scene.json` (its "scene" entry) or from the bare entry."""
    try:
        with open(path, "rb") as file:
            text = file.read(LARGEST_BYTES + 1)  # a device has no size and no end
        if len(text) > LARGEST_BYTES:
            raise SceneError(f"{path} is no recorded scene: it is larger than {LARGEST_BYTES >> 20} MiB")
        data = json.loads(text.decode("utf-8"), object_pairs_hook=_once)
        return from_plain(data.get("scene", data) if isinstance(data, dict) else data)
    except SceneError:
        raise
    except (OSError, ValueError, RecursionError) as error:  # ValueError: no UTF-8, no JSON, or an endless integer
        raise SceneError(f"{path} cannot be read as JSON: {short(str(error))}") from None
