"""Frames show the right colour at the right place, do not depend on chance, and end up as files that others read."""

import numpy as np
import pytest
from painted import LIMIT, frame_painter, history, lattice, snapshot
from PIL import Image

from rsmpm_ti.errors import SceneError
from rsmpm_ti.paint import ggui as ggui_module
from rsmpm_ti.paint.figure import slab
from rsmpm_ti.paint.ggui import Ggui, probe, verdict
from rsmpm_ti.paint.layout import lay_out
from rsmpm_ti.paint.palette import View, crack_palette, cracking_palette, margin_palette, stress_palette
from rsmpm_ti.paint.png import write_png
from rsmpm_ti.paint.raster import Raster
from rsmpm_ti.records.snapshot import INTACT, SHEAR, TENSION

pytestmark = pytest.mark.usefixtures("taichi_f64")

VIEW = View(lower=(0.0, 0.0), upper=(0.04, 0.02), width=80, height=40)  # 2 pixels per mm
NEUTRAL = stress_palette(LIMIT).ramp[127:129].mean(axis=0)


def ink(image, box):
    """Part of a box's pixels that is not white."""
    region = image[box.top : box.bottom, box.left : box.right]
    return float((region < 255).any(axis=2).mean())


def test_tension_is_red_compression_blue_each_at_its_place_with_y_upwards():
    x = np.array([[0.010, 0.015], [0.030, 0.005]])  # upper left, lower right
    image = Raster(VIEW, stress_palette(LIMIT)).image(x, 2e-3, np.zeros(2), np.array([LIMIT, -LIMIT])).astype(int)
    assert image.shape == (40, 80, 3)
    assert np.array_equal(image[10, 20], np.rint(stress_palette(LIMIT).ramp[-1])), "full tension, row 10 from the top"
    assert np.array_equal(image[30, 60], np.rint(stress_palette(LIMIT).ramp[0])), "full compression"
    assert image[10, 20, 0] > image[10, 20, 2] and image[30, 60, 2] > image[30, 60, 0]
    for row, column in ((30, 20), (10, 60)):
        assert tuple(image[row, column]) == (184, 184, 184), "void elsewhere"


@pytest.mark.parametrize("palette", [stress_palette(LIMIT), crack_palette(), cracking_palette(), margin_palette()])
def test_table_of_colours_follows_the_ramp_to_half_a_level(palette):
    """Against the colours that `Palette.colours` interpolates: 0.5 of rounding, and single precision."""
    table = palette.table()
    exact = palette.colours(np.linspace(-1.0, 1.0, len(table)), np.zeros(len(table), dtype=int))
    assert np.abs(table - exact).max() <= 0.5 + 1e-3
    steps = np.abs(np.diff(table.astype(int), axis=0)).max()
    assert steps <= 1, "no colour between two of the table is further than one level from either"


def test_square_has_the_size_of_its_particle():
    image = Raster(VIEW, crack_palette()).image(np.array([[0.02, 0.01]]), 2e-3, np.array([SHEAR]))
    painted = ((255.0 - image[..., 0]) / 255.0).sum()  # shear has no red at all, the void has all of it
    assert painted == pytest.approx((4e-3 * 2000 * 1.04) ** 2, rel=0.01)


@pytest.mark.parametrize("value, expected", [(0.0, NEUTRAL), (50 * LIMIT, stress_palette(LIMIT).ramp[-1])])
def test_zero_is_neutral_and_out_of_range_saturates(value, expected):
    x = lattice()
    image = Raster(VIEW, stress_palette(LIMIT)).image(x, 5e-4, np.zeros(len(x)), np.full(len(x), value))
    assert np.abs(image[2:-2, 2:-2] - expected).max() <= 1.0


def test_pixel_averages_values_not_colours():
    x = np.array([[0.02, 0.01], [0.02, 0.01]])
    image = Raster(VIEW, stress_palette(LIMIT)).image(x, 4e-3, np.zeros(2), np.array([LIMIT, -LIMIT]))
    assert np.abs(image[20, 40] - NEUTRAL).max() <= 1.0


