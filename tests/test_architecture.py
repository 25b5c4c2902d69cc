"""The shape of the code, read from the code: layers, what may import Taichi, and what Taichi does not forgive."""

import ast
import re
import subprocess
import sys
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import rsmpm_ti.spec.scene  # noqa: F401  (fills KNOWN)
from rsmpm_ti.checks import KNOWN

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "rsmpm_ti"

ROOMS = """
    ctrl_c errors process units checks records backend rock method spec setups fields analysis failure mpm solver paint
    output results run lab cases verify hardcases study bench calibrate validate scene
""".split()
"""Ground floor first: a module imports only from rooms to the left of its own, and within its room in no circle."""

PAINT_SEES = {"process", "errors", "units", "records", "paint"}
"""Pictures are made of records alone, so that whoever has a run's files can paint it."""

WITHOUT_TAICHI = (
    "ctrl_c process errors units checks records spec.drawings spec.regions spec.seeding spec.review.slit_check "
    "rock.heterogeneity output.files analysis"
).split()
"""Modules and rooms that are read where Taichi is not started, or is not there."""

SCENE_DATA = ("rock", "method", "spec")
"""Rooms of what a scene is made of: frozen strategies."""

MAY_INIT = {"rsmpm_ti/backend/start.py"}
VAGUE = {"util", "utils", "helper", "helpers", "manager", "managers", "engine", "engines"}
MOST_LINES, MOST_FILES = 350, 12

PACKAGE_FILES = sorted(PACKAGE.rglob("*.py"))
ALL_FILES = [path for folder in ("rsmpm_ti", "scenes", "tests") for path in sorted((ROOT / folder).rglob("*.py"))]


