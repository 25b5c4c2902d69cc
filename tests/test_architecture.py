"""The shape of the code, read from the code: layers, what may import Taichi, and what Taichi does not forgive."""

import ast
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGE = ROOT / "rsmpm_ti"

LAYERS = """
    errors units snapshot kinds tensors regions seeding heterogeneity shape transfer averaging softening directional
    laws rocks confinement boundaries starts quasi_static time_step consistency spec traversal grid state sorting
    stencil crack_stress material wall_nodes node_update kernels smoothing tracking margin measure leaving stepper
    observe readout drive nominal cracks parting summary output fracture checkpoint record paint frames gallery writer
    library result run_folder stopping kernel_cache compiling run writer_process scene verify stress study bench
""".split()
"""A module imports only from modules to the left of its own name."""

CRACK_LAYERS = "path wings tips growth aperture bands fragments emission".split()
PAINT_LAYERS = "view layout chrome raster ggui kinds png figure summary movie".split()
"""The same within `rsmpm_ti/paint/`, which sees nothing else of the package than PAINT_SEES."""

VERIFY_LAYERS = """
    case drives fe_field meshing finite_elements closed_forms exact_motion bodies relaxation waves manufactured specimen
    triaxial cell material_point crack_forms crack_paths cracked_cell envelope disc hole slit_field first_failure
    weibull catalogue report running command __main__
""".split()
STRESS_LAYERS = (
    "pieces steps crossing elastic motion labels impact failing invariance restart catalogue __main__".split()
)
STUDY_LAYERS = """
    runs flaw_cracks turned grid_independence fracture_energy shear_band gmts mean_stress flaw_angle catalogue __main__
""".split()
BENCH_LAYERS = "settings yardstick workers speed passes scaling start runs measures front error __main__".split()
"""The same within the packages cracks, verify, stress, study and bench, which see every layer above their own name."""

ROOMS = {
    "cracks": CRACK_LAYERS,
    "paint": PAINT_LAYERS,
    "verify": VERIFY_LAYERS,
    "stress": STRESS_LAYERS,
    "study": STUDY_LAYERS,
    "bench": BENCH_LAYERS,
}

PAINT_SEES = {"errors", "units", "snapshot"}
WITHOUT_TAICHI = (
    """
    errors units snapshot regions seeding heterogeneity output nominal cracks
""".split()
    + [f"cracks.{name}" for name in CRACK_LAYERS]
)
STRATEGY_FILES = ["heterogeneity", "shape", "transfer", "laws", "boundaries", "averaging", "softening", "directional"]
MAY_INIT = {"rsmpm_ti/run.py", "tests/conftest.py"}
VAGUE = {"util", "utils", "helper", "helpers", "manager", "managers", "engine", "engines"}
MOST_LINES = 350

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
    """The module of this package that a dotted import loads; None for other packages and for the version."""
    if name.split(".")[0] != "rsmpm_ti" or name == "rsmpm_ti.__version__":
        return None
    while name not in MODULES and name.partition(".")[2] not in LAYERS:
        name = name.rpartition(".")[0]
    return name


def allowed_imports(module: str) -> set[str]:
    """Names, without the leading "rsmpm_ti.", that a listed module may import from this package."""
    crackers = [f"cracks.{name}" for name in CRACK_LAYERS]
    painters = [f"paint.{name}" for name in PAINT_LAYERS]
    verifiers = [f"verify.{name}" for name in VERIFY_LAYERS]
    stresses = [f"stress.{name}" for name in STRESS_LAYERS]
    benches = [f"bench.{name}" for name in BENCH_LAYERS]
    studies = [f"study.{name}" for name in STUDY_LAYERS]
    if module == "":  # rsmpm_ti/__init__.py hands out the surface
        return {"library", "run"}
    if module == "paint":
        return PAINT_SEES | set(painters)
    if module in painters:
        return PAINT_SEES | set(painters[: painters.index(module)])
    above = set(LAYERS[: LAYERS.index(module.partition(".")[0])])
    if "cracks" in above:
        above |= set(crackers)
    if "paint" in above:
        above |= set(painters)
    if "verify" in above:
        above |= set(verifiers)
    for rooms in (crackers, verifiers, stresses, studies, benches):
        if module in rooms:
            above |= set(rooms[: rooms.index(module)]) | {""}
    return above


def test_every_package_is_installed():
    """A folder that pyproject.toml does not name is in a checkout and in no wheel."""
    listed = re.search(r"^packages = \[(.*?)\]$", (ROOT / "pyproject.toml").read_text(), re.MULTILINE | re.DOTALL)
    packages = {dotted(path) for path in PACKAGE_FILES if path.name == "__init__.py"}
    assert set(re.findall(r'"([\w.]+)"', listed[1])) == packages | {"rsmpm_ti.scenes"}


@each(PACKAGE_FILES)
def test_module_imports_only_from_layers_above(path):
    module = dotted(path).partition(".")[2]
    package, _, name = module.partition(".")
    if name:
        assert name in ROOMS[package], (
            f"{relative(path)} is in no layer: add it to {package.upper()}_LAYERS in {relative(Path(__file__))}, to "
            "the right of every module it imports and to the left of every module that imports it"
        )
    elif module:
        assert module in LAYERS, (
            f"{relative(path)} is in no layer: add {module!r} to LAYERS in {relative(Path(__file__))} (and to the list "
            "in the design), to the right of every module it imports and to the left of every module that imports it"
        )
    allowed = allowed_imports(module)
    for line, name in imported_names(path):
        target = own_module(name)
        assert target is None or target.partition(".")[2] in allowed, (
            f"{relative(path)}:{line} imports {name}, which is not above it; it may import {sorted(allowed)}"
        )


def test_layers_name_no_module_that_is_gone():
    if "rsmpm_ti.scene" not in MODULES:
        pytest.skip("the last layer, rsmpm_ti/scene.py, is not written yet")
    listed = {f"rsmpm_ti.{name}" for name in LAYERS}
    listed |= {f"rsmpm_ti.{package}.{name}" for package, names in ROOMS.items() for name in names}
    assert listed - set(MODULES) == set(), "LAYERS or one of ROOMS names modules that do not exist"


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
    modules = [f"rsmpm_ti.{module}" for module in WITHOUT_TAICHI]
    assert set(modules) <= set(MODULES)
    for module, loaded in loaded_by(*modules).items():
        direct = {name.partition(".")[0] for _, name in imported_names(MODULES[module])}
        assert "taichi" not in direct | loaded, module


def test_importing_the_package_is_light():
    loaded = loaded_by("rsmpm_ti")["rsmpm_ti"]
    assert "rsmpm_ti" in loaded
    assert not loaded & {"taichi", "matplotlib", "imageio"}


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
    pytest.param(MODULES[f"rsmpm_ti.{file}"], node, id=f"{file}.{node.name}")
    for file in STRATEGY_FILES
    if f"rsmpm_ti.{file}" in MODULES
    for node in classes(MODULES[f"rsmpm_ti.{file}"])
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
