"""Load a scene, apply overrides, and say clearly what is wrong with either."""

import contextlib
import dataclasses
import difflib
import importlib.util
import inspect
import os
import traceback
import types
import typing
import warnings
from dataclasses import replace
from pathlib import Path

from pydantic import PydanticUserError, TypeAdapter, ValidationError

from rsmpm_ti.checks import KNOWN, STRICT, annotations, members, native, phrase, remedy, unit_of, within
from rsmpm_ti.errors import RockWarning, SceneError, refuse, short, shown
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.drawings.drawn_file import beside
from rsmpm_ti.spec.library.places import find, in_place_of
from rsmpm_ti.spec.library.rocks import ends_early, load_sheet, with_rock
from rsmpm_ti.spec.review.unchecked import unchecked
from rsmpm_ti.spec.scene import Scene, Schedule
from rsmpm_ti.spec.scene_json import read_scene
from rsmpm_ti.units import advice, percentage, quantity


def load_scene(
    name: str,
    *,
    quick: bool = False,
    settings: dict[str, object] | None = None,
    rock: Rock | DataSheet | str | os.PathLike | None = None,
    **overrides,
) -> Scene:
    """Build a scene. `overrides` are keywords of its function; `settings` are texts as --set gives them ("55 GPa"),
    numbers or objects (`Gimp()`), where a dotted name reaches a field of the built Scene, and so does a name of one of
    its fields, or of its schedule's (`t_end`), that is no keyword. `quick` first takes the file's QUICK keywords.

    All settings are put in before their sum is checked, so their order does not matter: two platens change their
    speeds, or `strain_end` becomes none and `t_end` a time, one after the other.

    `rock` takes the place of the scene's own, before dotted names reach into it: a Rock, a DataSheet, a name of the
    shelf or a path of a .toml file. A keyword that then changes nothing is refused.

    A .py scene is a program and is run; a .json scene is data and is not. Raises SceneError.
    """
    path, settings = find(name), dict(settings or {})
    if said := in_place_of(name, path):
        warnings.warn(said, RockWarning, stacklevel=2)
    with beside(path.parent):
        return _load_scene(path, quick, settings, overrides, rock)


def _load_scene(path: Path, quick: bool, settings: dict[str, object], overrides: dict[str, object], rock) -> Scene:
    recorded = path.suffix == ".json"
    function, parameters, quick_keywords = (None, {}, {}) if recorded else _function(path)
    fields = _fields_of(settings, parameters)
    given = load_sheet(rock) if isinstance(rock, str | os.PathLike) else rock
    if not isinstance(given, Rock | DataSheet | None):
        raise refuse("rock", rock, "a Rock, a DataSheet, a name of the shelf, or a path of a .toml file")
    with unchecked() if fields or given else contextlib.nullcontext():
        if recorded:
            if settings or overrides or quick:
                raise SceneError("a recorded scene has no keywords; use dotted names, for example schedule.cfl=0.3")
            scene = read_scene(path)
        else:
            with _naming(settings):
                scene = _call(function, path, (quick_keywords if quick else {}) | overrides, settings)
        if given:
            for key in (*overrides, *settings):
                if key not in parameters or parameters[key].default is inspect.Parameter.empty:
                    continue
                kept = [{k: v for k, v in values.items() if k != key} for values in (overrides, settings)]
                without = _call(function, path, (quick_keywords if quick else {}) | kept[0], kept[1])
                _check_effect(key, scene, without, given)
    if given:
        own = scene.rock
        with unchecked() if fields else contextlib.nullcontext():
            scene = with_rock(scene, given)
        ends = {"strain_end", "t_end", "schedule.strain_end", "schedule.t_end"}
        if not ends & {*overrides, *settings, *fields} and (said := ends_early(scene, own)):
            warnings.warn(said, RockWarning, stacklevel=2)
    if not fields:
        return scene
    with _naming(settings | fields):
        return _with_fields(scene, Scene, {key: (key.split("."), value) for key, value in fields.items()}, scene.dim)


