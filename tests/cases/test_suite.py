"""How a command that runs cases treats its folder, names and what it found earlier: by `python -m rsmpm_ti.verify`."""

import csv

import pytest

from rsmpm_ti.cases import command
from rsmpm_ti.cases.case import Case, at_most
from rsmpm_ti.cases.running import Finished
from rsmpm_ti.output.lock import Lock
from rsmpm_ti.verify.__main__ import main


def test_case_that_breaks_or_misses_gives_status_1_and_the_others_still_run(tmp_path, capsys, monkeypatch):
    done = [Finished("wave", (at_most("a", 1.0, 0.1, "because"),), 1.0), Finished("hole", (), 1.0, "ValueError: x")]
    monkeypatch.setattr(command, "run_cases", lambda *_: iter(done))
    monkeypatch.setattr(command, "cases_of", lambda _: {name: Case(name, "", no_run) for name in ("wave", "hole")})
    assert main(["wave", "hole", "--out", str(tmp_path)]) == 1
    printed = capsys.readouterr().out
    assert "MISS" in printed and "because" in printed and "broke: ValueError: x" in printed and "2 misses" in printed


def test_a_run_of_some_cases_keeps_what_is_known_of_the_others(tmp_path, capsys, monkeypatch):
    cases = {name: Case(name, "", no_run) for name in ("hole", "wave")}
    monkeypatch.setattr(command, "cases_of", lambda _: cases)

    def lines(name: str, value: float | None) -> list[tuple[str, str]]:
        rows = () if value is None else (at_most("a", value, 0.1, "because"),)
        finished = Finished(name, rows, 1.0, "" if rows else "ValueError: x")
        monkeypatch.setattr(command, "run_cases", lambda *_: iter([finished]))
        main([name, "--out", str(tmp_path)])
        with open(tmp_path / "verification.csv", newline="") as file:
            return [(row["case"], row["got"]) for row in csv.DictReader(file)]

    assert lines("wave", 0.01) == [("wave", "0.01")]
    assert lines("hole", 0.02) == [("hole", "0.02"), ("wave", "0.01")]  # in the order of the catalogue
    assert "of earlier runs it keeps 1 more" in capsys.readouterr().out
    assert lines("wave", 0.03) == [("hole", "0.02"), ("wave", "0.03")]
    assert lines("wave", None) == [("hole", "0.02"), ("wave", "0.03")]  # it broke, and loses nothing
    assert "1 misses; table and pictures in" in (said := capsys.readouterr().out) and "keeps 2 more" in said
    assert lines("wave", 0.04) == [("hole", "0.02"), ("wave", "0.04")]

    def stopped(*_):
        yield Finished("hole", (at_most("a", 0.05, 0.1, "because"),), 1.0)
        raise KeyboardInterrupt

    monkeypatch.setattr(command, "run_cases", stopped)
    assert main(["hole", "wave", "--out", str(tmp_path)]) == 130
    with open(tmp_path / "verification.csv", newline="") as file:  # what was not come to is as it was
        assert [row["got"] for row in csv.DictReader(file)] == ["0.05", "0.04"]


def no_run(full: bool):
    raise AssertionError("refused before anything runs")


def wave_alone(monkeypatch, *finished: Finished, quick: bool = True) -> None:
    """A catalogue of one case, of which this comes; of none, running it is an error."""
    monkeypatch.setattr(command, "cases_of", lambda _: {"wave": Case("wave", "", no_run, quick=quick)})
    monkeypatch.setattr(command, "run_cases", lambda *_: iter(finished) if finished else no_run(True))


ONE = (at_most("a", 0.01, 0.1, "because"),)


def test_quick_form_does_not_replace_what_the_full_one_found(tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch, Finished("wave", ONE, 1.0))
    out = ["wave", "--out", str(tmp_path)]
    assert main([*out, "--full"]) == 0 and main([*out, "--full"]) == 0
    before = (tmp_path / "verification.csv").read_bytes()
    wave_alone(monkeypatch)
    assert main(out) == 2 and (tmp_path / "verification.csv").read_bytes() == before
    assert "holds what the full form of wave found; add --full" in capsys.readouterr().err
    wave_alone(monkeypatch, Finished("wave", ONE, 1.0))
    assert main([*out, "--overwrite"]) == 0
    assert (tmp_path / "verification.csv").read_text().endswith("quick\n")
    assert "1 numbers, in their quick form, 0 misses" in capsys.readouterr().out


def test_case_with_a_full_form_alone_is_run_in_it(tmp_path, monkeypatch):
    wave_alone(monkeypatch, Finished("wave", ONE, 1.0), quick=False)
    assert main(["wave", "--out", str(tmp_path)]) == 0
    assert (tmp_path / "verification.csv").read_text().endswith("full\n")


def test_numbers_of_a_case_stay_where_its_picture_cannot_be_written(tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch, Finished("wave", ONE, 1.0, "OSError: disk full"))
    assert main(["wave", "--out", str(tmp_path)]) == 1
    assert "has no picture: OSError: disk full" in capsys.readouterr().out
    assert "wave,a,0,0.01" in (tmp_path / "verification.csv").read_text()


@pytest.mark.parametrize("place", ["verification.csv", "wave.png"])
def test_folder_in_the_place_of_a_file_is_refused_before_anything_runs(place, tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch)
    (tmp_path / place).mkdir()
    assert main(["wave", "--out", str(tmp_path)]) == 2
    assert f"{place} is no file, and one is to be written there" in capsys.readouterr().err


@pytest.mark.parametrize("text", ["another,table\n1,2\n", "", "case,quantity,reference,got,error\nwave,a,1,1,1\n"])
def test_table_of_somebody_else_is_not_replaced(text, tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch)
    (tmp_path / "verification.csv").write_text(text)
    assert main(["wave", "--out", str(tmp_path)]) == 2
    assert "is no table of this command" in capsys.readouterr().err
    assert (tmp_path / "verification.csv").read_text() == text


def test_second_command_in_a_folder_is_refused(tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch)
    with Lock(tmp_path):
        assert main(["wave", "--out", str(tmp_path)]) == 2
    assert "a folder into which no other run writes" in capsys.readouterr().err


def test_file_in_the_place_of_the_folder_is_refused(tmp_path, capsys, monkeypatch):
    wave_alone(monkeypatch)
    (tmp_path / "file").write_text("")
    assert main(["wave", "--out", str(tmp_path / "file")]) == 2 and main(["wave", "--out", ""]) == 2
    said = capsys.readouterr().err
    assert "file cannot be written: it is a file; give another" in said and "'' cannot be written" in said


@pytest.mark.parametrize("name, word", [("Wave", "did you mean wave?"), ("", "unknown case ''")])
def test_unknown_case_is_refused_with_a_guess(name, word, capsys, monkeypatch):
    wave_alone(monkeypatch)
    assert main([name, "--list"]) == 2
    assert word in capsys.readouterr().err
