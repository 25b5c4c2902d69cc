"""Outlines, images and meshes as specimens: what lies within, how much it is, and what is refused in one line."""

import json
import pickle
import sys
from dataclasses import replace
from pathlib import Path

import meshio
import numpy as np
import pytest
from drawn import CORE, CORE_TETRA, OUTLINE, PLATE, SECTION, refused, scene
from PIL import Image

from rsmpm_ti import (
    Difference,
    Disc,
    Jittered,
    Lattice,
    Mask,
    Mesh,
    Polygon,
    Turned,
    Union,
    lab_rock,
    mask_bodies,
    mm,
)
from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.drawings import mask as mask_module
from rsmpm_ti.spec.drawings import mesh_file
from rsmpm_ti.spec.review.placement import area_errors, measure
from rsmpm_ti.spec.scene_json import from_plain, to_plain

NOTCHED = ((0.0, 0.0), (0.04, 0.0), (0.04, 0.08), (0.0, 0.08), (0.01, 0.04))


def shoelace(points) -> float:
    """By the shoelace formula."""
    x, y = np.array(points).T
    return 0.5 * abs(float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1))))


DRAWN = {
    "polygon": (Polygon(points=NOTCHED), shoelace(NOTCHED)),
    "polygon with a hole": (
        Polygon(points=NOTCHED, holes=([(0.02, 0.02), (0.03, 0.02), (0.03, 0.03)],)),
        shoelace(NOTCHED) - 50e-6,
    ),
    "thin section": (Mask(image=SECTION, mm_per_pixel=1.0, greys=(0, 100)), None),
    "gmsh": (Mesh(file=PLATE), 0.04 * 0.08),
    "gmsh group": (Mesh(file=PLATE, group="granite"), None),
    "flat stl": (Mesh(file=OUTLINE, scale=1e-3), (40 * 80 - 10 * 4) * 1e-6),
    "turned": (Turned(region=Polygon(points=NOTCHED), angle=27.0), shoelace(NOTCHED)),
}


@pytest.mark.parametrize("seeding", [Lattice(), Lattice(fitted=True), Jittered(fitted=True)], ids=repr)
@pytest.mark.parametrize("region, area", DRAWN.values(), ids=DRAWN)
def test_drawing_becomes_a_specimen_of_its_area(region, area, seeding):
    area = measure(region) if area is None else area
    assert measure(region) == pytest.approx(area, rel=1e-9)
    made = scene(region, seeding=seeding)
    (seeds,) = made.particles()
    perimeter = 0.3  # of the longest of them [m]; stairs err by at most half a sub-cell along it, in the mean by none
    assert seeds.volume.sum() == pytest.approx(area, rel=1e-3 if seeding.fitted else 0.5e-3 * perimeter * 0.1 / area)
    assert region.contains(seeds.x).mean() > 0.99  # a centroid of a cut sub-cell may lie in a notch
    assert area_errors(made, [seeds])[0] == pytest.approx(seeds.volume.sum() / area - 1.0)


@pytest.mark.parametrize("region, _", DRAWN.values(), ids=DRAWN)
def test_record_of_a_drawing_is_read_back(region, _):
    made = scene(region)
    again = from_plain(json.loads(json.dumps(to_plain(made), allow_nan=False)))
    assert again == made
    x = np.random.default_rng(1).uniform(*region.bounds(), (5000, 2))
    np.testing.assert_array_equal(again.bodies[0].region.contains(x), region.contains(x))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(region)).contains(x), region.contains(x))
    fraction = region.contains(x).mean() * np.prod(np.subtract(*region.bounds()[::-1]))
    assert fraction == pytest.approx(measure(region), rel=0.05)


# --- outlines


def test_a_ring_closes_itself_and_may_be_an_array():
    closed = Polygon(points=[*NOTCHED, NOTCHED[0]])
    assert closed.area == Polygon(points=np.array(NOTCHED)[::-1]).area == Polygon(points=NOTCHED).area
    for points in (np.array(NOTCHED), list(np.array(NOTCHED)), [list(corner) for corner in NOTCHED]):
        assert Polygon(points=points) == Polygon(points=NOTCHED)


