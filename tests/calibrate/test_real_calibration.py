"""A calibration by runs of the laboratory itself."""

import json

import pytest
from fake_laboratory import GRANITE

from rsmpm_ti.calibrate.__main__ import main
from rsmpm_ti.rock.sheet.reading import read_sheet
from rsmpm_ti.rock.sheet.writing import text_of

TARGETS = """
[parameters]
sigma_t = ["4 MPa", "16 MPa"]

[targets]
tension."tensile strength" = { value = "7 MPa", error = "2 %" }

[budget]
runs = 8
"""


@pytest.mark.validation
def test_tensile_strength_is_fitted_by_runs(tmp_path, monkeypatch, capsys):
    """Direct tension finds the strength of its sheet within two hundredths, so the fit is near the measured value."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "granite.toml").write_text(text_of(GRANITE))
    (tmp_path / "tensile.toml").write_text(TARGETS)
    assert main(["--rock", "granite.toml", "--to", "tensile.toml"]) == 0
    out = tmp_path / "renders" / "calibrate" / "tensile"
    record = json.loads((out / "calibration.json").read_text())
    assert record["met"] and record["evaluations"] <= 8 and record["failed"] == []
    assert read_sheet(out / "fitted.toml").sigma_t == pytest.approx(7e6, rel=0.05)
    (parameter,) = record["parameters"]
    assert parameter["identifiable"] and parameter["lower_95"] < 7e6 < parameter["upper_95"]
    capsys.readouterr()
    assert main(["--rock", "granite.toml", "--to", "tensile.toml"]) == 0
    assert capsys.readouterr().err.count("kept from before") == record["evaluations"]
