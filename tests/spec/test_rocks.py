"""Rocks in files: the shelf, `--rock` in scenes, and sheets that are wrong."""

import os
import random
import warnings
from dataclasses import replace
from pathlib import Path

import pytest
from small_scene import refusal

from rsmpm_ti.errors import RockWarning
from rsmpm_ti.rock.after_failure import CompressionOnly, Void
from rsmpm_ti.rock.heterogeneity import Uniform
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.reading import MAX_BYTES, read_sheet
from rsmpm_ti.scene import main
from rsmpm_ti.spec.library.places import shipped
from rsmpm_ti.spec.library.rocks import list_rocks, load_rock, load_sheet, rocks, rocks_in, with_rock
from rsmpm_ti.spec.loader import load_scene
from rsmpm_ti.spec.review.sentences import review

SHELF = rocks_in(shipped())
ISSUE = (
    "westerly_granite lac_du_bonnet_granite carrara_marble berea_sandstone solnhofen_limestone zigong_sandstone "
    "gregoire_concrete pmma paper_rock"
).split()

GRANITE = {
    "density": "2650 kg/m^3", "E": "55 GPa", "nu": "0.25", "UCS": "160 MPa", "phi": "50 deg", "sigma_t": "9 MPa",
    "K_Ic": "1.4 MPa*m^0.5",
}  # fmt: skip


def text_of(values: dict[str, str], head: str = "") -> str:
    return head + "[rock]\n" + "".join(f'{key} = "{value}"\n' for key, value in values.items())


@pytest.fixture
def sheet(tmp_path):
    """Writes a sheet and gives its path."""

    def write(values: dict[str, str] | str, head: str = "") -> str:
        path = tmp_path / "granite.toml"
        path.write_text(values if isinstance(values, str) else text_of(values, head), encoding="utf-8")
        return str(path)

    return write


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
        own = load_scene(scene).rock.after_failure
        assert type(load_scene(scene, rock="paper_rock").rock.after_failure) is type(own)
        with pytest.warns(RockWarning, match="UCS over sigma_t is 1.96"):
            assert load_scene(scene, rock="pmma", strain_end=0.01).rock.after_failure == CompressionOnly()
    path = sheet(GRANITE | {"law": "lab"})
    assert load_scene("cube", rock=path, strain_end=1e-3).rock == Rock.from_lab(**GRANITE)
    void = load_scene("cube", rock="paper_rock", settings={"rock.after_failure": "Void"})
    assert void.rock.after_failure == Void()


def test_end_that_was_chosen_for_another_rock_is_told():
    with pytest.warns(RockWarning, match="this one breaks at 3 times the strain: set strain_end=0.0024 to"):
        load_scene("cube_lab", rock="westerly_granite")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        load_scene("cube_lab", rock="westerly_granite", strain_end=2.4e-3)
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


def test_name_that_is_none_is_refused_with_those_there_are():
    said = refusal(lambda: load_rock("westerly"))
    assert said.startswith("no rock named 'westerly'; there are: berea_sandstone, ") and "did you mean westerly" in said


KEYS = sorted(GRANITE)


def wrong_unit(r: random.Random) -> str:
    """Another dimension, no unit, other capitals, a number of another size."""
    key = r.choice([key for key in KEYS if key != "nu"])
    number, unit = GRANITE[key].split(" ")
    small = unit.swapcase() if key != "phi" else "mm"
    wrong = r.choice(
        [f"{number} s", number, f"{number} {small}", f"{float(number) * 1e-5:.9f} {unit}", f"-{number} {unit}"]
    )
    return text_of(GRANITE | {key: wrong})


def bare_number(r: random.Random) -> str:
    key = r.choice([key for key in KEYS if key != "nu"])
    return text_of(GRANITE).replace(
        f'{key} = "{GRANITE[key]}"', f"{key} = {r.choice(['55', '55e9', 'true', '[55]', 'nan'])}"
    )


