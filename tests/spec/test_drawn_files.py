"""Files that scenes and their records name: known again, found, and never a device."""

import json
import os
import shutil

import pytest
from drawn import PLATE, SECTION, refused, scene
from PIL import Image

from rsmpm_ti import Mask, Mesh, load_scene
from rsmpm_ti.spec.drawings.drawn_file import beside
from rsmpm_ti.spec.scene_json import from_plain, to_plain


def test_record_knows_its_file_again(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    shutil.copy(SECTION, "rock.png")
    made = scene(Mask(image="rock.png", mm_per_pixel=1.0, greys=(0, 100)))
    made_area = made.bodies[0].region.area
    record = tmp_path / "run" / "scene.json"
    record.parent.mkdir()
    record.write_text(json.dumps({"scene": to_plain(made)}))
    assert load_scene(str(record)) == made
    shutil.copy(SECTION, record.parent)
    os.rename("rock.png", record.parent / "rock.png")  # beside the record, from wherever it is run
    assert load_scene(str(record)) == made
    assert load_scene(str(record), settings={"bodies.0.region.greys": "0,150"}).bodies[0].region.area > made_area
    Image.open(SECTION).transpose(Image.Transpose.FLIP_TOP_BOTTOM).save(record.parent / "rock.png")
    refused(lambda: load_scene(str(record)), "mask.image = 'rock.png'", "mask.sha256", "without a sha256")
    record.write_text(record.read_text().replace(f'"{made.bodies[0].region.sha256}"', "null"))
    assert load_scene(str(record)).bodies[0].region.sha256 not in (None, made.bodies[0].region.sha256)
    os.remove(record.parent / "rock.png")
    refused(lambda: load_scene(str(record)), "scene.bodies[0].region", "mask.image = 'rock.png'", "No such file")


@pytest.mark.parametrize("kind, field", [("Mask", "image"), ("Mesh", "file")])
def test_record_of_a_stranger_opens_no_device_and_no_pipe(kind, field, tmp_path):
    os.mkfifo(tmp_path / "pipe.msh")
    (tmp_path / "link.msh").symlink_to("/dev/zero")
    (tmp_path / "loop.msh").symlink_to(tmp_path / "loop.msh")
    region = Mesh(file=PLATE) if kind == "Mesh" else Mask(image=SECTION, mm_per_pixel=1.0, greys=(0, 100))
    made = scene(region)
    for name in ("/dev/zero", "/dev/stdin", "/dev/tty", str(tmp_path), *map(str, tmp_path.glob("*.msh"))):
        plain = to_plain(made)
        plain["bodies"][0]["region"] |= {field: name, "sha256": None}
        refused(lambda p=plain: from_plain(p), f"{kind.lower()}.{field}")


def test_huge_file_is_not_read(tmp_path):
    with open(tmp_path / "huge.stl", "wb") as file:
        file.truncate(2**40)  # of holes: it takes nothing on the disk
    refused(lambda: Mesh(file=str(tmp_path / "huge.stl")), "at most 64 MiB")


def test_file_beside_the_scene_is_found(tmp_path, monkeypatch):
    shutil.copy(PLATE, tmp_path / "plate.msh")
    monkeypatch.chdir(tmp_path.parent)
    refused(lambda: Mesh(file="plate.msh"), "No such file")
    with beside(tmp_path):
        assert Mesh(file="plate.msh").sha256 == Mesh(file=PLATE).sha256
    (tmp_path / "mine.py").write_text(
        "from dataclasses import replace\nfrom rsmpm_ti import Body, Mesh, load_scene\n"
        "def scene():\n    made = load_scene('intact')\n"
        "    return replace(made, bodies=(Body(region=Mesh(file='plate.msh')),))\n"
    )
    assert load_scene(str(tmp_path / "mine.py")).bodies[0].region.area == pytest.approx(0.0032)
