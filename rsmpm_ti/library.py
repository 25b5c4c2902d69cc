"""Find a scene, apply overrides, and say clearly what is wrong with either."""

import dataclasses
import difflib
import importlib.util
import inspect
import sys
import traceback
from dataclasses import replace
from pathlib import Path

from rsmpm_ti.errors import SceneError
from rsmpm_ti.record import KNOWN, read_scene
from rsmpm_ti.spec import Scene

SHIPPED = Path(__file__).parent / "scenes"
"""Where a wheel carries the scenes; a checkout has them in ./scenes."""


def folders() -> list[Path]:
    """Where scenes are looked for, in order."""
    return [f for f in (Path("scenes"), SHIPPED, Path(__file__).parent.parent / "scenes") if f.is_dir()]


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
        raise SceneError(f"scene file {name} does not exist")
    scenes = available()
    if name not in scenes:
        raise SceneError(f"no scene named {name!r}; there are: {', '.join(sorted(scenes)) or 'none'} (or give a path)")
    return scenes[name]


def load_scene(name: str, *, quick: bool = False, settings: dict[str, str] | None = None, **overrides) -> Scene:
    """Build a scene. `overrides` are keywords of its function; `settings` are texts as --set gives them, where a
    dotted name reaches a field of the built Scene. `quick` first takes the file's QUICK keywords.

    A .py scene is a program and is run; a .json scene is data and is not. Raises SceneError.
    """
    path, settings = find(name), dict(settings or {})
    dotted = {k: settings.pop(k) for k in list(settings) if "." in k}
    if path.suffix == ".json":
        if settings or overrides or quick:
            raise SceneError("a recorded scene has no keywords; use dotted names, for example schedule.cfl=0.3")
        scene = read_scene(path)
    else:
        module = _load(path)
        function = getattr(module, "scene", None)
        if not callable(function):
            raise SceneError(f"{path} defines no function scene(); it must return a Scene")
        keywords = dict(getattr(module, "QUICK", {})) if quick else {}
        scene = _call(function, path, keywords | overrides, settings)
    for key, text in dotted.items():
        scene = _with_field(scene, key, key.split("."), text)
    return scene


def _load(path: Path):
    spec = importlib.util.spec_from_file_location(f"rsmpm_ti_scene_{path.stem}", path)
    module = importlib.util.module_from_spec(spec)
    try:
        spec.loader.exec_module(module)
    except SceneError:
        raise
    except Exception as error:
        line = next(
            (
                f.lineno
                for f in reversed(traceback.extract_tb(error.__traceback__))
                if Path(f.filename).resolve() == path.resolve()
            ),
            None,
        )
        place = f" line {line}" if line else ""
        raise SceneError(f"{path}{place} cannot be loaded: {type(error).__name__}: {error}") from None
    return module


def keywords_of(path: Path) -> dict[str, object]:
    """Keyword -> default of a scene file's function."""
    function = getattr(_load(path), "scene", None)
    if not callable(function):
        raise SceneError(f"{path} defines no function scene(); it must return a Scene")
    return {k: p.default for k, p in inspect.signature(function).parameters.items()}


def _call(function, path: Path, overrides: dict, settings: dict[str, str]) -> Scene:
    parameters = inspect.signature(function).parameters
    values = dict(overrides)
    for key in (*overrides, *settings):
        if key not in parameters:
            raise SceneError(_unknown(key, list(parameters), f"scene {path.stem}"))
    for key, text in settings.items():
        values[key] = _parse(key, text, parameters[key].default)
    try:
        scene = function(**values)
    except SceneError:
        raise
    except Exception as error:
        raise SceneError(f"{path}: scene({values}) failed: {type(error).__name__}: {error}") from None
    if not isinstance(scene, Scene):
        raise SceneError(f"{path}: scene() must return a Scene, not {type(scene).__name__}")
    return scene


def _unknown(key: str, names: list[str], owner: str) -> str:
    close = difflib.get_close_matches(key, names, n=1)
    hint = f"; did you mean {close[0]}?" if close else ""
    return f"{owner} has no setting {key!r}; it has: {', '.join(names)}{hint}"


def _parse(key: str, text: str, default: object):
    """A text as the type of the value that it replaces."""
    kind = type(default)
    if kind is bool:
        if text.lower() in ("true", "false"):
            return text.lower() == "true"
        raise SceneError(f"{key}={text} is refused: it must be true or false")
    if kind in (int, float) or default is None:
        try:
            return int(text) if kind is int else float(text)
        except ValueError:
            raise SceneError(
                f"{key}={text} is refused: it must be a{'n integer' if kind is int else ' number'}"
            ) from None
    if kind is str:
        return text
    if kind is tuple:
        try:
            return tuple(float(part) for part in text.strip("()").split(",") if part.strip())
        except ValueError:
            raise SceneError(f"{key}={text} is refused: it must be numbers separated by commas") from None
    if dataclasses.is_dataclass(default):
        chosen = KNOWN.get(text)
        if chosen is None:
            names = sorted(n for n, c in KNOWN.items() if c.__module__ == kind.__module__)
            raise SceneError(f"{key}={text} is refused: it must name a class, one of: {', '.join(names)}")
        try:
            return chosen()
        except TypeError as error:
            raise SceneError(
                f"{key}={text} is refused: it needs parameters ({error}); build it in a scene file"
            ) from None
    raise SceneError(f"{key} cannot be set from the command line (it is a {kind.__name__})")


def _with_field(owner, key: str, path: list[str], text: str):
    """A copy of a frozen dataclass with one nested field replaced; bodies.0.seeding indexes a tuple."""
    name, rest = path[0], path[1:]
    if isinstance(owner, tuple):
        if not (name.isdigit() and int(name) < len(owner)):
            raise SceneError(f"{key}: {name!r} is no index; there are {len(owner)} entries, counted from 0")
        k = int(name)
        return (
            *owner[:k],
            _with_field(owner[k], key, rest, text) if rest else _parse(key, text, owner[k]),
            *owner[k + 1 :],
        )
    if not dataclasses.is_dataclass(owner):
        raise SceneError(f"{key}: {name!r} is no field of a {type(owner).__name__}")
    names = [f.name for f in dataclasses.fields(owner)]
    if name not in names:
        raise SceneError(_unknown(name, names, type(owner).__name__))
    old = getattr(owner, name)
    return replace(owner, **{name: _with_field(old, key, rest, text) if rest else _parse(key, text, old)})


def scene_name(name: str) -> str:
    """The name under which a run is filed."""
    path = Path(name)
    return path.parent.name if path.name == "scene.json" else path.stem


def machine() -> dict[str, str]:
    """Versions and machine, for the record; no host name."""
    import importlib.metadata
    import platform

    packages = ("taichi", "numpy", "scipy", "meshio", "matplotlib", "imageio")
    versions = {name: importlib.metadata.version(name) for name in packages}
    return {"python": sys.version.split()[0], **versions, "system": platform.system(), "machine": platform.machine()}
