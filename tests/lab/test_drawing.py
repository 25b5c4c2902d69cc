"""A drawn specimen is the one that is tested: in its place, of its size, with its flaws; what cannot be is refused."""

import json
import math

import numpy as np
import pytest
from hostile import DRAWINGS
from PIL import Image
from reported import run_of

from rsmpm_ti.lab.__main__ import main
from rsmpm_ti.lab.compression import plan_triaxial, plan_ucs, read_ucs
from rsmpm_ti.lab.drawing import Drawing
from rsmpm_ti.lab.running import is_done
from rsmpm_ti.lab.standard import Options
from rsmpm_ti.lab.validity import doubts_of
from rsmpm_ti.spec.library.rocks import load_sheet
from rsmpm_ti.spec.scene_json import from_plain, to_plain

SIZES = {
    "section.png": (40e-3, 80e-3),
    "outline.stl": (40e-3, 80e-3),
    "plate.msh": (40e-3, 80e-3),
}


@pytest.fixture
def sheet():
    return load_sheet("paper_rock")


@pytest.fixture
def traces(tmp_path):
    file = tmp_path / "traces.csv"
    file.write_text("x1,y1,x2,y2\n15,35,35,65\n")
    return file


@pytest.mark.parametrize("name", SIZES)
def test_outline_lies_between_the_platens_and_fills_whole_cells(name, sheet):
    drawing = Drawing(file=str(DRAWINGS / name), scale=1.0 if name == "plate.msh" else 1e-3)
    (one,) = plan_ucs(sheet, Options(quick=True, drawing=drawing), 1)
    domain, loading = one.scene.domain, one.scene.loading
    low, high = one.scene.bodies[0].region.bounds()
    assert low == pytest.approx((0.0, 0.0), abs=1e-12)
    assert (loading.width, loading.height) == pytest.approx(tuple(high))
    cells = np.subtract(domain.upper, domain.lower) / domain.dx
    assert cells == pytest.approx(np.round(cells), abs=1e-6)
    x = one.scene.particles()[0].x
    assert np.ptp(x, axis=0) == pytest.approx(high, abs=domain.dx)


def test_size_of_each_drawing_is_that_in_its_units(sheet):
    for name, size in SIZES.items():
        drawing = Drawing(file=str(DRAWINGS / name), scale=1.0 if name == "plate.msh" else 1e-3)
        assert drawing.outline()[1:] == pytest.approx(size, rel=1e-6)


def test_traces_are_cut_into_the_standards_specimen(sheet, traces):
    drawing = Drawing(file=str(traces))
    for one in plan_triaxial(sheet, Options(quick=True, drawing=drawing), 1):
        (slit,) = one.scene.bodies[0].region.removed[0].slits
        assert slit.length == pytest.approx(math.hypot(20e-3, 30e-3)) and slit.centre == pytest.approx((25e-3, 50e-3))
        assert slit.width == pytest.approx(3.0 * one.scene.domain.dx)
        assert one.scene.loading.width == 50e-3 and one.scene.servo is not None


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["tension", "--drawing", "section.png"], "but for ucs and triaxial"),
        (["ucs", "--drawing", "nowhere.png"], "nowhere.png"),
        (["ucs", "--drawing", "nowhere.csv"], "nowhere.csv"),
        (["ucs", "--drawing", "drawing.dwg"], "--drawing = 'drawing.dwg' is refused"),
        (["ucs", "--scale", "1mm"], "beside a --drawing"),
        (["ucs", "--drawing", "section.png", "--scale", "5"], "--scale = '5' is refused"),
        (["ucs", "--drawing", "section.png", "--scale", "0"], "--scale"),
        (["ucs", "--drawing", "section.png", "--size", "50mm"], "give its --scale"),
        (["ucs", "--drawing", "core.stl"], "flat"),
    ],
)
def test_what_cannot_be_drawn_is_refused_in_a_line(arguments, words, capsys, monkeypatch):
    monkeypatch.chdir(DRAWINGS)
    assert main([*arguments, "--check"]) == 2
    said = capsys.readouterr().err.splitlines()
    assert len(said) == 1 and words in said[0]


