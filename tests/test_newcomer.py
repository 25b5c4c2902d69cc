"""From the built wheel, in an empty folder, to a report of one's own rock and drawing."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from granite import GRANITE, text_of

ROOT = Path(__file__).resolve().parent.parent


@pytest.mark.thorough
def test_a_newcomer_comes_to_a_report_of_his_own_rock_and_drawing(tmp_path):
    """Packages that it needs are those of this environment: they are not fetched again."""
    wheels, site, home = (tmp_path / name for name in ("wheels", "site", "home"))
    home.mkdir()
    pip = [sys.executable, "-m", "pip", "--quiet", "--disable-pip-version-check"]
    built = subprocess.run([*pip, "wheel", "--no-deps", "--wheel-dir", wheels, ROOT], capture_output=True, text=True)
    if built.returncode and "ConnectionError" in built.stderr + built.stdout:
        pytest.skip("no package registry")
    assert built.returncode == 0, built.stderr
    (wheel,) = wheels.glob("*.whl")
    subprocess.run([*pip, "install", "--no-deps", "--target", site, wheel], check=True)
    here = {**os.environ, "PYTHONPATH": str(site)}

    def types(*words: str) -> str:
        done = subprocess.run([sys.executable, "-m", *words], cwd=home, env=here, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "lab" in types("rsmpm_ti")
    assert "westerly_granite" in types("rsmpm_ti.scene", "--rocks")
    assert "drawing" in types("rsmpm_ti.lab", "--help")
    (home / "granite.toml").write_text(text_of(GRANITE), encoding="utf-8")
    (home / "traces.csv").write_text("x1,y1,x2,y2\n15,35,35,65\n", encoding="utf-8")
    test = ("rsmpm_ti.lab", "ucs", "--rock", "granite.toml", "--drawing", "traces.csv", "--dx", "4mm")
    assert "traces.csv" in types(*test, "--check")
    assert "UCS" in types(*test)
    out = home / "renders" / "lab" / "ucs"
    report = json.loads((out / "report.json").read_text(encoding="utf-8"))
    found = {one["name"]: one["value"] for one in report["quantities"]}
    assert 0.1 * 160e6 < found["UCS"] < 160e6 and found["failures in tension"] > 0
    assert report["options"]["drawing"] == "traces.csv"
    assert "traces.csv" in (out / "report.html").read_text(encoding="utf-8")
    assert sorted(path.name for path in home.iterdir()) == ["granite.toml", "renders", "traces.csv"]