def test_outline_that_is_none_is_refused():
    bow = ((0, 0), (1, 1), (1, 0), (0, 1))
    refused(lambda: Polygon(points=bow), "polygon.points", "Self-intersection at (0.5 0.5)")
    refused(lambda: Polygon(points=((0, 0), (1, 1), (2, 2))), "polygon.points", "has an area")
    refused(lambda: Polygon(points=((0, 0), (1, 1))), "polygon.points", "3 to")
    refused(lambda: Polygon(points=((0, 0), (1, 1), (float("nan"), 0))), "polygon.points")
    hole = ((5.0, 5.0), (6.0, 5.0), (6.0, 6.0))
    refused(lambda: Polygon(points=((0, 0), (1, 0), (1, 1)), holes=(hole,)), "polygon.holes", "outside shell")
    ball = Disc(centre=(0.0, 0.0, 0.0), radius=0.01)
    refused(lambda: Union(parts=(Polygon(points=NOTCHED), ball)), "of one dimension")


def test_outline_without_its_library_is_one_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "shapely", None)
    refused(lambda: Polygon(points=NOTCHED), "pip install shapely")


# --- images


def test_top_row_of_an_image_is_up(tmp_path):
    grey = np.full((3, 2), 255, dtype=np.uint8)
    grey[0, 1] = 7  # the upper right pixel
    Image.fromarray(grey).save(tmp_path / "a.png")
    region = Mask(image=tmp_path / "a.png", mm_per_pixel=10.0, greys=(7, 7), origin=(1.0, 2.0))
    np.testing.assert_allclose(region.bounds(), [[1.01, 2.02], [1.02, 2.03]])
    assert region.contains(np.array([[1.015, 2.025], [1.005, 2.025], [1.015, 2.005], [-9.0, 2.0]])).tolist() == [
        True, False, False, False,
    ]  # fmt: skip
    assert region.area == pytest.approx(1e-4)


def test_greys_of_an_image_take_its_rocks_apart():
    rock, vein = (Mask(image=SECTION, mm_per_pixel=1.0, greys=(k, k)) for k in (60, 120))
    assert vein.area == pytest.approx(4 * 40e-6)
    assert rock.area + vein.area == pytest.approx(Mask(image=SECTION, mm_per_pixel=1.0, greys=(0, 120)).area)
    bodies = scene(rock, vein).particles()  # side by side, none in the other
    assert sum(body.volume.sum() for body in bodies) == pytest.approx(rock.area + vein.area)


def test_each_grey_may_be_a_body_of_its_own_rock():
    vein = lab_rock(G_f_I=2.0)
    bodies = mask_bodies(image=SECTION, mm_per_pixel=1.0, rocks={60: None, (110, 130): vein})
    assert [body.rock for body in bodies] == [None, vein]
    assert bodies[1].region == Mask(image=SECTION, mm_per_pixel=1.0, greys=(110, 130))
    for rocks in ({}, [60], {7: vein}, {"dark": vein}, {60: 3.0}):
        with pytest.raises(SceneError) as error:
            mask_bodies(image=SECTION, mm_per_pixel=1.0, rocks=rocks)
        assert "\n" not in str(error.value)


@pytest.mark.parametrize("mode", ["L", "RGB", "RGBA", "P", "LA", "CMYK", "1", "I;16", "F"])
def test_images_of_any_kind_have_greys(mode, tmp_path):
    grey = np.full((8, 8), 255, dtype=np.uint8)
    grey[2:6, 2:6] = 0
    image = Image.fromarray(grey)
    deep = {"I;16": np.uint16, "F": np.float32}.get(mode)
    image = image.convert(mode) if deep is None else Image.fromarray(grey.astype(deep) * 200)
    name = tmp_path / ("a.png" if mode in ("L", "RGB", "RGBA", "P", "LA", "1", "I;16") else "a.tif")
    image.save(name)
    assert Mask(image=name, mm_per_pixel=1.0, greys=(0, 9)).area == pytest.approx(16e-6)


def test_colour_is_grey_by_its_luma_and_a_transparent_pixel_is_no_rock(tmp_path):
    colours = np.zeros((1, 3, 4), dtype=np.uint8)
    colours[0] = (200, 0, 0, 255), (0, 200, 0, 255), (0, 200, 0, 20)
    Image.fromarray(colours).save(tmp_path / "a.png")
    for level, count in ((60, 1), (117, 1)):  # 0.299 x 200 and 0.587 x 200
        assert Mask(image=tmp_path / "a.png", mm_per_pixel=1.0, greys=(level - 1, level + 1)).area == count * 1e-6