def typo(r: random.Random) -> str:
    key = r.choice(KEYS)
    other = r.choice([f"{key}x", key.swapcase(), f"{key}_MPa", key[::-1] + "q"])
    return text_of({other if name == key else name: value for name, value in GRANITE.items()})


def missing(r: random.Random) -> str:
    left_out = r.sample([key for key in KEYS if key != "K_Ic"], r.choice([1, 2]))
    return text_of({key: value for key, value in GRANITE.items() if key not in left_out})


def contradictory(r: random.Random) -> str:
    wrong = r.choice(
        [
            {"UCS": f"{r.uniform(10, 58):.1f} MPa"}, {"phi": f"{r.uniform(70.5, 89):.1f} deg"}, {"G_f": "30 J/m^2"},
            {"cohesion": "30 MPa"}, {"BTS": "10 MPa"}, {"phi_r": "55 deg"}, {"sigma_t": f"{r.uniform(25, 200):.0f}MPa"},
        ]
    )  # fmt: skip
    return text_of(GRANITE | wrong)


def no_sheet(r: random.Random) -> str:
    good = text_of(GRANITE)
    return r.choice(
        [
            good.replace('"', ""), good + "[rock]\n", good + "[more]\n", 'E = "55 GPa"\n' + good, "rock = 3\n",
            good + '[estimated]\nE = "55 GPa"\n', good + '[sources]\nT_0 = "x"\n', good + "[sources]\nE = 3\n",
            "a = " + "[" * 3000 + "\n", "name = 3\n" + good, 'name = "a\\u0007"\n' + good, "#" * MAX_BYTES + "#\n",
            "", good.replace("55 GPa", "1e999 GPa"), good.replace("55 GPa", "__import__('os').abort()"),
        ]
    )  # fmt: skip


FAMILIES = (wrong_unit, bare_number, typo, missing, contradictory, no_sheet)


@pytest.mark.parametrize("number", range(60))
def test_wrong_sheet_is_refused_in_one_clear_line_before_anything_is_built(number, sheet, capsys, monkeypatch):
    """Ten of each family, by a fixed seed."""
    path = sheet(FAMILIES[number % len(FAMILIES)](random.Random(number)))
    monkeypatch.setattr("rsmpm_ti.scene.load_scene", lambda *_, **__: pytest.fail("the scene was built"))
    assert main(["cube", "--rock", path]) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and len(err) < 800
    assert err.startswith("rsmpm_ti: ") and path in err
    assert any(
        word in err
        for word in (
            "must be",
            "give one of them",
            "missing",
            "did you mean",
            "it has",
            "TOML",
            "leave",
            "has no",
            "which",
        )
    ), err


@pytest.mark.parametrize("ratio", [4.5, 6.0, 7.9])
def test_brittleness_below_that_of_open_cracks_is_doubted_in_one_line(ratio, sheet, capsys):
    """Not refused: weak sandstones and mudstones have less than 8."""
    path = sheet(GRANITE | {"phi": "35 deg", "UCS": f"{9 * ratio} MPa", "G_f_II": "2 kJ/m^2"})
    assert main(["cube_lab", "--rock", path, "--check"]) == 0
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and f"UCS over sigma_t is {ratio:g}, and open cracks alone make it 8" in err


@pytest.mark.parametrize("make", ["folder", "fifo", "binary", "absent"])
def test_what_is_no_sheet_is_refused_in_one_line(make, tmp_path, capsys):
    path: Path = tmp_path / "x.toml"
    if make == "folder":
        path.mkdir()
    elif make == "fifo":
        os.mkfifo(path)
    elif make == "binary":
        path.write_bytes(bytes(range(256)))
    assert main(["cube", "--rock", str(path)]) == 2
    err = capsys.readouterr().err
    assert err.count("\n") == 1 and err.startswith(f"rsmpm_ti: {path}: ")
