"""Rocks by name: in ./scenes/rocks first, then on the shelf that ships; and a scene with another rock."""

import difflib
import os
import warnings
from dataclasses import replace
from pathlib import Path

from rsmpm_ti.errors import RockWarning, SceneError, short, shown
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.reading import displayed, read_sheet
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.spec.bodies.rocks import named_rocks
from rsmpm_ti.spec.library.places import HERE, shipped
from rsmpm_ti.spec.scene import Scene

SHOWN = ("density", "E", "nu", "UCS", "cohesion", "phi", "sigma_t", "BTS", "K_Ic", "G_f", "G_f_II")
"""Keys of a sheet that a listing has room for."""

LATER = 1.1
"""Times the strain from which on a rock is said to break later than the scene's own."""


def rocks_in(folder: Path) -> dict[str, Path]:
    """Rock name -> file."""
    return {path.stem: path for path in sorted((folder / "rocks").glob("*.toml"))}


def rocks() -> dict[str, Path]:
    """Rock name -> file; ./scenes/rocks wins."""
    return rocks_in(shipped()) | rocks_in(HERE)


def find_rock(name: str) -> Path:
    """A path that ends in .toml as given, else a rock by name, however it is spelled: Westerly-Granite."""
    if name.endswith(".toml"):
        return Path(name)
    shelf = rocks()
    wanted = name.strip().lower().replace(" ", "_").replace("-", "_")
    if wanted in shelf:
        return shelf[wanted]
    close = difflib.get_close_matches(wanted[:100], shelf, n=1)
    hint = f"; did you mean {close[0]}?" if close else ""
    raise SceneError(
        f"no rock named {shown(name)}; there are: {', '.join(sorted(shelf))} (or a path that ends in .toml){hint}"
    )


def load_sheet(name: str | os.PathLike) -> DataSheet:
    """The data sheet of a rock of the shelf, or that in a .toml file. Raises SceneError."""
    name = os.fspath(name)
    path = find_rock(name)
    hidden = rocks_in(shipped()).get(path.stem)
    if not name.endswith(".toml") and hidden and os.path.realpath(hidden) != os.path.realpath(path):
        said = (
            f"rock {path.stem} is {path} of the current folder, not the one that ships, {hidden}; give a path to choose"
        )
        warnings.warn(said, RockWarning, stacklevel=2)
    return read_sheet(path)


def load_rock(name: str | os.PathLike, *, dx: float | None = None) -> Rock:
    """The `Rock` of the shelf, or of a .toml file, for a scene with cells of dx [m]; warns by RockWarning, raises
    SceneError."""
    return Rock.from_sheet(load_sheet(name), dx=dx)


def for_scene(sheet: DataSheet, scene: Scene) -> DataSheet:
    """A sheet that says by which rule its rock breaks: where it leaves that open, by the scene's."""
    if sheet.law is not None:
        return sheet
    return replace(sheet, law="lab" if isinstance(scene.rock.after_failure, Directional) else "paper")


def with_rock(scene: Scene, rock: Rock | DataSheet) -> Scene:
    """A scene with another rock in place of its own; bodies with a rock of theirs keep it, which a RockWarning says.

    A `Rock` is taken as it is. A sheet leaves what it says nothing of as it was, which is the test's: the rule by which
    rock breaks, plane stress, viscosity, heterogeneity. It names itself in the title, and colours follow its tensile
    strength. Raises SceneError where this scene cannot break such rock.
    """
    kept = [name for name, _ in named_rocks(scene)[1:]]
    if kept:
        said = f"{', '.join(kept)}: kept; another rock takes the place of the scene's alone"
        warnings.warn(said, RockWarning, stacklevel=2)
    if isinstance(rock, Rock):
        return replace(scene, rock=rock)
    old, sheet = scene.rock, for_scene(rock, scene)
    new = Rock.from_sheet(sheet, dx=scene.domain.dx)
    new = replace(new, viscosity=old.viscosity, heterogeneity=old.heterogeneity)
    if getattr(old.elasticity, "plane_stress", False):
        new = replace(new, elasticity=replace(new.elasticity, plane_stress=True))
    if rock.law is None and sheet.law == "paper":
        new = replace(new, after_failure=old.after_failure)
    output, strength = scene.output, getattr(old.criterion, "tensile_strength", None)
    if output.stress_limit is not None and strength:
        output = replace(output, stress_limit=output.stress_limit * sheet.tensile_strength / strength)
    try:
        return replace(scene, rock=new, title=f"{scene.title}; {sheet.name}"[:200], output=output)
    except SceneError as error:
        raise SceneError(f"rock {short(sheet.name)} in this scene: {error}") from None


def ends_early(scene: Scene, own: Rock) -> str:
    """A sentence where a scene whose end was chosen for its own rock ends sooner for another; "" elsewhere.

    Strains at failure go as sigma_t/E at a flaw by the paper's rule, and up to the peak as UCS/E.
    """
    name = "ucs" if isinstance(scene.rock.after_failure, Directional) else "tensile_strength"
    strains = []
    for rock in (own, scene.rock):
        strength, modulus = getattr(rock.criterion, name, None), getattr(rock.elasticity, "E", None)
        if not strength or not modulus:  # unbreakable, or laws of a scene's own
            return ""
        strains.append(strength / modulus)
    end, ratio = scene.schedule.strain_end, strains[1] / strains[0]
    if end is None or ratio <= LATER:
        return ""
    why = f"chosen for its own rock, and this one breaks at {ratio:.3g} times the strain"
    return f"the scene ends at a strain of {end:g}, {why}: set strain_end={ratio * end:.2g} to load it as far"


def described(sheet: DataSheet, dx: float | None) -> list[str]:
    """A sheet in a few lines: its numbers, those that are estimated, and what follows of them."""
    given = [key for key in SHOWN if getattr(sheet, key) is not None]
    numbers = [f"{key} {displayed(key, getattr(sheet, key))}{'*' * (key in sheet.estimated)}" for key in given]
    half = (len(numbers) + 1) // 2
    marked = ["* estimated: not from the sheet's source"] if set(given) & set(sheet.estimated) else []
    return [sheet.name, ", ".join(numbers[:half]), ", ".join(numbers[half:]), *marked, *sheet.derived(dx)]


def list_rocks() -> str:
    """The shelf: name, numbers, and which of them are estimated."""
    lines = []
    for name, path in rocks().items():
        try:
            sheet = read_sheet(path)
        except SceneError as error:  # one bad file does not hide the others
            lines.append(f"{name:<24} cannot be read: {' '.join(str(error).split())}")
            continue
        what, *numbers = described(sheet, None)
        lines.append(f"{name:<24} {what}: {sheet.source}".rstrip(": "))
        lines += [f"{'':<24} {line}" for line in numbers[:2]]
    return "\n".join([*lines, "* estimated; python -m rsmpm_ti.scene SCENE --rock NAME --check says what follows"])
