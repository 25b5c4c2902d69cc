"""Rocks in files: the shelf, `--rock` in scenes, and sheets that are wrong."""

import json
import re
import warnings
from dataclasses import replace

import pytest
from annotated_types import Interval
from granite import GRANITE, text_of
from small_scene import refusal

from rsmpm_ti.checks import annotations, within
from rsmpm_ti.errors import RockWarning
from rsmpm_ti.rock.after_failure import CompressionOnly, Void
from rsmpm_ti.rock.heterogeneity import Uniform
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DEFAULTS, DataSheet
from rsmpm_ti.rock.sheet.reading import KEYS as READ
from rsmpm_ti.rock.sheet.reading import displayed, read_sheet
from rsmpm_ti.scene import main
from rsmpm_ti.spec.library.places import shipped
from rsmpm_ti.spec.library.rocks import list_rocks, load_rock, load_sheet, rocks, rocks_in, with_rock
from rsmpm_ti.spec.loader import load_scene
from rsmpm_ti.spec.review.sentences import review
from rsmpm_ti.spec.scene_json import to_plain

SHELF = rocks_in(shipped())
ISSUE = (
    "westerly_granite lac_du_bonnet_granite carrara_marble berea_sandstone solnhofen_limestone zigong_sandstone "
    "gregoire_concrete pmma paper_rock"
).split()


@pytest.mark.parametrize("name", sorted(SHELF))
def test_rock_of_the_shelf_says_of_every_value_where_it_is_from(name):
    found = read_sheet(SHELF[name])
    sources = dict(found.sources)
    assert found.source and found.name != name
    assert all(sources.get(key) for key in found.estimated), "an estimate without its reason"


@pytest.mark.parametrize("scene", ["cube", "cube_lab"])
@pytest.mark.parametrize("name", sorted(SHELF))
def test_rock_of_the_shelf_can_be_tested_and_no_rock_of_it_is_doubted(name, scene):
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        tested = load_scene(scene, rock=name)
        said = review(tested, tested.particles())
    assert tested.title.endswith(read_sheet(SHELF[name]).name)
    if name != "pmma":  # which is no rock, and is said not to be
        doubts = [str(w.message) for w in warned if not str(w.message).startswith("the scene ends at a strain of")]
        assert (said, doubts) == ([], [])


def test_shelf_holds_the_rocks_that_were_asked_for():
    assert set(ISSUE) <= set(SHELF)
    assert load_rock("paper_rock") == lab_rock()
    listed = list_rocks()
    assert all(f"{name:<24} " in listed for name in SHELF) and "E 56 GPa*" in listed


def test_check_says_what_was_derived_and_what_is_estimated(capsys):
    end = ["--set", "strain_end=2.4e-3"]
    assert main(["cube_lab", "--quick", "--rock", "Westerly granite", "--check", *end]) == 0
    out, err = capsys.readouterr()
    assert err == "" and "; Westerly granite\n" in out
    for words in ("UCS 256 MPa", "E 56 GPa*", "cohesion 43.7 MPa from UCS", "averaging_length 2 mm", "* estimated"):
        assert words in out
    assert main(["--rocks"]) == 0 and "lac_du_bonnet_granite" in capsys.readouterr().out


def test_rock_takes_the_place_of_the_scenes_own_and_dotted_names_reach_into_it(sheet):
    path = sheet(GRANITE)
    scene = load_scene(
        "cube_lab", rock=path, strain_end=1e-3, settings={"rock.density": "2700 kg/m^3", "flaw_angle": "30 deg"}
    )
    assert scene.rock == replace(Rock.from_lab(**GRANITE), density=2700.0)
    assert scene.output.stress_limit == pytest.approx(18e6)  # cube_lab's 4 MPa are 2 sigma_t
    sheets = (path, load_sheet(path))
    assert len({load_scene("cube_lab", rock=given, strain_end=1e-3).rock for given in sheets}) == 1
    own = Rock.from_lab(**GRANITE)
    assert load_scene("cube_lab", rock=own, strain_end=1e-3) == replace(
        load_scene("cube_lab", strain_end=1e-3), rock=own
    )


def test_what_a_sheet_says_nothing_of_stays_the_scenes():
    scene = load_scene("intact_weibull", rock="paper_rock", weibull_modulus=9.0)
    assert scene.rock.heterogeneity.shape == 9.0 and scene.rock.heterogeneity != Uniform()
    plate = load_scene("cube_lab", settings={"rock.elasticity.plane_stress": "true"})
    assert with_rock(plate, load_sheet("paper_rock")).rock.elasticity.plane_stress


@pytest.mark.parametrize("scene, key", [("cube_lab", "G_f_I"), ("cube_lab", "length"), ("disc_lab", "length")])
def test_keyword_of_the_rock_that_is_replaced_is_refused(scene, key):
    said = refusal(lambda: load_scene(scene, rock="paper_rock", settings={key: "3e-3"}))
    assert said.startswith(f"{key} is of the scene's own rock, which another takes the place of; leave it out")
    assert load_scene(scene, rock="paper_rock", settings={"flaw_width": "4 mm"})


def test_cells_too_large_for_a_length_that_is_given_are_refused_with_the_rocks_name(sheet):
    path = sheet(GRANITE | {"averaging_length": "1 mm", "G_f_II": "2 kJ/m^2"}, 'name = "My granite"\n')
    said = refusal(lambda: load_scene("cube_lab", quick=True, rock=path))
    assert said.startswith("rock My granite in this scene: rock.nonlocal_mean.length = 0.001 is refused")
    assert "use dx of at most 0.0005 m" in said


