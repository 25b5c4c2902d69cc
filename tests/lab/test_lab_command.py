"""The command of the laboratory: what it lists, what it refuses, and before what."""

import pytest

from rsmpm_ti.lab.__main__ import main, table
from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.record import set_aside


def test_list_names_every_test_and_its_standard(capsys):
    assert main(["--list"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in said] == list(TESTS)
    assert all("ISRM" in line or "ASTM" in line or "RILEM" in line for line in said)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "name a test"),
        (["ucx"], "there is no test 'ucx'; the tests are ucs"),
        (["ucs", "--size", "50"], "--size = '50' is refused"),
        (["ucs", "--size", "50 MPa"], "--size = '50 MPa' is refused"),
        (["ucs", "--size=-5cm"], "--size"),
        (["ucs", "--dx", "0"], "--dx = '0' is refused"),
        (["ucs", "--confinement", "5MPa"], "but for triaxial and shear"),
        (["triaxial", "--confinement", "5"], "--confinement = '5' is refused"),
        (["triaxial", "--confinement", "5MPa,,"], "--confinement"),
        (["triaxial", "--confinement", "0,5MPa,5000kPa"], "pressures that differ"),
        (["ucs", "--seeds", "0"], "--seeds = 0 is refused"),
        (["ucs", "--jobs", "0"], "--jobs = 0 is refused"),
        (["ucs", "--rock", "westerly"], "westerly"),
        (["ucs", "--rock", "nowhere.toml"], "nowhere.toml"),
    ],
)
def test_what_cannot_be_tested_is_refused_in_a_line(arguments, words, capsys):
    assert main(arguments) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1 and words in said[0]


@pytest.mark.parametrize("name", list(TESTS))
def test_check_tells_the_specimens_of_every_test(name, capsys):
    assert main([name, "--quick", "--seeds", "2", "--rock", "westerly_granite", "--check"]) == 0
    said = capsys.readouterr().out.splitlines()
    count = {"triaxial": 4, "shear": 3}.get(name, 1)
    assert len(said) == 2 * count
    assert all("particles" in line and "steps" in line for line in said)


def test_folder_that_holds_something_is_refused_before_anything_runs(tmp_path, capsys):
    (tmp_path / "mine.txt").write_text("of the user")
    assert main(["ucs", "--quick", "--out", str(tmp_path)]) == 2
    assert "--overwrite" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]
    assert main(["ucs", "--quick", "--out", str(tmp_path / "mine.txt")]) == 2


def test_what_is_not_defined_is_not_compared():
    given = {"name": "K_Ic", "given": 1.4e6, "shown": "not defined", "shown_unit": "", "value": float("nan")}
    alone = given | {"name": "peak load", "given": float("nan"), "shown": "3", "shown_unit": "kN/m", "value": 3e3}
    found = given | {"name": "UCS", "shown": "1.54", "shown_unit": "MPa", "value": 1.54e6}
    report = {"test": "scb", "about": "toughness", "rock": {"name": "granite"}, "doubts": []}
    lines = table(report | {"quantities": [given, alone, found]}).splitlines()[2:]
    assert ["off the sheet" in line for line in lines] == [False, False, True] and "+10 %" in lines[2]


@pytest.mark.parametrize("name", ["bend", "scb"])
def test_rock_without_a_fracture_energy_has_no_toughness(name, capsys):
    assert main([name, "--rock", "pmma", "--check"]) == 2
    assert "law = 'paper' is refused" in capsys.readouterr().err.splitlines()[-1]


def test_earlier_report_does_not_stand_for_a_test_that_comes_to_no_end(tmp_path):
    (tmp_path / "report.html").write_text("earlier")
    (tmp_path / "mine.txt").write_text("of the user")
    set_aside(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mine.txt", "previous.report.html"]
    assert (tmp_path / "previous.report.html").read_text() == "earlier"
