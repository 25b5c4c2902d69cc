"""docs/calibrate.md: its file of targets is one, and its command says what would be run."""

import re
from pathlib import Path

from rsmpm_ti.calibrate.__main__ import main
from rsmpm_ti.calibrate.targets.reading import read_wanted
from rsmpm_ti.calibrate.uncertainty import LEAST

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "calibrate.md").read_text(encoding="utf-8")


def test_file_of_the_page_is_read_and_checked(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "targets.toml").write_text(re.search(r"```toml\n(.*?)```", PAGE, re.DOTALL)[1], encoding="utf-8")
    wanted = read_wanted(tmp_path / "targets.toml")
    assert [p.key for p in wanted.parameters] == ["E", "UCS", "sigma_t"] and wanted.tests == (
        "ucs", "brazilian", "triaxial",
    )  # fmt: skip
    assert main(["--rock", "westerly_granite", "--to", "targets.toml", "--check"]) == 0
    said = capsys.readouterr().out.splitlines()
    assert "  to  brazilian.BTS 11 ± 0.55 MPa (5 %: the file gives none)" in said
    assert sum(line.startswith("  run ") for line in said) == 4 and "an evaluation is 4 runs" in said[-1]
    assert [path.name for path in tmp_path.iterdir()] == ["targets.toml"]


def test_limit_of_the_page_is_that_of_the_code():
    assert f"below {LEAST:.2f}" in " ".join(PAGE.split())
