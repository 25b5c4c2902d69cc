"""A source distribution holds every file of the checkout, so that its tests pass where it is unpacked."""

import re
import subprocess
from pathlib import Path, PurePath

import pytest

ROOT = Path(__file__).resolve().parent.parent

ALWAYS = {"pyproject.toml", "README.md", "LICENSE", "MANIFEST.in"}
"""Taken by setuptools of itself, besides the packages' Python files."""


def test_a_source_distribution_holds_every_file():
    listed = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True)
    if listed.returncode:
        pytest.skip("no git checkout")
    manifest = (ROOT / "MANIFEST.in").read_text(encoding="utf-8")
    grafted = tuple(f"{folder}/" for folder in re.findall(r"^graft (.+)$", manifest, re.MULTILINE))
    included = {name for line in re.findall(r"^include (.+)$", manifest, re.MULTILINE) for name in line.split()}
    project = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    data = re.findall(r'^"(rsmpm_ti[\w.]*)" = \[(.*)\]$', project, re.MULTILINE)
    patterns = [
        f"{package.replace('.', '/')}/{name}" for package, names in data for name in re.findall(r'"(.+?)"', names)
    ]
    missing = [
        name
        for name in listed.stdout.splitlines()
        if name not in ALWAYS | included
        and not name.startswith(grafted)
        and not (name.startswith(("rsmpm_ti/", "scenes/")) and name.endswith(".py"))
        and not any(PurePath(name).match(pattern) for pattern in patterns)
    ]
    assert missing == []