def test_failed_particles_lie_on_top_whatever_their_order():
    x = np.array([[0.02, 0.01]] * 2)
    for modes in ((INTACT, TENSION), (TENSION, INTACT)):
        image = Raster(VIEW, crack_palette()).image(x, 4e-3, np.array(modes))
        assert tuple(image[20, 40]) == crack_palette().tension


def test_equal_input_gives_equal_pictures():
    rng = np.random.default_rng(3)
    x = rng.uniform((0.0, 0.0), (0.04, 0.02), (400, 2))
    mode, value = np.zeros(len(x)), rng.normal(size=len(x)) * LIMIT
    mode[:4], mode[4:8] = TENSION, SHEAR
    shuffle = rng.permutation(len(x))
    raster = Raster(VIEW, stress_palette(LIMIT))
    first = raster.image(x, 4e-3, mode, value)
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 10
    assert np.array_equal(first, raster.image(x, 4e-3, mode, value)), "nothing is left from the picture before"
    assert np.array_equal(first, raster.image(x[shuffle], 4e-3, mode[shuffle], value[shuffle])), "sums are exact"


@pytest.mark.parametrize("broken", ["x", "half", "value"])
def test_particle_that_is_not_finite_is_skipped_and_counted(broken):
    data = {"x": np.array([[0.01, 0.01], [0.03, 0.01]]), "half": np.full(2, 2e-3), "value": np.full(2, LIMIT)}
    data[broken][1] = np.nan
    raster = Raster(VIEW, stress_palette(LIMIT))
    image = raster.image(data["x"], data["half"], np.zeros(2), data["value"])
    assert raster.skipped == 1
    assert tuple(image[20, 60]) == (184, 184, 184)
    assert tuple(image[20, 20]) != (184, 184, 184)


def test_runaway_and_absent_particles_do_no_harm():
    raster = Raster(VIEW, crack_palette())
    x = np.vstack([lattice(), [[1e30, 0.0], [0.02, 0.01]]])
    half = np.full(len(x), 5e-4)
    half[-1] = 10.0  # a failed particle whose volume ran away
    mode = np.zeros(len(x))
    mode[-1] = TENSION
    image = raster.image(x, half, mode)
    assert 0 < (image == crack_palette().tension).all(axis=2).sum() < 30
    assert (raster.image(np.zeros((0, 2)), np.zeros(0), np.zeros(0)) == 255).all()


def test_jitter_leaves_no_holes_but_a_flaw_stays_open():
    rng = np.random.default_rng(5)
    x = lattice(160, 80, 2.5e-4)
    x = x[abs(x[:, 0] - 0.02) > 5e-4]  # a slit of 4 spacings
    x += rng.uniform(-0.35, 0.35, x.shape) * 2.5e-4
    view = View(lower=VIEW.lower, upper=VIEW.upper, width=480, height=240)
    void = (Raster(view, crack_palette()).image(x, 1.25e-4, np.zeros(len(x))) == 255).all(axis=2)
    assert not void[5:-5, 5:220].any()
    assert void[:, 236:244].all()


@pytest.mark.parametrize("size", [None, (1280, 1440), (1440, 1280)])
@pytest.mark.parametrize("upper", [(0.05, 0.1), (0.1, 0.1), (0.2, 0.05)])
@pytest.mark.parametrize("legend_lines", [3, 5])
def test_layout_has_even_size_equal_scales_and_no_overlap(legend_lines, upper, size):
    layout = lay_out((0.0, 0.0), upper, size, 8, legend_lines)
    view, panel = layout.view, layout.panel
    assert layout.size == (size or layout.size)
    assert layout.size[0] % 2 == 0 and layout.size[1] % 2 == 0
    scale = panel.width / (view.upper[0] - view.lower[0])
    assert scale * (view.upper[1] - view.lower[1]) == pytest.approx(panel.height, abs=2.0)
    column = [layout.bar, layout.legend, layout.text, layout.inset]
    assert all(above.bottom < below.top for above, below in zip(column, column[1:], strict=False))
    assert layout.bar.height > 150
    assert all(panel.right < box.left and box.right < layout.size[0] for box in column)
    assert all(0 < box.top and box.bottom < layout.size[1] for box in [panel, *column])