def test_image_that_is_none_is_refused(tmp_path, monkeypatch):
    def mask(name, greys=(0, 100)):
        return lambda: Mask(image=str(name), mm_per_pixel=1.0, greys=greys)

    refused(mask(tmp_path / "no.png"), "mask.image", "No such file")
    refused(mask(tmp_path), "mask.image", "regular file")
    refused(mask("a\x00b"), "mask.image")
    refused(mask(PLATE), "mask.image", "an image, one of PNG")
    refused(mask(SECTION, greys=(200, 210)), "mask.greys = (200.0, 210.0)", "60 to 255")
    data = Path(SECTION).read_bytes()
    for damaged in (b"", data[:20], data[:-60], data[:60] + b"xxxx" + data[64:]):
        (tmp_path / "broken.png").write_bytes(damaged)
        refused(mask(tmp_path / "broken.png"), "mask.image")
    first = Image.open(SECTION)
    first.save(tmp_path / "two.tif", save_all=True, append_images=[first])
    refused(mask(tmp_path / "two.tif"), "it holds 2")
    monkeypatch.setattr(mask_module, "MAX_PIXELS", 100)
    refused(mask(SECTION), "mask.image", "50 x 90", "scale it down")
    monkeypatch.setattr(mask_module, "MAX_BYTES", 100)
    refused(mask(SECTION), "mask.image", "regular file of at most")


def test_bomb_is_refused_before_it_unfolds(tmp_path):
    Image.new("1", (20_000, 20_000)).save(tmp_path / "bomb.png")  # fifty kB
    refused(lambda: Mask(image=tmp_path / "bomb.png", mm_per_pixel=1.0, greys=(0, 1)), "mask.image")


# --- meshes


def test_groups_of_gmsh_are_bodies_side_by_side():
    granite, inclusion = (Mesh(file=PLATE, group=name) for name in ("granite", "inclusion"))
    assert granite.area + inclusion.area == pytest.approx(0.04 * 0.08)
    assert inclusion.area == pytest.approx(np.pi * 0.008**2, rel=0.15)  # of an octagon
    assert len(scene(granite, inclusion).particles()) == 2
    refused(lambda: Mesh(file=PLATE, group="basalt"), "mesh.group = 'basalt'", "granite, inclusion")


@pytest.mark.parametrize("file", [CORE, CORE_TETRA], ids=["stl", "tetra"])
def test_closed_mesh_becomes_a_body_in_3d(file):
    region = Mesh(file=file, scale=1e-3, origin=(0.01, 0.0, -0.005))
    np.testing.assert_allclose(region.bounds(), [[0.002, -0.008, -0.005], [0.018, 0.008, 0.015]], atol=1e-5)
    assert measure(region) == pytest.approx(tetrahedra_volume() * 1e-9, rel=1e-3)
    (seeds,) = scene(region).particles()
    assert seeds.volume.sum() == pytest.approx(tetrahedra_volume() * 1e-9, rel=0.02)  # stairs of half a millimetre
    axis = np.array([[0.01, 0.0, 0.005], [0.01, 0.0, 0.013], [0.01, 0.0, 0.016]])
    assert region.contains(axis).tolist() == [False, True, False]  # in the cavity, above it, above the core


def tetrahedra_volume() -> float:
    mesh = meshio.read(CORE_TETRA)
    a, b, c, d = mesh.points[mesh.cells_dict["tetra"]].transpose(1, 0, 2)
    return float(np.abs(np.einsum("nd,nd->n", b - a, np.cross(c - a, d - a))).sum() / 6.0)


def write(path: Path, points, **cells) -> Path:
    meshio.Mesh(np.array(points, dtype=float), list(cells.items())).write(path)
    return path


CUBE = [(x, y, z) for z in (0.0, 1.0) for y in (0.0, 1.0) for x in (0.0, 1.0)]
QUADS = [(0, 1, 3, 2), (4, 5, 7, 6), (0, 1, 5, 4), (2, 3, 7, 6), (0, 2, 6, 4), (1, 3, 7, 5)]


