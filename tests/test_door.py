"""The public door: every name in one place, commands that can be listed, and a line where a package is missing."""

import ast
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import rsmpm_ti
from rsmpm_ti.__main__ import COMMANDS, main

ROOT = Path(__file__).resolve().parent.parent
PYPROJECT = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
MODULE_OF = {"pillow": "PIL", "lazy-loader": "lazy_loader", "annotated-types": "annotated_types"}
MOVIE = {"imageio", "imageio-ffmpeg"}  # a movie is not written without them, but a run goes on
FIRST_USE = {"pint", "shapely"}  # imported where a text with a unit is met, and an outline
OLD_PYTHON = {"tomli"} if sys.version_info >= (3, 11) else set()  # which has none of its own


def test_every_public_name_is_there():
    assert len(rsmpm_ti.__all__) > 50
    assert [name for name in rsmpm_ti.__all__ if not hasattr(rsmpm_ti, name)] == []


@pytest.mark.parametrize("path", sorted((ROOT / "scenes").glob("*.py")), ids=lambda path: path.stem)
def test_shipped_scene_uses_the_door_alone(path):
    imported = [
        node for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, (ast.Import, ast.ImportFrom))
    ]
    modules = {node.module if isinstance(node, ast.ImportFrom) else node.names[0].name for node in imported}
    assert {module for module in modules if module.startswith("rsmpm_ti")} == {"rsmpm_ti"}


def test_needed_packages_are_those_of_the_project():
    block = re.search(r"^dependencies = \[\n(.*?)^\]", PYPROJECT, re.MULTILINE | re.DOTALL)[1]
    listed = {re.match(r'\s*"([\w-]+)', line)[1] for line in block.splitlines()}
    needed = {MODULE_OF.get(name, name) for name in listed - MOVIE - FIRST_USE - OLD_PYTHON}
    assert needed <= set(rsmpm_ti.NEEDED)


def without_packages(*arguments: str) -> subprocess.CompletedProcess:
    """A Python that finds this package and the standard library, as one outside .venv does."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")} | {"PYTHONPATH": str(ROOT)}
    return subprocess.run(
        [sys.executable, "-S", *arguments], env=environment, capture_output=True, text=True, timeout=60
    )


@pytest.mark.parametrize("module", ["rsmpm_ti", *(f"rsmpm_ti.{name}" for name in COMMANDS)])
def test_missing_package_is_one_line_that_says_make(module):
    done = without_packages("-m", module)
    assert done.returncode == 2 and done.stdout == ""
    (line,) = done.stderr.splitlines()
    assert "taichi" in line and "make" in line and "pip install" in line


def test_missing_package_is_an_import_error_for_a_script():
    done = without_packages("-c", "import rsmpm_ti")
    assert done.stderr.splitlines()[-1].startswith("ImportError: rsmpm_ti needs taichi")


def test_commands_are_listed_and_run(capsys):
    assert main([]) == 0
    listed = capsys.readouterr().out
    assert all(re.search(rf"^  {name} +\S", listed, re.MULTILINE) for name in COMMANDS)
    assert main(["scene", "--list"]) == 0 and "cube_lab" in capsys.readouterr().out
    assert main(["verify", "--list"]) == 0 and "slit_field" in capsys.readouterr().out
    assert main(["nonsense"]) == 2 and "there are scene, lab, verify" in capsys.readouterr().err


def test_console_command_is_the_same():
    assert re.search(r'^rsmpm_ti = "rsmpm_ti.__main__:main"$', PYPROJECT, re.MULTILINE)