def saved(tmp_path, solid: np.ndarray):
    """Drawing of an image of 1 mm pixels."""
    file = tmp_path / "drawn.png"
    Image.fromarray(np.where(solid, 0, 255).astype(np.uint8)).save(file)
    return ["ucs", "--quick", "--check", "--drawing", str(file)]


def test_rock_in_two_pieces_from_platen_to_platen_is_refused(tmp_path, capsys):
    solid = np.ones((80, 40), dtype=bool)
    assert main(saved(tmp_path, solid)) == 0
    assert "40 x 80 mm" in capsys.readouterr().out
    solid[30:50] = False
    assert main(saved(tmp_path, solid)) == 2
    assert "one piece of rock" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("15,30,28,4S\n22,60,35,72\n", "line 1"),
        ("x1,y1,x2,y2\n", "holds no trace"),
        ("0.015,0.035,0.035,0.065\n", "one unit of the file is 1 mm: give its --scale"),
    ],
)
def test_traces_that_cannot_be_read_are_refused(text, words, tmp_path, capsys):
    (tmp_path / "traces.csv").write_text(text)
    assert main(["ucs", "--quick", "--check", "--drawing", str(tmp_path / "traces.csv")]) == 2
    assert words in capsys.readouterr().err


def test_record_of_a_drawn_specimen_finds_its_drawing_from_any_folder(sheet, monkeypatch, tmp_path):
    monkeypatch.chdir(DRAWINGS)
    (one,) = plan_ucs(sheet, Options(quick=True, drawing=Drawing(file="section.png")), 1)
    monkeypatch.chdir(tmp_path)
    assert from_plain(json.loads(json.dumps(to_plain(one.scene)))) == one.scene


def test_a_test_of_another_rock_does_not_go_on_in_its_folder(sheet, tmp_path, capsys):
    (one,) = plan_ucs(load_sheet("berea_sandstone"), Options(quick=True), 1)
    folder = tmp_path / "out" / "runs" / one.label
    folder.mkdir(parents=True)
    (folder / "scene.json").write_text(json.dumps({"scene": to_plain(one.scene)}))
    (folder / "summary.json").write_text(json.dumps({"complete": True}))
    assert main(["ucs", "--quick", "--out", str(tmp_path / "out"), "--resume"]) == 2
    assert "--resume" in capsys.readouterr().err
    assert is_done(one, folder)


def test_crack_stresses_are_of_intact_specimens_alone(sheet, traces, tmp_path):
    """They take the whole specimen's volume for that of rock."""
    options = Options(quick=True, drawing=Drawing(file=str(traces)))
    found = {}
    for name, given in (("intact", Options(quick=True)), ("drawn", options)):
        (one,) = plan_ucs(sheet, given, 1)
        found[name] = {quantity.name: quantity for quantity in read_ucs([run_of(one, "ucs", tmp_path / name, 25e6)])}
    for stress in ("crack initiation stress", "crack damage stress"):
        assert math.isnan(found["drawn"][stress].value) and "not defined" in found["drawn"][stress].about
        assert "not defined" not in found["intact"][stress].about


@pytest.mark.parametrize(("width", "told"), [("", True), (",5", True), (",9", False)])
def test_flaw_narrower_than_twice_the_mean_is_told(sheet, tmp_path, width, told):
    """With cells of 2 mm the mean is over 4 mm, and a flaw without a width 6 mm wide."""
    (tmp_path / "traces.csv").write_text(f"15,35,35,65{width}\n")
    (one,) = plan_ucs(sheet, Options(quick=True, drawing=Drawing(file=str(tmp_path / "traces.csv"))), 1)
    doubts = doubts_of("ucs", run_of(one, "ucs", tmp_path / "out", 25e6))
    assert [doubt.grave for doubt in doubts if "fifth number in each row" in doubt.sentence] == [False] * told