def test_points_over_edges_and_corners_are_told_right(tmp_path):
    """Rays along z then go through edges and corners: each crosses once."""
    region = Mesh(file=write(tmp_path / "cube.obj", CUBE, quad=QUADS))
    s = np.linspace(-0.25, 1.25, 7)
    x = np.stack([axis.ravel() for axis in np.meshgrid(s, s, s)], axis=1)
    on_a_face = np.any((x == 0.0) | (x == 1.0), axis=1)
    expected = np.all((x > 0.0) & (x < 1.0), axis=1)
    np.testing.assert_array_equal(region.contains(x)[~on_a_face], expected[~on_a_face])
    assert measure(region) == pytest.approx(1.0)


def test_quads_and_curved_triangles_fill_a_plane(tmp_path):
    square = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
    assert Mesh(file=write(tmp_path / "a.obj", square, quad=[(0, 1, 2, 3)]), scale=0.1).area == pytest.approx(0.01)
    curved = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0.5, 0, 0), (0.5, 0.5, 0), (0, 0.5, 0)]
    mesh = meshio.Mesh(np.array(curved, dtype=float), [("triangle6", [(0, 1, 2, 3, 4, 5)])])
    mesh.write(tmp_path / "b.msh", file_format="gmsh", binary=False)
    region = Mesh(file=tmp_path / "b.msh", origin=(2.0, 3.0))
    assert region.area == pytest.approx(0.5)
    np.testing.assert_allclose(region.bounds(), [[2.0, 3.0], [3.0, 4.0]])


def test_mesh_that_is_none_is_refused(tmp_path, capfd, monkeypatch):
    def mesh(name, **fields):
        return lambda: Mesh(file=str(name), **fields)

    refused(mesh(tmp_path / "no.stl"), "mesh.file", "No such file")
    refused(mesh(SECTION), "mesh.file", ".msh, .stl")
    refused(mesh(write(tmp_path / "open.obj", CUBE, quad=QUADS[1:])), "mesh.file", "4 of its edges are open")
    refused(mesh(write(tmp_path / "edge-on.obj", np.array(CUBE)[:4, [0, 2, 1]], quad=[QUADS[0]])), "open")
    bow = [(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)]
    refused(mesh(write(tmp_path / "bow.obj", bow, quad=[(0, 1, 2, 3)])), "cross themselves")
    meshio.Mesh(np.array(CUBE), [("line", [(0, 1)])]).write(tmp_path / "line.msh", file_format="gmsh", binary=False)
    refused(mesh(tmp_path / "line.msh"), "mesh.file", "it has none")
    refused(mesh(OUTLINE, origin=(0.0, 0.0, 0.0)), "mesh.origin", "2 coordinates")
    refused(mesh(OUTLINE, scale=1e9), "mesh.scale")
    write(tmp_path / "packed.vtu", CUBE, quad=QUADS)
    refused(mesh(tmp_path / "packed.vtu"), "mesh.file", "meshio decompress")
    (tmp_path / "laugh.vtu").write_text('<!DOCTYPE a [<!ENTITY a "aaaa">]><VTKFile>&a;</VTKFile>')
    refused(mesh(tmp_path / "laugh.vtu"), "mesh.file", "definitions of its own")
    data = Path(PLATE).read_bytes()
    for damaged in (
        b"",
        data[:300],
        data[:2000],
        data.replace(b"$Nodes", b"$Node5"),
        data.replace(b"1 2 ", b"9 9999 "),
    ):
        (tmp_path / "broken.msh").write_bytes(damaged)
        refused(mesh(tmp_path / "broken.msh"), "mesh.file")
    monkeypatch.setattr(mesh_file, "MAX_CELLS", 3)
    refused(mesh(PLATE), "mesh.file", "at most 3 cells")
    capfd.readouterr()
    refused(mesh(tmp_path / "broken.msh"), "mesh.file")
    assert capfd.readouterr() == ("", "")  # what meshio has to say is in the line


def test_drawings_combine_with_other_regions():
    plate, hole = Mesh(file=PLATE), Disc(centre=(0.02, 0.04), radius=5 * mm)
    cut = Difference(whole=plate, removed=(hole,))
    assert measure(cut) == pytest.approx(0.0032 - np.pi * 25e-6, rel=1e-3)
    both = Union(parts=(Polygon(points=NOTCHED), replace(plate, origin=(0.05, 0.0))))
    assert measure(both) == pytest.approx(shoelace(NOTCHED) + 0.0032, rel=1e-3)
