"""The command: what it prints, its exit status, and that it goes on in its folder."""

import pytest
from fake_laboratory import GRANITE, FakeLaboratory

from rsmpm_ti.calibrate.__main__ import main
from rsmpm_ti.rock.sheet.writing import text_of

TARGETS = """
[parameters]
E = ["20 GPa", "90 GPa"]
G_f = ["10 J/m^2", "150 J/m^2"]

[targets]
ucs."E tangent" = { value = "45 GPa", error = "2 GPa" }
"""

OUT = "renders/calibrate/targets"


@pytest.fixture
def calibrate(tmp_path, monkeypatch):
    """Runs the command with a laboratory of closed forms."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "granite.toml").write_text(text_of(GRANITE))

    def run(targets: str, laboratory: FakeLaboratory, *options: str) -> int:
        (tmp_path / "targets.toml").write_text(targets)
        monkeypatch.setattr("rsmpm_ti.calibrate.experiment.laboratory", lambda *_: laboratory)
        return main(["--rock", "granite.toml", "--to", "targets.toml", *options])

    return run


def test_result_is_printed_with_what_is_not_identifiable(calibrate, tmp_path, capsys):
    assert calibrate(TARGETS, FakeLaboratory()) == 0
    said = capsys.readouterr()
    assert "calibrate: 1 of 40: E 55 GPa, G_f 60 J/m^2: off by 4.72 errors (1 s)" in said.err.splitlines()
    out = said.out.splitlines()
    assert "  fit G_f 10 J/m^2 to 150 J/m^2, on a scale of factors; the sheet has 60 J/m^2" in out
    assert any(line.startswith("  G_f") and "NOT IDENTIFIABLE" in line for line in out)
    assert "note: the targets hardly depend on G_f within its bounds" in out and out[-1] == f"written to {OUT}"
    assert {"fitted.toml", "calibration.json", "evaluations.csv", "convergence.png"} <= {
        path.name for path in (tmp_path / OUT).iterdir()
    }


def test_second_run_goes_on_in_the_same_folder(calibrate, capsys):
    again = FakeLaboratory()
    assert calibrate(TARGETS, FakeLaboratory()) == 0 and calibrate(TARGETS, again) == 0
    assert again.calls == [] and "kept from before" in capsys.readouterr().err


def test_target_that_cannot_be_met_is_status_1(calibrate, capsys):
    far = TARGETS.replace('G_f = ["10 J/m^2", "150 J/m^2"]', "").replace("45 GPa", "120 GPa")
    assert calibrate(far, FakeLaboratory()) == 1
    assert "NOT MET" in capsys.readouterr().out


def test_nothing_that_comes_to_an_end_is_status_3(calibrate, capsys):
    assert calibrate(TARGETS + "[budget]\nruns = 6\n", FakeLaboratory(fails=lambda sheet: "unstable")) == 3
    said = capsys.readouterr().err.splitlines()
    assert "failed: unstable" in said[0] and said[-1].endswith(f"{OUT}/evaluations.csv says why")


def test_folder_that_was_begun_is_known_again(calibrate, tmp_path):
    def stops(sheet):
        raise KeyboardInterrupt

    assert calibrate(TARGETS, FakeLaboratory(fails=stops), "--out", "mine") == 130
    assert calibrate(TARGETS, FakeLaboratory(), "--out", "mine") == 0
