"""Data sheets that are wrong: each is one clear line, before anything is built."""

import os
import random
from pathlib import Path

import pytest
from granite import GRANITE, text_of
from hypothesis import given, settings
from hypothesis import strategies as st

from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.sheet.reading import read_sheet
from rsmpm_ti.rock.sheet.toml_file import MAX_BYTES
from rsmpm_ti.scene import main

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


PIECES = (
    '"', "=", "[", "]", "\n", "1e9999", "-0", "nan", "inf", "true", "1979-05-27", "{a=1}", "[1,2]", '"55 GPa"', "MPa",
    "√", "\u202e", "\x00", '"""', "'", "#", "0x10", "1_000", "9" * 5000,
)  # fmt: skip


@given(st.lists(st.tuples(st.integers(0, 150), st.integers(0, 6), st.sampled_from(PIECES)), min_size=1, max_size=3))
@settings(max_examples=300, derandomize=True, deadline=None)
def test_damaged_sheet_is_read_or_refused_in_one_line(tmp_path_factory, cuts):
    text = text_of(GRANITE)
    for start, length, piece in cuts:
        text = text[:start] + piece + text[start + length :]
    path = tmp_path_factory.getbasetemp() / "damaged.toml"
    path.write_text(text, encoding="utf-8")
    try:
        read_sheet(path)
    except SceneError as error:
        assert str(error).startswith(f"{path}: ") and "\n" not in str(error) and len(str(error)) < 1200