def test_cells_too_large_for_an_energy_are_refused_with_a_size_that_will_do(sheet):
    brittle = GRANITE | {"K_Ic": "0.1 MPa*m^0.5", "G_f_II": "2 kJ/m^2"}
    with pytest.warns(RockWarning, match="in tension"):
        said = refusal(lambda: load_scene("cube_lab", rock=sheet(brittle)))
    assert said.startswith("rock granite in this scene: after_failure.softening.G_f_I = ")
    size = float(said.partition("use a dx below ")[2].split(" m")[0])
    with pytest.warns(RockWarning, match="in tension"):
        rock = Rock.from_lab(**brittle)
    shape = load_scene("cube_lab").shape
    rock.after_failure.check(rock, shape, 0.99 * size)
    assert "does not snap back" in refusal(lambda: rock.after_failure.check(rock, shape, 1.01 * size))


def test_rock_breaks_by_the_rule_of_the_scene_unless_its_sheet_says_by_which(sheet):
    for scene in ("cube", "cube_lab"):
        assert load_scene(scene, rock="paper_rock").rock == load_scene(scene).rock
        with pytest.warns(RockWarning, match="UCS over sigma_t is 1.96"):
            assert load_scene(scene, rock="pmma", strain_end=0.01).rock.after_failure == CompressionOnly()
    path = sheet(GRANITE | {"law": "lab"})
    assert load_scene("cube", rock=path, strain_end=1e-3).rock == Rock.from_lab(**GRANITE)
    void = load_scene("cube", rock="paper_rock", settings={"rock.after_failure": "Void"})
    assert void.rock.after_failure == Void()


def test_end_that_was_chosen_for_another_rock_is_told():
    with pytest.warns(RockWarning, match="this one breaks at 3.05 times the strain: set strain_end=0.0027 to"):
        load_scene("cube_lab", rock="westerly_granite")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_scene("cube_lab", rock="westerly_granite", strain_end=2.7e-3)
        load_scene("cube_lab", rock="westerly_granite", settings={"t_end": "1 ms", "strain_end": "none"})
        load_scene("cube_lab", rock="paper_rock")


def test_rock_of_the_current_folder_wins_and_is_told(tmp_path, monkeypatch):
    (tmp_path / "scenes" / "rocks").mkdir(parents=True)
    for name in ("pmma", "mine"):
        (tmp_path / "scenes" / "rocks" / f"{name}.toml").write_text(text_of(GRANITE))
    monkeypatch.chdir(tmp_path)
    assert load_sheet("mine").UCS == 160e6 and "mine" in rocks()
    with pytest.warns(RockWarning, match="rock pmma is scenes/rocks/pmma.toml of the current folder, not the one"):
        assert load_sheet("pmma").name == "pmma"


def test_recorded_scene_takes_another_rock(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text(json.dumps(to_plain(load_scene("cube_lab"))))
    assert load_scene(str(path), rock="paper_rock").rock == lab_rock()


def test_what_is_no_rock_is_refused(capsys):
    assert refusal(lambda: load_scene("cube", rock=3)).startswith("rock = 3 is refused: it must be a Rock")
    assert main(["cube", "--rock", ""]) == 2 and "no rock named ''" in capsys.readouterr().err


def test_name_that_is_none_is_refused_with_those_there_are():
    said = refusal(lambda: load_rock("westerly"))
    assert said.startswith("no rock named 'westerly'; there are: berea_sandstone, ") and "did you mean westerly" in said


PAGE = (shipped().parent / "docs" / "rocks.md").read_text(encoding="utf-8")


def shelf_row(name: str) -> str:
    """A row of the page's table; a star marks what is estimated, brackets what is derived."""
    found = read_sheet(SHELF[name])

    def cell(key: str, derived: str = "") -> str:
        value = getattr(found, key)
        if value is None:
            return derived
        return displayed(key, value).partition(" ")[0] + "*" * (key in found.estimated)

    energies = ("-", "-")
    if found.law != "paper":
        energies = (f"({found.tension_energy:.3g})", f"({found.shear_energy:.3g})")
    cells = (
        cell("density"), cell("E"), cell("nu"), cell("UCS", f"({found.compressive_strength / 1e6:.3g})"), cell("phi"),
        cell("sigma_t"), cell("G_f", energies[0]), cell("G_f_II", energies[1]), found.source,
    )  # fmt: skip
    return f"| `{name}` | {' | '.join(cells)} |"


def test_page_of_rocks_holds_the_shelf():
    assert "\n".join(shelf_row(name) for name in sorted(SHELF)) in PAGE


def test_page_of_rocks_holds_every_default_and_every_key():
    rows = "\n".join(f"| `{key}` | {' | '.join(parts)} |" for key, parts in DEFAULTS.items())
    assert rows in PAGE
    for key in READ:
        bounds = next((part for part in within(annotations(DataSheet)[key]) if isinstance(part, Interval)), None)
        if bounds is not None:
            low, high = displayed(key, bounds.ge).partition(" ")[0], displayed(key, bounds.le)
            assert f"`{key}` | {low} to {high} |" in PAGE, f"| `{key}` | {low} to {high} |"


def test_sheet_of_the_page_is_read(tmp_path):
    (text,) = re.findall(r"```toml\n(.*?)```", PAGE, re.DOTALL)
    (tmp_path / "granite.toml").write_text(text, encoding="utf-8")
    found = read_sheet(tmp_path / "granite.toml")
    assert found.name == "My granite" and found.estimated == ("phi",) and dict(found.sources)["phi"]


def test_python_of_the_page_runs():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    names: dict = {}
    with pytest.warns(RockWarning, match="the scene ends at a strain of"):
        exec(code, names)
    assert names["granite"] == Rock.from_lab(**GRANITE) and names["scene"].title.endswith("; Zigong sandstone")