def test_frame_shows_particles_numbers_legend_and_curve():
    painter = frame_painter("stress")
    x = lattice(50, 100)
    mode = np.where(abs(x[:, 0] - 0.025) < 1e-3, TENSION, INTACT).astype(np.int8)
    image = painter.paint(snapshot(x, LIMIT, mode), history(40), frame=3)
    layout = painter.layout
    assert image.dtype == np.uint8 and image.shape == (layout.size[1], layout.size[0], 3)
    assert image.shape[0] % 2 == 0 and image.shape[1] % 2 == 0
    middle = layout.panel.top + layout.panel.height // 2, layout.panel.left + layout.panel.width // 2
    assert tuple(image[middle]) == (0, 0, 0), "failed in tension"
    red = image[middle[0], layout.panel.left + layout.panel.width // 4].astype(int)
    assert red[0] > red[2] + 50
    for name, least in (("bar", 0.9), ("legend", 0.02), ("text", 0.02), ("inset", 0.02)):
        assert ink(image, getattr(layout, name)) > least, name
    earlier = painter.paint(snapshot(x, LIMIT, mode), history(40)[:10], frame=3)
    box = layout.inset
    changed = (image != earlier)[box.top : box.bottom, box.left : box.right].any(axis=(0, 2))
    assert changed[: box.width // 10].sum() == 0 and changed[box.width // 2 :].sum() > 50, "the curve grew to the right"
    marker = round(box.top + box.height * (1.0 - 55.0 / 80.0)), round(box.left + box.width * 0.8)
    assert tuple(image[marker]) == (0xD5, 0x5E, 0x00), "the marker stands at 0.4 % and 55 MPa, the platens' mean"


@pytest.mark.parametrize("table, inset", [(history(0), True), (history(5, loaded=False), False)])
def test_frame_without_load_has_no_curve_and_without_platens_no_inset(table, inset):
    painter = frame_painter()
    image = painter.paint(snapshot(lattice(50, 100)), table)
    assert (ink(image, painter.layout.inset) > 0.01) is inset
    assert ink(image, painter.layout.text) > 0.01


def test_numbers_are_in_mm_ms_percent_and_mpa_and_count_what_is_not_finite():
    painter = frame_painter()
    x = lattice(50, 100)
    x[0] = np.nan
    mode = np.zeros(len(x), dtype=np.int8)
    mode[:50], mode[50:75] = TENSION, SHEAR
    shot = snapshot(x, mode=mode, time=1.2345e-3)
    painter.panel(shot)
    lines = [" ".join(line.split()) for line in painter._lines(shot, np.array([0.004]), np.array([55e6]), 7)]
    assert lines == [
        "frame 7",
        "time 1.234 ms",
        "strain 0.400 %",
        "load 55.00 MPa",
        "tension 50",
        "shear 25",
        "failed 1.50 %",
        "not finite 1 not shown",
    ]
    assert painter.extent_mm == pytest.approx((-5.0, 55.0, -5.0, 105.0))


def test_slab_of_a_solid_is_its_two_middle_layers():
    flat = lattice(4, 4)
    x = np.vstack([np.column_stack([flat, np.full(len(flat), (k + 0.5) * 1e-3)]) for k in range(6)])
    shift = np.zeros_like(x)
    shift[:, 2] = np.where(x[:, 2] > 3e-3, 5e-3, 0.0)  # torn apart in z: still the same particles
    shown = slab(snapshot(x + shift, volume=1e-9, displacement=shift))
    assert sorted(set(np.round(x[shown, 2] * 1e3, 3))) == [2.5, 3.5]


@pytest.mark.parametrize(
    "changes",
    [{"kind": "speed"}, {"backend": "opengl"}, {"upper": (0.0, 0.1)}, {"load_limit": -1.0}, {"size": (1281, 1440)}],
)
def test_options_out_of_range_are_refused_in_one_line(changes):
    with pytest.raises(SceneError, match=r"is refused: it must be [^\n]*$"):
        frame_painter(**changes)


def test_stress_frames_need_a_limit():
    with pytest.raises(SceneError, match="stress_limit"):
        frame_painter("stress", stress_limit=None)


def test_png_keeps_every_pixel_and_names_the_painter(tmp_path):
    image = np.random.default_rng(0).integers(0, 256, (20, 30, 3), dtype=np.uint8)
    path = write_png(tmp_path / "frame.png", image, painter="raster")
    with Image.open(path) as picture:
        assert picture.text == {"painter": "raster"}
        assert np.array_equal(np.array(picture), image)
    assert [p.name for p in path.parent.iterdir()] == ["frame.png"], "no temporary file is left"


def test_probe_answers_once_with_a_reason():
    works, reason = probe()
    assert isinstance(works, bool) and reason and "\n" not in reason
    assert probe() is probe()


@pytest.mark.parametrize(
    "status, output, errors, words",
    [
        (-11, "", "", "SIGSEGV"),
        (1, "", "Traceback\nRuntimeError: Vulkan must be available for GGUI\n", "Vulkan must be available"),
        (3, "", "", "status 3"),
        (0, "[Taichi] hello\n", "", "nothing"),
        (0, "PROBE [0.0, 0.0, 0.0]\n", "", "where red was asked for"),
    ],
)
def test_probe_turns_every_failure_into_a_reason(status, output, errors, words):
    works, reason = verdict(status, output, errors)
    assert works is False and words in reason


def test_probe_survives_a_child_that_hangs_or_crashes(monkeypatch):
    monkeypatch.setattr(ggui_module, "PROBE", "import time; time.sleep(60)")
    assert probe.__wrapped__(timeout=0.5) == (False, "GGUI's probe did not answer within 0.5 s")
    monkeypatch.setattr(ggui_module, "PROBE", "import os; os.abort()")
    assert "SIGABRT" in probe.__wrapped__()[1]


def test_ggui_is_refused_where_the_probe_fails(monkeypatch):
    monkeypatch.setattr("rsmpm_ti.paint.figure.probe", lambda: (False, "no driver here"))
    with pytest.raises(SceneError, match="no driver here"):
        frame_painter(backend="ggui")


def test_ggui_agrees_with_raster(tmp_path, monkeypatch):
    works, reason = probe()
    if not works:
        pytest.skip(reason)
    monkeypatch.chdir(tmp_path)
    x = lattice(lower=(0.005, 0.002))
    mode = np.where(abs(x[:, 0] - x[:, 1] - 0.01) < 1e-3, TENSION, INTACT)
    value = LIMIT * np.sin(x[:, 0] * 200.0)
    x[7] = np.nan
    view = View(lower=VIEW.lower, upper=(0.05, 0.025), width=400, height=200)
    painter = Ggui(view, stress_palette(LIMIT))
    try:
        painter.image(x[:10], 5e-4, mode[:10], value[:10])  # fewer first: the painter must make room
        drawn = painter.image(x, 5e-4, mode, value)
        assert painter.skipped == 1
    finally:
        painter.close()
    assert list(tmp_path.iterdir()) == [], "GGUI's imgui.ini is not left behind"
    expected = Raster(view, stress_palette(LIMIT)).image(x, 5e-4, mode, value)
    assert drawn.shape == expected.shape and drawn.dtype == expected.dtype
    difference = np.abs(drawn.astype(int) - expected).max(axis=2)
    assert (difference > 24).mean() < 0.02, "they differ on edges only"
    assert difference.mean() < 5.0
    with pytest.raises(RuntimeError, match="closed"):
        painter.image(x, 5e-4, mode, value)
