"""The quick tier of `python -m rsmpm_ti.verify`, case by case, and how its command behaves."""

import csv
import math

import pytest

from rsmpm_ti.cases.case import Row, at_least, at_most, difference, relative, seen
from rsmpm_ti.cases.running import run_case
from rsmpm_ti.verify.__main__ import main
from rsmpm_ti.verify.catalogue import CASES, MODULES
from rsmpm_ti.verify.strength.weibull import strips

LONGER = {
    "manufactured_b",
    "uniaxial",
    "lab_friction",
    "lab_triaxial",
    "lab_residual",
    "lab_platens",
    "slit_field",
    "cracked_disc",
    "inclusion",
}
"""Cases of the quick tier that the suite leaves to its own longer tier: 10 to 60 s each, and something else is like
them. `manufactured_a` like `_b`, the hard case `uniform_failure` like `uniaxial`, `triaxial` like the jacket,
tests/solver/test_platens.py like platens, tests/solver/test_servo.py like `lab_residual`, `kirsch` and `first_failure`
like the stress about a flaw; tests/scenes hold the scene `inclusion` to the same closed form."""

QUICK = [
    pytest.param(name, marks=[pytest.mark.validation] * (name in LONGER)) for name, case in CASES.items() if case.quick
]


@pytest.mark.parametrize("name", QUICK)
@pytest.mark.thorough("cycle", "first_failure", "gravity", "lab_bending", "lab_ucs", "spin", "vibration", "laminate")
def test_case_agrees_with_its_reference(name, tmp_path):
    rows = run_case("rsmpm_ti.verify.catalogue", name, full=False, out=tmp_path, threads=1)
    assert rows and [row for row in rows if not row.passed] == []
    assert (tmp_path / f"{name}.png").stat().st_size > 10_000
    assert all(len(row.reason) > 3 for row in rows), "every tolerance has its reason beside it"


def test_the_scene_of_most_bodies_is_not_refused():
    """`weibull_size --full`: four hundred strips of every width."""
    assert len(strips(400).bodies) == 2000


def test_names_are_unique_and_fit_the_table():
    names = [case.name for module in MODULES for case in module.CASES]
    assert len(set(names)) == len(names) and max(map(len, names)) <= 18


@pytest.mark.parametrize(
    "row, passed",
    [
        (relative("a", 2.0, 2.1, 0.06, "why"), True),
        (relative("a", 2.0, 2.1, 0.04, "why"), False),
        (difference("a", 2.0, 1.0, 1.0, "why"), True),
        (difference("a", 2.0, 0.9, 1.0, "why"), False),
        (at_most("a", 0.1, 0.2, "why"), True),
        (at_most("a", 0.3, 0.2, "why"), False),
        (at_least("a", 2.0, 1.7, "why"), True),
        (at_least("a", 1.6, 1.7, "why"), False),
        (at_most("a", math.nan, 0.2, "why"), False),
        (at_least("a", math.nan, 0.2, "why"), False),
        (seen("a", 1e9, "why"), True),
    ],
)
def test_verdict(row: Row, passed: bool):
    assert row.passed is passed


def test_list_names_every_case(capsys):
    assert main(["--list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in CASES)


@pytest.mark.parametrize("arguments, word", [(["nonsense"], "nonsense"), (["--jobs", "0"], "--jobs 0")])
def test_bad_command_is_refused_with_the_list(arguments, word, capsys):
    assert main(arguments) == 2
    assert word in capsys.readouterr().err


def test_command_writes_table_and_picture_and_tells_of_a_miss(tmp_path, capsys):
    assert main(["failed_cell", "--out", str(tmp_path), "--jobs", "1"]) == 0
    with open(tmp_path / "verification.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) >= 4 and {row["verdict"] for row in rows} == {"pass"} and all(row["reason"] for row in rows)
    assert (tmp_path / "failed_cell.png").exists()
