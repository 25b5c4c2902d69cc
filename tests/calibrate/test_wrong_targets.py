"""Files of targets that are wrong: each is one line that names the key, before anything runs."""

import os
import re
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rsmpm_ti.calibrate.__main__ import main
from rsmpm_ti.calibrate.targets.measured import Curve
from rsmpm_ti.calibrate.targets.reading import read_wanted
from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.sheet.toml_file import MAX_BYTES

PAGE = Path(__file__).resolve().parents[2] / "docs" / "calibrate.md"
EXAMPLE = re.search(r"```toml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)[1]

PARAMETERS = '[parameters]\nE = ["20 GPa", "90 GPa"]\n'
TARGETS = '[targets]\nucs.UCS = { value = "160 MPa", error = "8 MPa" }\n'
GOOD = PARAMETERS + TARGETS


def parameter(line: str) -> str:
    return f"[parameters]\n{line}\n{TARGETS}"


def target(line: str) -> str:
    return f"{PARAMETERS}[targets]\n{line}\n"


CURVE = 'ucs.curve = { file = "curve.csv" }'

WRONG = {
    "empty": ("", "parameters = 0 is refused: it must be 1 to 6 keys"),
    "no TOML": ("E = = 3", "it is no TOML"),
    "unknown table": (GOOD + "[target]\n", "no place for 'target': it holds parameters, targets, confinements, budget"),
    "unknown table, near": (GOOD + "[budgets]\n", "did you mean budget?"),
    "table that is none": ("budget = 3\n" + GOOD, "budget = 3 is refused: it must be a table, [budget]"),
    "no targets": (PARAMETERS, "[targets] is missing or empty"),
    "unknown parameter": (parameter('young = ["1 GPa", "2 GPa"]'), "[parameters] has 'young'"),
    "unknown parameter, near": (parameter('young = ["1 GPa", "2 GPa"]'), "did you mean E?"),
    "parameter that is a word": (parameter('law = ["lab", "paper"]'), "'law', which is none of density, E, nu"),
    "same twice": (
        parameter('UCS = ["90 MPa", "200 MPa"]\ncohesion = ["9 MPa", "50 MPa"]'), "UCS and cohesion, which say the same"
    ),
    "one bound": (parameter('E = ["20 GPa"]'), "parameters.E = ['20 GPa'] is refused: it must be a lower and an upper"),
    "bound without unit": (parameter("E = [20, 90]"), "[parameters] E = 20 is refused: it must be 0.1 GPa to 200 GPa"),
    "bound of another dimension": (parameter('E = ["20 mm", "90 GPa"]'), "[parameters] E = '20 mm' is refused"),
    "bound of no rock": (parameter('E = ["20 GPa", "900 GPa"]'), "E = '900 GPa' is refused: it must be 0.1 GPa to 200"),
    "bounds exchanged": (parameter('E = ["90 GPa", "20 GPa"]'), "are they exchanged?"),
    "bounds alike": (parameter('E = ["20 GPa", "20 GPa"]'), "1 % above it or more"),
    "unknown test": (target('ucz.UCS = { value = "1 MPa" }'), "'ucz', which is no test; the tests are ucs, brazilian"),
    "unknown test, near": (target('brazil.BTS = { value = "1 MPa" }'), "did you mean brazilian?"),
    "test without a quantity": (target('ucs = "160 MPa"'), "targets.ucs = '160 MPa' is refused: it must be a quantity"),
    "unknown quantity": (target('ucs."E tangen" = { value = "1 GPa" }'), "ucs reports no 'E tangen'; it reports UCS"),
    "unknown quantity, near": (target('ucs."E tangen" = { value = "1 GPa" }'), "did you mean E tangent?"),
    "quantity that is none": (target('ucs."crack closure stress" = { value = "1 MPa" }'), "ucs reports no 'crack"),
    "target that is no table": (target('ucs.UCS = "160 MPa"'), "targets.ucs.UCS = '160 MPa' is refused"),
    "target with another key": (target('ucs.UCS = { value = "1 MPa", eror = "1 MPa" }'), "did you mean error?"),
    "target without value": (target('ucs.UCS = { error = "1 MPa" }'), "targets.ucs.UCS has no value"),
    "value without unit": (target("ucs.UCS = { value = 160 }"), "targets.ucs.UCS.value = 160 is refused"),
    "value of another dimension": (target('ucs.UCS = { value = "160 mm" }'), "its units are MPa, GPa"),
    "value in small letters": (target('ucs.UCS = { value = "160 mpa" }'), "did you mean '160 MPa'?"),
    "value below 0": (target('ucs.UCS = { value = "-160 MPa" }'), "a positive number with its unit"),
    "value that is no number": (target("ucs.\"Poisson's ratio\" = { value = nan }"), "value = nan is refused"),
    "ratio with a unit": (target("ucs.\"Poisson's ratio\" = { value = \"0.2 MPa\" }"), "it has no unit"),
    "error of 0": (target('ucs.UCS = { value = "1 MPa", error = "0 MPa" }'), "targets.ucs.UCS.error = '0 MPa'"),
    "error of 0 %": (target('ucs.UCS = { value = "1 MPa", error = "0 %" }'), "from a millionth of the value"),
    "error too large": (target('ucs.UCS = { value = "1 MPa", error = "1 GPa" }'), "to ten times as large"),
    "pressure that no report names": (target('triaxial."peak at 10.0 MPa" = { value = "1 MPa" }'), "reports no"),
    "residual without a jacket": (target('triaxial."residual at 0 MPa" = { value = "1 MPa" }'), "triaxial reports no"),
    "pressure that is not run": (
        target('triaxial."peak at 10 MPa" = { value = "9 MPa" }') + '[confinements]\ntriaxial = ["0 MPa", "5 MPa"]\n',
        "a list with 10 MPa too",
    ),
    "line through one peak": (
        target('triaxial.cohesion = { value = "9 MPa" }') + '[confinements]\ntriaxial = ["0 MPa"]\n',
        "peaks at two pressures or more",
    ),
    "pressures of no test": (GOOD + '[confinements]\nucs = ["0 MPa"]\n', "[confinements] has no 'ucs'"),
    "pressures that nothing needs": (GOOD + '[confinements]\nshear = ["1 MPa"]\n', "no target needs that test"),
    "pressures that are no list": (
        target('shear.cohesion = { value = "9 MPa" }') + '[confinements]\nshear = "1 MPa"\n', "a list of 1 to 10"
    ),
    "pressure without unit": (
        target('shear.cohesion = { value = "9 MPa" }') + "[confinements]\nshear = [1, 2]\n", "or 1 kPa to 10 GPa"
    ),
    "pressure twice": (
        target('shear.cohesion = { value = "9 MPa" }') + '[confinements]\nshear = ["1 MPa", "1 MPa"]\n', "that differ"
    ),
    "budget too small": (GOOD + "[budget]\nruns = 3\n", "budget.runs = 3 is refused: it must be a whole number from 4"),
    "budget of half a run": (GOOD + "[budget]\nruns = 20.5\n", "budget.runs = 20.5 is refused"),
    "budget that is true": (GOOD + "[budget]\nseeds = true\n", "budget.seeds = True is refused"),
    "budget of hours": (GOOD + "[budget]\nhours = 3\n", "[budget] has no 'hours'; it has runs, seeds"),
    "curve of a disc": (target('brazilian.curve = { file = "c.csv" }'), "curves are compared for ucs, tension only"),
    "curve with a value": (target('ucs.curve = { value = "1 MPa" }'), "targets.ucs.curve has no 'value'"),
    "curve that is not there": (target(CURVE), "targets.ucs.curve.file = 'curve.csv' is refused"),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_wrong_file_is_one_line_before_anything_runs(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("rsmpm_ti.calibrate.calibration.calibrate", lambda *_, **__: pytest.fail("it runs"))
    text, words = WRONG[name]
    (tmp_path / "t.toml").write_text(text)
    assert main(["--rock", "westerly_granite", "--to", "t.toml"]) == 2
    said = capsys.readouterr()
    assert said.out == "" and len(said.err.splitlines()) == 1
    assert said.err.startswith("rsmpm_ti: t.toml: ") and words in said.err
    assert [path.name for path in tmp_path.iterdir()] == ["t.toml"]


CURVES = {
    "header": ("strain,stress\n0,1\n", "the first line of curve.csv is 'strain,stress', not strain,stress_MPa"),
    "nothing": ("", "the first line"),
    "two rows": ("strain,stress_MPa\n0,0\n1e-3,50\n", "a curve of 3 to 20000 rows; it has 2"),
    "words": ("strain,stress_MPa\n0,0\n1e-3,much\n2e-3,3\n", "line 3 is '1e-3,much', not two numbers"),
    "percent": ("strain,stress_MPa\n0,0\n0.1,50\n0.7,70\n", "line 4 is '0.7,70'; it must be a strain from 0 to 0.5"),
    "not finite": ("strain,stress_MPa\n0,0\n0.1,nan\n0.2,70\n", "line 3 is '0.1,nan'"),
    "no load": ("strain,stress_MPa\n0,0\n0.1,-1\n0.2,0\n", "a curve with a stress above 0"),
}


@pytest.mark.parametrize("name", CURVES)
def test_wrong_curve_is_one_line(name, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    text, words = CURVES[name]
    (tmp_path / "curve.csv").write_text(text)
    (tmp_path / "t.toml").write_text(target(CURVE))
    assert main(["--rock", "westerly_granite", "--to", "t.toml"]) == 2
    said = capsys.readouterr().err
    assert len(said.splitlines()) == 1 and words in said


def test_curve_is_read_beside_its_file_of_targets(tmp_path):
    (tmp_path / "curve.csv").write_text("strain,stress_MPa\n0,0\n1e-3,50\n2e-3,80\n")
    (tmp_path / "t.toml").write_text(target(CURVE))
    (curve,) = read_wanted(tmp_path / "t.toml").targets
    assert isinstance(curve, Curve) and curve.stress.tolist() == [0.0, 50e6, 80e6]
    assert curve.error == pytest.approx(4e6) and curve.assumed


def test_file_that_is_none_is_one_line(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "large.toml").write_text("#" * (MAX_BYTES + 1))
    (tmp_path / "binary.toml").write_bytes(b"\xff\xfe\x00")
    (tmp_path / "folder.toml").mkdir()
    os.mkfifo(tmp_path / "pipe.toml")
    for name in ("large", "binary", "folder", "pipe", "missing"):
        assert main(["--rock", "westerly_granite", "--to", f"{name}.toml"]) == 2
        said = capsys.readouterr().err
        assert len(said.splitlines()) == 1 and f"{name}.toml: " in said


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (["--rock", "westerly"], "westerly"),
        (["--rock", "westerly_granite", "--jobs", "0"], "--jobs = 0 is refused"),
        (["--rock", "westerly_granite", "--out", "t.toml"], "--out = 't.toml' is refused: it must be a folder"),
        (["--rock", "westerly_granite", "--out", "full"], "or one of an earlier calibration"),
        (["--rock", "untold.toml"], "BTS needs the rock's kind"),
    ],
)
def test_wrong_options_are_one_line(options, words, tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("of the user")
    (tmp_path / "untold.toml").write_text(
        '[rock]\ndensity = "2650 kg/m^3"\nE = "55 GPa"\nnu = 0.25\nphi = "50 deg"\nUCS = "160 MPa"\nsigma_t = "9 MPa"\n'
    )
    (tmp_path / "t.toml").write_text(parameter('BTS = ["5 MPa", "20 MPa"]'))
    assert main(["--to", "t.toml", *options]) == 2
    said = capsys.readouterr().err
    assert words in said.splitlines()[-1]


def test_target_without_an_error_gets_a_twentieth_and_numbers_their_units(tmp_path):
    (tmp_path / "t.toml").write_text(target(
        'ucs."E tangent" = { value = "45 GPa" }\nucs."Poisson\'s ratio" = { value = 0.2, error = "10 %" }\n'
        'bend."K_Ic by the work of fracture" = { value = "1.4 MPa√m", error = "0.1 MPa*m^0.5" }\n'
        'triaxial."peak at 10 MPa" = { value = "250 MPa" }\nshear.cohesion = { value = "30 MPa" }'
    ))  # fmt: skip
    found = read_wanted(tmp_path / "t.toml")
    assert [(t.value, t.error, t.assumed) for t in found.targets] == [
        (45e9, pytest.approx(2.25e9), True), (0.2, pytest.approx(0.02), False), (1.4e6, 0.1e6, False),
        (250e6, pytest.approx(12.5e6), True), (30e6, pytest.approx(1.5e6), True),
    ]  # fmt: skip
    assert found.confinements == {"triaxial": (10e6,)} and found.tests == ("ucs", "bend", "triaxial", "shear")
    assert (found.runs, found.seeds) == (40, 1)


@given(st.randoms(use_true_random=False))
@settings(max_examples=150, deadline=None)
def test_damaged_file_is_read_or_refused_in_one_line(tmp_path_factory, random):
    """The page's example with bytes dropped, doubled and changed."""
    text = bytearray(EXAMPLE.encode())
    for _ in range(random.randint(1, 4)):
        k = random.randrange(len(text))
        choice = random.randrange(3)
        if choice == 0:
            del text[k : k + random.randint(1, 20)]
        elif choice == 1:
            text[k:k] = text[k : k + random.randint(1, 40)]
        else:
            text[k] = random.randrange(256)
    path = tmp_path_factory.mktemp("damaged") / "t.toml"
    path.write_bytes(bytes(text))
    try:
        read_wanted(path)
    except SceneError as error:
        assert len(str(error).splitlines()) == 1 and "t.toml: " in str(error)
