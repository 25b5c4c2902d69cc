"""summary.png: the load curve, the cracks at the largest load and the end, and words from outside on it."""

import numpy as np
import pytest
from painted import frame_painter, history, lattice, snapshot
from PIL import Image

from rsmpm_ti.paint.palette import crack_palette
from rsmpm_ti.paint.summary_picture import summary_picture
from rsmpm_ti.paint.words import drawable
from rsmpm_ti.records.snapshot import INTACT, SHEAR, TENSION

pytestmark = pytest.mark.usefixtures("taichi_f64")


@pytest.mark.parametrize("table", [history(30), history(30, loaded=False), history(0)])
def test_summary_has_a_curve_and_the_crack_pattern(tmp_path, table):
    x = lattice(50, 100)
    mode = np.where(abs(x[:, 0] - 0.025) < 1e-3, SHEAR, INTACT).astype(np.int8)
    path = summary_picture(tmp_path / "summary.png", snapshot(x, mode=mode), table, frame_painter(), "a title")
    with Image.open(path) as picture:
        image = np.array(picture)
    assert image.shape == (900, 1600, 3)
    right = image[:, 900:]
    assert (right == crack_palette().shear).all(axis=2).sum() > 1000
    assert (image[:, :900] < 128).all(axis=2).sum() > 1000


def test_summary_draws_crack_paths_with_lengths_and_the_acoustic_count(tmp_path):
    """Against the same picture without them: new ink on the path, beside it a label, and a curve on the left."""
    x = lattice(50, 100)
    mode = np.where(abs(x[:, 0] - 0.025) < 2e-3, TENSION, INTACT).astype(np.int8)
    long = np.column_stack([np.full(9, 0.025), np.linspace(0.02, 0.08, 9)])
    short = np.array([[0.01, 0.01], [0.012, 0.012]])

    painter = frame_painter()

    def picture(*more) -> np.ndarray:
        path = summary_picture(tmp_path / "s.png", snapshot(x, mode=mode), history(30), painter, "t", *more)
        with Image.open(path) as image:
            return np.array(image).astype(int)

    plain, one, all_three = picture(), picture([long]), picture([long, short], np.linspace(1e-4, 9e-4, 40))
    rows, columns = np.nonzero((plain != one).any(axis=2))
    assert columns.min() > 900  # nothing but the crack panel has changed
    dark = (one < 60).all(axis=2) & (plain[..., 0] > 180)
    assert dark.sum() > 300  # the line, about 400 pixels long, and the digits
    assert np.ptp(rows) > 300 and np.ptp(columns) > 40  # 60 of 110 mm high; the label is written beside the line
    changed = (all_three != one).any(axis=2)
    assert all(0 < np.ptp(positions) < 30 for positions in np.nonzero(changed[:, 1000:]))  # a line and no label
    assert changed[:, :850].sum() > 300  # the curve


def test_summary_shows_the_cracks_at_the_largest_load_beside_the_last_ones(tmp_path):
    """Two patterns where they are of two instants, and each with its own failures; one where the load never fell."""
    x = lattice(50, 100)
    few, many = (np.where(abs(x[:, 0] - 0.025) < half, TENSION, INTACT).astype(np.int8) for half in (1e-3, 8e-3))
    peak, last = snapshot(x, mode=few, time=4e-4), snapshot(x, mode=many, time=1e-3)

    def picture(of) -> np.ndarray:
        path = summary_picture(tmp_path / "s.png", last, history(30), frame_painter(), "t", peak=of)
        with Image.open(path) as image:
            return np.array(image)

    two, one = picture(peak), picture(last)
    assert (two.shape, one.shape) == ((900, 2100, 3), (900, 1600, 3))
    tension = (two == crack_palette().tension).all(axis=2)[:800]  # the legend is below
    middle, right = tension[:, 1000:1500].sum(), tension[:, 1500:].sum()
    assert 1000 < middle < 0.2 * right


@pytest.mark.parametrize(
    ("text", "drawn"),
    [
        ("two $ and $ more", r"two \$ and \$ more"),
        (r"$\foo{$", r"\$\foo{\$"),
        ("Разрушение, é, φ", "Разрушение, é, φ"),
        ("e\u0301", "é"),
        ("岩石 rock", "\ufffd\ufffd rock"),
        ("\U0001f4a5", "\ufffd"),
    ],
)
def test_words_from_outside_are_drawn_or_replaced_visibly(tmp_path, recwarn, text, drawn):
    """No formula, no warning of a missing glyph, no crash, in a title of a frame and of summary.png."""
    assert drawable(text) == drawn
    x = lattice(4, 4)
    painter = frame_painter(title=text)
    painter.paint(snapshot(x), history(3))
    summary_picture(tmp_path / "s.png", snapshot(x), history(3), painter, text)
    assert [str(warning.message) for warning in recwarn if "lyph" in str(warning.message)] == []


def test_a_long_title_is_broken_into_lines(tmp_path):
    x = lattice(4, 4)
    path = summary_picture(tmp_path / "s.png", snapshot(x), history(3), frame_painter(), "word " * 40)
    with Image.open(path) as image:
        edges = np.array(image)[:100, [*range(8), *range(-8, 0)]]
    assert (edges == 255).all(), "nothing is cut off at the sides"


def test_the_peak_of_a_test_in_tension_is_its_largest_pull(tmp_path, monkeypatch):
    table = history(30)
    for name in ("axial_strain", "stress_top_Pa", "stress_bottom_Pa"):
        table[name] *= -1.0
    said = []
    monkeypatch.setattr("matplotlib.axes.Axes.set_title", lambda self, text, **_: said.append(text))
    summary_picture(tmp_path / "s.png", snapshot(lattice(4, 4)), table, frame_painter())
    assert said[0].startswith("peak -55.00 MPa at -0.400 %")


def test_a_load_without_a_strain_is_drawn_over_time(tmp_path, monkeypatch):
    """Of one platen that nothing faces."""
    table = history(30)
    table["axial_strain"] = np.nan
    said, drawn = [], []
    monkeypatch.setattr("matplotlib.axes.Axes.set_title", lambda self, text, **_: said.append(text))
    monkeypatch.setattr("matplotlib.axes.Axes.set_xlabel", lambda self, text, **_: drawn.append(text))
    summary_picture(tmp_path / "s.png", snapshot(lattice(4, 4)), table, frame_painter())
    assert said[0] == "largest so far 55.00 MPa at 1.000 ms" and drawn[0] == "time [ms]"
