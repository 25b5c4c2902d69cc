"""Frames of the margin to failure, and crack frames of rock that softens: the colour of each state, at its place."""

from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from snapshots import snapshot_of

from rsmpm_ti import load_scene
from rsmpm_ti.output.gallery import Gallery
from rsmpm_ti.output.pictures import commission
from rsmpm_ti.paint.figure import FramePainter
from rsmpm_ti.paint.palette import View, crack_palette, cracking_palette, margin_palette
from rsmpm_ti.paint.raster import Raster
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.records.snapshot import INTACT, SHEAR, TENSION
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import LinearSoftening
from rsmpm_ti.spec.scene import Output

pytestmark = pytest.mark.usefixtures("taichi_f64")

MM = 1e-3
NO_ROWS = np.zeros(0, dtype=[(name, float) for name in HISTORY_COLUMNS])
SOFT = Directional(softening=LinearSoftening(G_f_I=20.0, G_f_II=200.0))


def stripes(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Particles of 1 mm on 40 x 20 mm and the number of the upright stripe, of `count`, in which each lies."""
    x, y = np.meshgrid((np.arange(40) + 0.5) * MM, (np.arange(20) + 0.5) * MM, indexing="ij")
    positions = np.column_stack([x.ravel(), y.ravel()])
    return positions, (positions[:, 0] / (40.0 * MM) * count).astype(int)


def painter(kind: str, **changes) -> FramePainter:
    return FramePainter(kind=kind, lower=(0.0, 0.0), upper=(0.04, 0.02), **changes)


def colours(panel: np.ndarray, count: int) -> list[np.ndarray]:
    """The colour in the middle of each stripe; the panel shows 2 mm around the specimen."""
    height, width = panel.shape[:2]
    middles = (2.0 + 40.0 * (np.arange(count) + 0.5) / count) / 44.0
    return [panel[height // 2, round(width * middle)].astype(int) for middle in middles]


def test_margin_frame_shows_how_near_and_to_which_failure():
    x, stripe = stripes(5)
    margin, governs = np.array([0.0, 0.5, 1.0, 0.5, 0.0])[stripe], np.array([1, 1, 0, 2, 2])[stripe]
    found = colours(painter("margin").panel(snapshot_of(x, margin=margin, governs=governs)), 5)
    ramp = margin_palette().ramp
    for k, position in enumerate((256, 192, 128, 64, 0)):  # loads 1 and 1/2 in tension, none, 1/2 and 1 in shear
        assert np.abs(found[k] - ramp[position]).max() <= 1.0, k
    light = [colour.mean() for colour in found]
    assert light[0] < light[1] < light[2] > light[3] > light[4], "the nearer, the darker"
    assert (found[0][0] > found[0][1]) and (found[4][1] > found[4][0]), "tension purple, shear green"


def test_failed_rock_and_void_stand_out_from_every_margin():
    x, stripe = stripes(3)
    panel = painter("margin").panel(snapshot_of(x, np.array([TENSION, INTACT, SHEAR])[stripe]))
    found, palette = colours(panel, 3), margin_palette()
    assert tuple(found[0]) == palette.tension and tuple(found[2]) == palette.shear
    assert tuple(panel[0, 0]) == palette.void
    # of 441 from black to white: single particles need more than wide areas to be told apart
    for mark, least in zip(palette.marks(), (40.0, 60.0, 60.0), strict=True):
        assert np.linalg.norm(palette.ramp - mark, axis=1).min() > least


def test_pixel_that_sees_both_failures_near_does_not_look_unloaded():
    """Loads of 0.9 in tension and 0.5 in shear average to 0.7, not to 0.2, on the side that weighs more."""
    view = View(lower=(0.0, 0.0), upper=(0.04, 0.02), width=80, height=40)
    x = np.array([[0.02, 0.01], [0.02, 0.01]])
    palette = margin_palette()
    for values, position in (((0.9, -0.5), 0.7), ((0.5, -0.9), -0.7)):
        image = Raster(view, palette).image(x, 4e-3, np.zeros(2), np.array(values))
        expected = palette.ramp[round(128 + 128 * position)]
        assert np.abs(image[20, 40] - expected).max() <= 3.0  # a step of the ramp, and values in 1/1024


def test_margin_bar_counts_down_to_both_ends_and_legend_names_what_failed():
    frame = painter("margin")
    ticks = dict(frame.wording.ticks)
    assert ticks[0.0] == "1" and ticks[0.5] == ticks[-0.5] == "0.5"
    assert ticks[1.0].split() == ["0", "tension"] and ticks[-1.0].split() == ["0", "shear"]
    assert [name for name, _ in frame.wording.legend] == ["failed in tension", "failed in shear", "void"]
    x, _ = stripes(1)
    image, bar = frame.paint(snapshot_of(x), NO_ROWS), frame.layout.bar
    ramp = margin_palette().ramp
    for row, colour in ((bar.top + 6, ramp[-3]), (bar.bottom - 6, ramp[2])):  # tension at the upper end
        assert np.abs(image[row, bar.left + bar.width // 2] - colour).max() < 12.0


def test_rock_that_has_begun_to_crack_is_tinted_between_intact_and_failed():
    x, stripe = stripes(6)
    damage = np.array([0.0, 0.02, 0.49, 0.02, 0.49, 0.6])[stripe]
    governs = np.array([0, 1, 1, 2, 2, 1])[stripe]
    mode = np.array([0, 0, 0, 0, 0, 1])[stripe]
    shot = snapshot_of(x, mode, damage=damage, governs=governs)
    intact, begun, half, begun_shear, half_shear, failed = colours(painter("cracks", softens=True).panel(shot), 6)
    plain = crack_palette()
    assert tuple(intact) == tuple(plain.ramp[0].astype(int)) and tuple(failed) == plain.tension
    for early, late, colour in ((begun, half, plain.tension), (begun_shear, half_shear, plain.shear)):
        away = [np.linalg.norm(c - intact) for c in (early, late)]
        assert 25.0 < away[0] < away[1], "seen at once, and more with damage"
        assert np.linalg.norm(late - colour) > 60.0, "and not taken for failed"
        # redder or bluer than grey, as the mode's colour is
        assert np.sign(late[0] - late[2]) == np.sign(colour[0] - colour[2])


def test_crack_frame_without_softening_is_the_same_whatever_the_damage():
    x, stripe = stripes(4)
    mode = np.array([0, 1, 0, 2])[stripe]
    damage, governs = np.array([0.3, 1.0, 0.1, 1.0])[stripe], np.array([1, 1, 2, 2])[stripe]
    damaged = snapshot_of(x, mode, damage=damage, governs=governs)
    plain, soft = painter("cracks"), painter("cracks", softens=True)
    assert np.array_equal(plain.panel(damaged), plain.panel(snapshot_of(x, mode)))
    assert np.array_equal(plain.panel(snapshot_of(x, mode)), soft.panel(snapshot_of(x, mode)))
    assert not np.array_equal(plain.panel(damaged), soft.panel(damaged))
    assert [name for name, _ in plain.wording.legend] == ["failed in tension", "failed in shear", "intact"]


def test_legend_names_the_tints_in_their_colours():
    frame = painter("cracks", softens=True)
    legend = dict(frame.wording.legend)
    assert list(legend)[2:] == ["cracking in tension", "cracking in shear", "intact"]
    ends = cracking_palette().ramp[[-1, 0]].astype(int)
    assert [legend["cracking in tension"], legend["cracking in shear"]] == [tuple(c) for c in ends]
    x, _ = stripes(1)
    image, box = frame.paint(snapshot_of(x), NO_ROWS), frame.layout.legend
    for colour in legend.values():
        swatch = (image[box.top : box.bottom, box.left : box.left + 20] == colour).all(axis=2)
        assert swatch.sum() > 150  # 18 x 18 pixels with a frame


@pytest.mark.parametrize("margin", [False, True])
def test_gallery_writes_margin_frames_only_when_asked(tmp_path, margin):
    scene = load_scene("cube", quick=True)
    law = SOFT if margin else scene.rock.after_failure
    scene = replace(
        scene,
        output=Output(frames=1, movie=False, margin=margin),
        rock=replace(scene.rock, after_failure=law),
    )
    x, _ = stripes(1)
    (tmp_path / "frames").mkdir()
    gallery = Gallery(commission(scene, "cube", tmp_path, scene.particles()))
    for kind, image in gallery.paint(0, snapshot_of(x), NO_ROWS).items():
        gallery.write(kind, 0, image, 0.0)
    gallery.close(snapshot_of(x), NO_ROWS, [], np.zeros(0))
    names = ["cracks_0000.png", *(["margin_0000.png"] if margin else []), "stress_0000.png"]
    assert sorted(path.name for path in (tmp_path / "frames").iterdir()) == names
    assert len(gallery.painters["cracks"].wording.legend) == (5 if margin else 3), "tints come with softening"
    sizes = {Image.open(path).size for path in (tmp_path / "frames").iterdir()}
    assert len(sizes) == 1
