"""Find a scene, apply overrides, and say clearly what is wrong with either."""

import contextlib
import dataclasses
import difflib
import importlib.util
import inspect
import sys
import traceback
import typing
from dataclasses import replace
from pathlib import Path

from pydantic import PydanticUserError, TypeAdapter, ValidationError

import rsmpm_ti
from rsmpm_ti.checks import KNOWN, STRICT, annotations, members, phrase, remedy, unit_of, within
from rsmpm_ti.errors import SceneError, refuse, short, shown
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.scene_json import read_scene
from rsmpm_ti.units import quantity

PACKAGE = Path(rsmpm_ti.__file__).parent
SHIPPED = PACKAGE / "scenes"
"""Where a wheel carries the scenes; a checkout has them in ./scenes."""


def folders() -> list[Path]:
    """Where scenes are looked for, in order."""
    return [f for f in (Path("scenes"), SHIPPED, PACKAGE.parent / "scenes") if f.is_dir()]


def available() -> dict[str, Path]:
    """Scene name -> file; the first folder wins."""
    found: dict[str, Path] = {}
    for folder in folders():
        for path in sorted(folder.glob("[a-z]*.py")):
            found.setdefault(path.stem, path)
    return found


def find(name: str) -> Path:
    """A path as given, else a scene by name."""
    path = Path(name)
    if path.suffix in (".py", ".json"):
        if path.is_file():
            return path
        raise SceneError(f"scene file {short(name)} does not exist")
    scenes = available()
    if name not in scenes:
        raise SceneError(
            f"no scene named {shown(name)}; there are: {', '.join(sorted(scenes)) or 'none'} (or give a path)"
        )
    return scenes[name]


def load_scene(name: str, *, quick: bool = False, settings: dict[str, object] | None = None, **overrides) -> Scene:
    """Build a scene. `overrides` are keywords of its function; `settings` are texts as --set gives them ("55 GPa"), or
    numbers, where a dotted name reaches a field of the built Scene, and so does a field's own name that is no keyword.
    `quick` first takes the file's QUICK keywords.

    A .py scene is a program and is run; a .json scene is data and is not. Raises SceneError.
    """
    path, settings = find(name), dict(settings or {})
    recorded = path.suffix == ".json"
    function, parameters, quick_keywords = (None, {}, {}) if recorded else _function(path)
    fields = {
        key: settings.pop(key)
        for key in list(settings)
        if "." in key or (key in typing.get_type_hints(Scene) and key not in parameters)
    }
    if recorded:
        if settings or overrides or quick:
            raise SceneError("a recorded scene has no keywords; use dotted names, for example schedule.cfl=0.3")
        scene = read_scene(path)
    else:
        with _naming(settings):
            scene = _call(function, path, (quick_keywords if quick else {}) | overrides, settings)
    for key, text in fields.items():
        with _naming({key: text}):
            scene = _with_field(scene, Scene, key, key.split("."), text, scene.dim)
    return scene


@contextlib.contextmanager
def _naming(settings: dict[str, object]):
    """Says which settings led to a refusal that names none of them: a keyword becomes fields of other names."""
    try:
        yield
    except SceneError as error:
        if not settings or any(short(key) in str(error) for key in settings):
            raise
        given = ", ".join(f"{short(key)}={short(str(text))}" for key, text in settings.items())
        raise SceneError(f"{error} (set: {given})") from None


def _load(path: Path):
    spec = importlib.util.spec_from_file_location(f"rsmpm_ti_scene_{path.stem}", path)
    assert spec is not None and spec.loader is not None  # of a path that ends in .py there is always one
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SceneError:
        raise
    except (Exception, SystemExit) as error:
        line = next(
            (
                f.lineno
                for f in reversed(traceback.extract_tb(error.__traceback__))
                if Path(f.filename).resolve() == path.resolve()
            ),
            None,
        )
        position = f" line {line}" if line else ""
        raise SceneError(f"{path}{position} cannot be loaded: {_said(error)}") from None
    return module


def _said(error: BaseException) -> str:
    """What an exception of a scene file says, which may be too much, or nothing that can be shown."""
    try:
        return short(f"{type(error).__name__}: {error}")
    except Exception:
        return type(error).__name__


def _function(path: Path):
    """The function scene() of a file, its parameters, and the file's QUICK keywords."""
    module = _load(path)
    try:
        parameters = inspect.signature(module.scene).parameters
    except (AttributeError, TypeError, ValueError):
        raise SceneError(f"{path} defines no function scene(); it must return a Scene") from None
    quick = getattr(module, "QUICK", {})
    if not (isinstance(quick, dict) and all(isinstance(key, str) for key in quick)):
        raise SceneError(f"{path}: QUICK must be a dict of keywords of scene(), not {shown(quick)}")
    return module.scene, parameters, quick


def keywords_of(path: Path) -> dict[str, object]:
    """Keyword -> default of a scene file's function. Raises SceneError for a file without one."""
    _, parameters, _ = _function(path)
    return {k: p.default for k, p in parameters.items()}


def _call(function, path: Path, overrides: dict, settings: dict[str, object]) -> Scene:
    parameters = inspect.signature(function).parameters
    values = dict(overrides)
    for key in (*overrides, *settings):
        if key not in parameters:
            fields = "; fields of the built scene are set by dotted names (schedule.cfl=0.3) or as order=usf"
            raise SceneError(
                _unknown(key, list(parameters), f"scene {path.stem}", fields, typing.get_type_hints(Scene))
            )
    for key, text in settings.items():
        values[key] = _parse(key, text, _kind_of(parameters[key]))
    try:
        scene = function(**values)
    except SceneError:
        raise
    except (Exception, SystemExit) as error:
        raise SceneError(f"{path}: scene({short(str(values))}) failed: {_said(error)}") from None
    if not isinstance(scene, Scene):
        raise SceneError(f"{path}: scene() must return a Scene, not {type(scene).__name__}")
    return scene