def _check_effect(key: str, scene: Scene, without: Scene, rock: Rock | DataSheet) -> None:
    """Refuse a keyword that belongs to the rock which another takes the place of. without: the scene without it."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RockWarning)
        idle = scene.rock != without.rock and with_rock(scene, rock) == with_rock(without, rock)
    if idle:
        remedy = "leave it out, put it into the rock's sheet, or set a field of the new rock (rock.after_failure...)"
        raise SceneError(f"{short(key)} is of the scene's own rock, which another takes the place of; {remedy}")


def _fields_of(settings: dict[str, object], parameters) -> dict[str, object]:
    """Take out of the settings what is a field of the built scene: its dotted name -> value.

    A keyword of the schedule's own field that is set to none is the field: the scene's function wants its number.
    """
    scene, schedule = (typing.get_type_hints(kind) for kind in (Scene, Schedule))
    fields = {}
    for key in list(settings):
        none = str(settings[key]).lower() == "none"
        if key in schedule and (key not in parameters or (none and not _takes_none(parameters[key]))):
            fields[f"schedule.{key}"] = settings.pop(key)
        elif "." in key or (key in scene and key not in parameters):
            fields[key] = settings.pop(key)
    return fields


def _takes_none(parameter: inspect.Parameter) -> bool:
    return types.NoneType in members(_kind_of(parameter))


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


def about(path: Path) -> tuple[str, dict[str, str]]:
    """The first line of a scene file, and keyword -> default as `--set` takes it, with its unit."""
    function, parameters, _ = _function(path)
    said = getattr(function, "__globals__", {}).get("__doc__") or ""
    first = next(iter(said.strip().splitlines()), "").strip().removesuffix(".")
    return first, {key: _with_unit(parameter) for key, parameter in parameters.items()}


DISPLAYED = {"m": ("mm", 1e3), "Pa": ("MPa", 1e-6), "degrees": ("deg", 1.0), "J/m^2": ("J/m2", 1.0)}
"""SI unit -> the one in which a default is shown, and how many of it one is; others are shown as they are."""


def _with_unit(parameter: inspect.Parameter) -> str:
    default, unit = parameter.default, unit_of(_kind_of(parameter))
    if isinstance(default, bool) or not isinstance(default, int | float):
        return default if isinstance(default, str) else shown(default)
    name, factor = ("", 1.0) if unit is None else DISPLAYED.get(unit.name, (unit.name, 1.0))
    return f"{default * factor:.10g}{name}"


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
    """What a text may mean, the narrowest first; what is no text means itself, and a list the tuple of its entries."""
    if not isinstance(text, str):
        yield native(tuple(text) if isinstance(text, list) else text)
        return
    if text.lower() in ("none", "true", "false"):
        yield {"none": None, "true": True, "false": False}[text.lower()]
    unit = unit_of(wanted)

    def number(part: str) -> float:
        found = quantity(part, unit, dim) if unit else percentage(part)
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
    said = _advice(text, wanted, dim) if isinstance(text, str) and float in within(wanted) else ""
    raise near or SceneError(f"{refused} must be {phrase(wanted)}{said}")


def _advice(text: str, wanted, dim: int) -> str:
    """About the first number of a text that has a unit which is none of the field's."""
    parts = text.strip("()").split(",") if any(typing.get_origin(w) is tuple for w in within(wanted)) else [text]
    unit = unit_of(wanted)
    odd = [part for part in parts if unit is None or quantity(part, unit, dim) is None]
    return next((f"; {said}" for part in odd if (said := advice(part, unit, dim))), "")


OUT_OF_RANGE = {"greater_than", "greater_than_equal", "less_than", "less_than_equal", "finite_number", "too_long"}
"""What pydantic calls a number that is one, but not of those that are allowed."""


def _with_fields(owner, kind, changes: dict[str, tuple[list[str], object]], dim: int):
    """A copy of frozen data with nested values replaced, all of them before the copy is built and checked.

    kind: the annotation of `owner`; changes: dotted name -> what is left of its path from `owner`, and the value;
    bodies.0.seeding indexes a tuple. dim: of the scene, by which a unit is m or m^2.
    """
    whole = [key for key, (path, _) in changes.items() if not path]
    if whole:  # the value itself, and what is to be changed in it comes after
        owner = _parse(whole[0], changes[whole[0]][1], kind, dim)
        changes = {key: change for key, change in changes.items() if key != whole[0]}
        if not changes:
            return owner
    inner: dict[str, dict] = {}
    for key, (path, value) in changes.items():
        inner.setdefault(path[0], {})[key] = (path[1:], value)
    first = {name: next(iter(own)) for name, own in inner.items()}  # a setting by which to name each

    def entry(name: str, old, wanted):
        return _with_fields(old, wanted, inner[name], dim)

    if isinstance(owner, tuple):
        for name in inner:
            if name not in map(str, range(len(owner))):
                count = f"there are {len(owner)} entries, counted from 0"
                raise SceneError(f"{short(first[name])}: {shown(name)} is no index; {count}")
        entries = next(typing.get_args(part) for part in within(kind) if typing.get_origin(part) is tuple)
        kinds = [entries[0 if entries[-1] is Ellipsis else k] for k in range(len(owner))]
        return tuple(entry(str(k), old, kinds[k]) if str(k) in inner else old for k, old in enumerate(owner))
    if not dataclasses.is_dataclass(owner) or isinstance(owner, type):
        name = next(iter(inner))
        if owner is None:
            whose = short(first[name]).rpartition(f".{name}")[0]
            wanted = phrase(kind).removesuffix(" or none")
            raise SceneError(f"{short(first[name])}: {whose} is none; give it first: {wanted}")
        raise SceneError(f"{short(first[name])}: {shown(name)} is no field of a {type(owner).__name__}")
    names = [f.name for f in dataclasses.fields(owner)]
    for name in inner:
        if name not in names:
            raise SceneError(_unknown(name, names, type(owner).__name__))
    values = {name: entry(name, getattr(owner, name), annotations(type(owner))[name]) for name in inner}
    try:
        return replace(owner, **values)
    except SceneError:
        raise
    except (TypeError, ValueError, AttributeError, ArithmeticError) as error:
        given = ", ".join(f"{short(key)}={short(str(value))}" for key, (_, value) in changes.items())
        raise SceneError(f"{given} is refused: {type(owner).__name__} cannot be built: {error}") from None
