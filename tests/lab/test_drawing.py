"""A drawn specimen is the one that is tested: in its place, of its size, with its flaws; what cannot be is refused."""

import math

import numpy as np
import pytest
from hostile import DRAWINGS

from rsmpm_ti.lab.__main__ import main
from rsmpm_ti.lab.compression import plan_triaxial, plan_ucs
from rsmpm_ti.lab.drawing import Drawing
from rsmpm_ti.lab.standard import Options
from rsmpm_ti.spec.library.rocks import load_sheet

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