def _unknown(key: str, names: list[str], owner: str, more: str = "", also=()) -> str:
    close = difflib.get_close_matches(key[:100], [*names, *also], n=1)
    hint = f"; did you mean {close[0]}?" if close else ""
    return f"{owner} has no setting {shown(key)}; it has: {', '.join(names)}{more}{hint}"


def _kind_of(parameter: inspect.Parameter):
    """What a keyword takes: what its annotation says, else what its default is; a class may be any of its family."""
    default, said = parameter.default, parameter.annotation
    if dataclasses.is_dataclass(default):
        return family_of(type(default))
    if said is not inspect.Parameter.empty and not isinstance(said, str):
        return said
    if default is None or default is inspect.Parameter.empty:
        return float | None
    return tuple[float, ...] if isinstance(default, tuple) else type(default)


def family_of(kind: type):
    """The annotation of a field of scene data that names a class, with its alternatives; the class where none does."""
    fields = (part for owner in KNOWN.values() for wanted in annotations(owner).values() for part in within(wanted))
    return next((part for part in fields if kind in members(part) and len(members(part)) > 1), kind)


def _readings(text, wanted, dim: int):
    """What a text may mean, the narrowest first; what is no text means itself."""
    if not isinstance(text, str):
        yield text
        return
    if text.lower() in ("none", "true", "false"):
        yield {"none": None, "true": True, "false": False}[text.lower()]
    unit = unit_of(wanted)

    def number(part: str) -> float:
        found = quantity(part, unit, dim) if unit else None
        return float(part) if found is None else found

    for read in (number, int, lambda t: tuple(number(part) for part in t.strip("()").split(",") if part.strip())):
        with contextlib.suppress(ValueError):
            yield read(text)
    if text in KNOWN:
        yield {"type": text}
    yield text


def _parse(key: str, text, wanted, dim: int = 2):
    """A text as what an annotation says: a number, with a unit or without, a word, numbers separated by commas, or the
    name of a class."""
    near, refused = None, f"{short(key)}={short(text) if isinstance(text, str) else shown(text)} is refused: it"
    try:  # in a tuple, as pydantic takes no settings beside a class that has its own
        adapter = TypeAdapter(tuple[wanted], config=STRICT)
    except PydanticUserError:
        raise SceneError(f"{refused} is annotated {shown(wanted)}, which no value can be held to") from None
    for value in _readings(text, wanted, dim):
        try:
            return adapter.validate_python((value,))[0]
        except ValidationError as error:
            kinds = {problem["type"] for problem in error.errors(include_url=False)}
            if "missing" in kinds and isinstance(value, dict):
                raise SceneError(f"{refused} needs parameters; build it in a scene file") from None
            if near is None and kinds & OUT_OF_RANGE:
                near = refuse(short(key), value, phrase(wanted), remedy(wanted))
    raise near or SceneError(f"{refused} must be {phrase(wanted)}")


OUT_OF_RANGE = {"greater_than", "greater_than_equal", "less_than", "less_than_equal", "finite_number", "too_long"}
"""What pydantic calls a number that is one, but not of those that are allowed."""


def _with_field(owner, kind, key: str, path: list[str], text, dim: int):
    """A copy of frozen data with one nested value replaced; `kind` is the annotation of `owner`, bodies.0.seeding
    indexes a tuple; dim: of the scene, by which a unit is m or m^2."""
    if not path:
        return _parse(key, text, kind, dim)
    name, rest = path[0], path[1:]
    if isinstance(owner, tuple):
        if name not in map(str, range(len(owner))):
            raise SceneError(f"{short(key)}: {shown(name)} is no index; there are {len(owner)} entries, counted from 0")
        k = int(name)
        entries = next(typing.get_args(part) for part in within(kind) if typing.get_origin(part) is tuple)
        entry = _with_field(owner[k], entries[0 if entries[-1] is Ellipsis else k], key, rest, text, dim)
        return (*owner[:k], entry, *owner[k + 1 :])
    if not dataclasses.is_dataclass(owner) or isinstance(owner, type):
        raise SceneError(f"{short(key)}: {shown(name)} is no field of a {type(owner).__name__}")
    names = [f.name for f in dataclasses.fields(owner)]
    if name not in names:
        raise SceneError(_unknown(name, names, type(owner).__name__))
    value = _with_field(getattr(owner, name), annotations(type(owner))[name], key, rest, text, dim)
    try:
        return replace(owner, **{name: value})
    except SceneError:
        raise
    except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
        raise SceneError(
            f"{short(key)}={short(str(text))} is refused: {type(owner).__name__} cannot be built: {error}"
        ) from None


def scene_name(name: str) -> str:
    """The name under which a run is filed."""
    path = Path(name)
    return path.parent.name if path.name == "scene.json" else path.stem


def machine() -> dict[str, str]:
    """Versions and machine, for the record; no host name."""
    import importlib.metadata
    import platform

    packages = ("taichi", "numpy", "scipy", "meshio", "matplotlib", "imageio")
    versions = {}
    for name in packages:
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:  # a movie is not written without imageio, but a run goes on
            versions[name] = "not installed"
    return {"python": sys.version.split()[0], **versions, "system": platform.system(), "machine": platform.machine()}