def relative(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


def parse(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"), filename=str(path))


def dotted(path: Path) -> str:
    """`rsmpm_ti/paint/raster.py` -> "rsmpm_ti.paint.raster"; a package's `__init__.py` -> the package."""
    return ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")


MODULES = {dotted(path): path for path in PACKAGE_FILES}


def made_in(path: Path) -> set[str]:
    """Names that a file defines at its top level."""
    found = set()
    for node in parse(path).body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            found.add(node.name)
        elif isinstance(node, (ast.Assign, ast.AnnAssign)):
            targets = node.targets if isinstance(node, ast.Assign) else [node.target]
            found |= {n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)}
    return found


DEFINED = {module: made_in(path) for module, path in MODULES.items()}


def each(paths):
    return pytest.mark.parametrize("path", paths, ids=relative)


def imported_names(path: Path) -> list[tuple[int, str]]:
    """Every (line, dotted name) that a file imports, also inside functions, relatively and by `import_module`."""
    package = dotted(path) if path.name == "__init__.py" else dotted(path).rpartition(".")[0]
    found = []
    for node in ast.walk(parse(path)):
        if isinstance(node, ast.Import):
            found += [(node.lineno, alias.name) for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            parents = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join(parents + ([node.module] if node.module else []))
            found += [(node.lineno, f"{base}.{alias.name}") for alias in node.names]
        elif isinstance(node, ast.Call) and ast.unparse(node.func).endswith(("import_module", "__import__")):
            names = [argument.value for argument in node.args if isinstance(argument, ast.Constant)]
            found += [(node.lineno, name) for name in names if isinstance(name, str)]
    return found


def own_module(name: str) -> str | None:
    """The module of this package that a dotted import loads; None for other packages, the version and the door."""
    if name.split(".")[0] != "rsmpm_ti":
        return None
    while name not in MODULES:
        name = name.rpartition(".")[0]
    return None if name == "rsmpm_ti" else name


def room(module: str) -> str:
    """ "rsmpm_ti.spec.scene" -> "spec"."""
    return module.split(".")[1]


def imports_of(path: Path) -> set[str]:
    """Own modules that a file imports, but for itself and its rooms."""
    return {own for _, name in imported_names(path) if (own := own_module(name)) and own != dotted(path)}


def test_every_package_is_installed():
    """A folder that pyproject.toml does not name is in a checkout and in no wheel."""
    listed = re.search(r"^packages = \[(.*?)\]$", (ROOT / "pyproject.toml").read_text(), re.MULTILINE | re.DOTALL)
    packages = {dotted(path) for path in PACKAGE_FILES if path.name == "__init__.py"}
    assert set(re.findall(r'"([\w.]+)"', listed[1])) == packages | {"rsmpm_ti.scenes"}


def test_top_level_holds_the_words_and_the_commands_alone():
    modules = {path.stem for path in PACKAGE.glob("*.py")}
    assert modules == {"__init__", "__main__", "ctrl_c", "process", "errors", "units", "checks", "scene"}


def test_every_room_is_in_the_list_and_every_name_of_the_list_a_room():
    there = {dotted(path).split(".")[1] for path in PACKAGE_FILES if dotted(path).count(".")} - {"__main__"}
    assert there == set(ROOMS), "add it to ROOMS, to the right of every room it imports from"


@each([path for path in PACKAGE_FILES if path.parent != PACKAGE or path.stem in ROOMS])
def test_module_imports_only_from_rooms_before_its_own(path):
    own = room(dotted(path))
    may = PAINT_SEES if own == "paint" else set(ROOMS[: ROOMS.index(own) + 1])
    for line, name in imported_names(path):
        target = own_module(name)
        assert target is None or room(target) in may, (
            f"{relative(path)}:{line} imports {name}, but {own!r} sees only {sorted(may)}"
        )


def test_no_module_imports_itself_by_way_of_others():
    order = TopologicalSorter({module: imports_of(path) for module, path in MODULES.items() if module != "rsmpm_ti"})
    assert order.static_order()  # raises CycleError, which names the circle


@pytest.mark.parametrize("folder", sorted({path.parent for path in PACKAGE_FILES}), ids=relative)
def test_room_is_small_enough_to_know(folder):
    files = [path for path in folder.glob("*.py") if path.stem not in ("__init__", "__main__")]
    assert len(files) <= MOST_FILES, f"{relative(folder)} has {len(files)} modules: open another room"


@each([path for path in ALL_FILES if path.parts[-2] != "scenes"])
def test_name_is_imported_from_where_it_is_made(path):
    """One path for a name: a module that is moved is then found by its users' imports."""
    for line, name in imported_names(path):
        module = own_module(name)
        thing = name.removeprefix(f"{module}.")
        if module and thing != module:
            assert thing in DEFINED[module], f"{relative(path)}:{line}: {thing} is not made in {module}"


@each(ALL_FILES)
def test_annotations_are_not_turned_into_strings(path):
    """Taichi reads the annotations of kernels as objects: with this import it refuses them."""
    assert "__future__.annotations" not in [name for _, name in imported_names(path)]


@each([path for path in ALL_FILES if relative(path) not in MAY_INIT])
def test_taichi_is_started_in_one_place(path):
    """`ti.init` frees every field there is, so a second caller would pull the ground from under the first."""
    tree = parse(path)
    aliases = {
        alias.asname or alias.name
        for node in ast.walk(tree)
        if isinstance(node, ast.Import)
        for alias in node.names
        if alias.name == "taichi"
    }
    calls = [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
    lines = [call.lineno for call in calls if ast.unparse(call.func) in {f"{alias}.init" for alias in aliases}]
    lines += [line for line, name in imported_names(path) if name == "taichi.init"]
    assert not lines, f"{relative(path)}, lines {lines}: ti.init is called only in {sorted(MAY_INIT)}"


def loaded_by(*modules: str) -> dict[str, set[str]]:
    """Top-level packages in sys.modules after a fresh Python has imported each of some modules, one after another."""
    imports = "; ".join(
        f"import {module}; print({module!r}, *{{name.partition('.')[0] for name in sys.modules}})" for module in modules
    )
    done = subprocess.run(
        [sys.executable, "-c", f"import sys; {imports}"], cwd=ROOT, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 0, done.stderr
    return {line.split()[0]: set(line.split()[1:]) for line in done.stdout.splitlines()}


def test_modules_do_without_taichi():
    """By themselves: their room may hold others that do need it."""
    modules = [m for m in MODULES if any(f"{m}.".startswith(f"rsmpm_ti.{name}.") for name in WITHOUT_TAICHI)]
    assert len(modules) >= len(WITHOUT_TAICHI)
    direct = {m: {name.partition(".")[0] for _, name in imported_names(MODULES[m])} for m in modules}
    assert [m for m in modules if "taichi" in direct[m]] == []


def test_importing_the_package_is_light():
    loaded = loaded_by("rsmpm_ti")["rsmpm_ti"]
    assert "rsmpm_ti" in loaded
    assert not loaded & {"taichi", "matplotlib", "imageio", "pydantic", "pint"}


@each(ALL_FILES)
def test_module_name_says_what_it_holds(path):
    words = {word for part in path.relative_to(ROOT).with_suffix("").parts for word in part.split("_")}
    assert not words & VAGUE, f"{relative(path)}: {words & VAGUE} could hold anything"


@each(ALL_FILES)
def test_file_is_short_enough_to_read(path):
    lines = len(path.read_text(encoding="utf-8").splitlines())
    assert lines <= MOST_LINES, f"{relative(path)} has {lines} lines, more than {MOST_LINES}: split it by subject"


def classes(path: Path) -> list[ast.ClassDef]:
    return [node for node in ast.walk(parse(path)) if isinstance(node, ast.ClassDef)]


STRATEGIES = [
    pytest.param(path, node, id=f"{dotted(path).removeprefix('rsmpm_ti.')}.{node.name}")
    for path in PACKAGE_FILES
    for node in classes(path)
    if path.parent.name in SCENE_DATA and node.name in KNOWN
]


@pytest.mark.parametrize("path, node", STRATEGIES)
def test_strategy_is_a_frozen_keyword_only_dataclass(path, node):
    keywords = {}
    for decorator in node.decorator_list:
        if isinstance(decorator, ast.Call) and ast.unparse(decorator.func).split(".")[-1] == "dataclass":
            keywords = {k.arg: ast.unparse(k.value) for k in decorator.keywords}
    where = f"{relative(path)}:{node.lineno} {node.name}"
    assert keywords.get("frozen") == keywords.get("kw_only") == "True", (
        f"{where} is not decorated @dataclass(frozen=True, kw_only=True)"
    )


def test_no_strategy_is_subclassed():
    """Behaviour of a final class is read in one place; tweak by wrapping."""
    strategies = {param.values[1].name for param in STRATEGIES}
    heirs = [
        f"{relative(path)}:{node.lineno} class {node.name}({ast.unparse(base)})"
        for path in ALL_FILES
        for node in classes(path)
        for base in node.bases
        if ast.unparse(base).split(".")[-1] in strategies
    ]
    assert not heirs
