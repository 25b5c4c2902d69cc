"""A scene.json of a stranger: one line for each of five hundred, no traceback, no hang, and a bound on its size."""

import json
import os
import subprocess
import sys
import time

import crafted
import pytest
from drawn import PLATE, SECTION, scene
from hostile import check_runnable, clear, quickly

from rsmpm_ti import Difference, Mask, Mesh, Polygon, Segments, Turned, load_scene
from rsmpm_ti.errors import SceneError
from rsmpm_ti.scene import main
from rsmpm_ti.spec import scene_json
from rsmpm_ti.spec.scene_json import read_scene, to_plain


@pytest.fixture(scope="module")
def texts() -> list[str]:
    """Sound records."""
    shipped = [load_scene(name, quick=True) for name in ("cube", "cube_lab", "two_flaws")]
    plate, mask = Mesh(file=PLATE), Mask(image=SECTION, mm_per_pixel=1.0, greys=(0, 100), origin=(0.05, 0.0))
    flaws = Segments(traces=((0.01, 0.02, 0.02, 0.026), (0.022, 0.05, 0.034, 0.058)), width=4e-3)
    wedge = Polygon(points=((0.11, 0.0), (0.15, 0.0), (0.14, 0.08)))
    drawn = scene(Difference(whole=plate, removed=(flaws,)), mask, Turned(region=wedge, angle=10.0))
    return [json.dumps({"scene": to_plain(made)}) for made in (*shipped, drawn)]


def is_sound(seed: int, texts: list[str], path) -> bool:
    """Whether a crafted record is a scene that runs; else it is refused in one clear line."""
    path.write_bytes(crafted.record(seed, texts[seed % len(texts)]))
    try:
        with quickly():
            scene = read_scene(path)
            check_runnable(scene)
    except SceneError as error:
        assert clear(str(error)), error
        return False
    return True


def test_four_dozen_crafted_ones_are_refused_or_run(texts, tmp_path):
    assert 30 < [is_sound(seed, texts, tmp_path / "scene.json") for seed in range(48)].count(False) < 48


@pytest.mark.validation
def test_five_hundred_crafted_ones_are_refused_or_run(texts, tmp_path, capsys):
    """By the command, too."""
    path = tmp_path / "scene.json"
    for seed in range(500):
        sound = is_sound(seed, texts, path)
        capsys.readouterr()
        assert main([str(path), "--check"]) == (0 if sound else 2), seed
        lines = capsys.readouterr().err.splitlines()
        assert all(line.startswith("rsmpm_ti: ") and clear(line) for line in lines) and len(lines) >= (not sound)


def test_one_that_is_larger_than_any_scene_is_not_read(tmp_path, monkeypatch):
    path = tmp_path / "scene.json"
    with open(path, "wb") as file:
        file.truncate(20 * 2**30)  # of holes: it takes nothing on the disk
    start = time.perf_counter()
    with pytest.raises(SceneError, match="is larger than 16 MiB"):
        read_scene(path)
    assert time.perf_counter() - start < 5.0
    monkeypatch.setattr(scene_json, "LARGEST_BYTES", 100)
    path.write_text(" " * 101)
    with pytest.raises(SceneError, match="is larger than"):
        read_scene(path)


def test_the_most_bodies_are_still_a_record(tmp_path):
    from rsmpm_ti.spec.scene import MAX_BODIES

    plain = to_plain(load_scene("cube", quick=True))
    plain["bodies"] *= MAX_BODIES
    assert len(json.dumps({"scene": plain}, indent=2)) < scene_json.LARGEST_BYTES


def test_two_keys_among_a_hundred_thousand_are_found_at_once(tmp_path):
    path = tmp_path / "scene.json"
    path.write_text("{" + ", ".join(f'"{k}": 0' for k in [*range(100_000), 99_999]) + "}")
    with quickly(), pytest.raises(SceneError, match="'99999' stands twice"):
        read_scene(path)


def test_what_waits_without_end_is_no_record(tmp_path):
    os.mkfifo(tmp_path / "scene.json")
    done = subprocess.run(
        [sys.executable, "-m", "rsmpm_ti.scene", str(tmp_path / "scene.json"), "--check"],
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert done.returncode == 2 and len(done.stderr.splitlines()) == 1
