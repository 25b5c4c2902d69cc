"""Where scenes are found by name: in ./scenes first, then among those that ship."""

import os
from pathlib import Path

import rsmpm_ti
from rsmpm_ti.errors import SceneError, short, shown

PACKAGE = Path(rsmpm_ti.__file__).parent
HERE = Path("scenes")
"""Scenes of whoever works in the current folder."""


def shipped() -> Path:
    """The folder of the scenes that ship: in the package, where it was installed from a wheel, beside it in a checkout.

    Beside an installed package a folder of that name is another's.
    """
    inside = PACKAGE / "scenes"
    return inside if inside.is_dir() else PACKAGE.parent / "scenes"


def scenes_in(folder: Path) -> dict[str, Path]:
    """Scene name -> file."""
    return {path.stem: path for path in sorted(folder.glob("[a-z]*.py"))}


def available() -> dict[str, Path]:
    """Scene name -> file; ./scenes wins."""
    return scenes_in(shipped()) | scenes_in(HERE)


def ships(path: Path) -> bool:
    """Whether a file that was found by name is one of those that ship: in a checkout ./scenes is their folder."""
    return os.path.realpath(path.parent) == os.path.realpath(shipped())


def find(name: str) -> Path:
    """A path as given, else a scene by name."""
    path = Path(name)
    if path.suffix in (".py", ".json"):
        if os.path.isfile(path):  # False also where the system cannot say
            return path
        raise SceneError(f"scene file {short(name)} does not exist, or cannot be read")
    scenes = available()
    if name not in scenes:
        raise SceneError(
            f"no scene named {shown(name)}; there are: {', '.join(sorted(scenes)) or 'none'} (or give a path)"
        )
    return scenes[name]


def in_place_of(name: str, path: Path) -> str:
    """A sentence where a file of ./scenes is taken for a name that a scene which ships has too; "" elsewhere."""
    hidden = scenes_in(shipped()).get(name)
    if hidden is None or path == hidden or ships(path):
        return ""
    return f"scene {name} is {path} of the current folder, not the one that ships, {hidden}; give a path to choose"
