"""Folders of runs that a stranger made, or that were damaged: read by their list, or refused in one line."""

import json
import os
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from rsmpm_ti import SceneError, load_result
from rsmpm_ti.output import manifest
from rsmpm_ti.output.manifest import Manifest
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.results import loading, movie, painted

EVENTS = "time_s,true_time_s,x_m,y_m,mode,sigma_1_Pa,sigma_3_Pa,released_energy_J"
TEXTS = {
    "summary.json": '{"stopped": "", "time_scale": 5.0, "largest_stress_Pa": 2e6, "failed_tension": 1}',
    "history.csv": "\r\n".join(
        [",".join(HISTORY_COLUMNS), *(",".join([f"{k}e-3", *["0.5"] * (len(HISTORY_COLUMNS) - 1)]) for k in range(3))]
    ),
    "events.csv": f"{EVENTS}\r\n1e-3,2e-4,0.01,0.02,shear,1e6,-2e6,\r\n",
    "frames.csv": "frame,time_s,axial_strain,nominal_stress_Pa\r\n0,0,,\r\n1,2e-3,0.5,0.5\r\n",
}
PICTURES = ("frames/cracks_0000.png", "frames/cracks_0001.png")


@pytest.fixture
def folder(tmp_path) -> Path:
    """Of a run that was never run: its tables, two frames, and a movie."""
    out = tmp_path / "run"
    (out / "frames").mkdir(parents=True)
    for name, text in TEXTS.items():
        (out / name).write_text(text, encoding="utf-8", newline="")
    for name, grey in zip(PICTURES, (10, 20), strict=True):
        Image.new("RGB", (8, 8), (grey,) * 3).save(out / name)
    (out / "a&b.mp4").write_bytes(b"film")
    manifest.write(out, Manifest(names=(*TEXTS, *PICTURES, "a&b.mp4")))
    return out


def refusal(ask) -> str:
    with pytest.raises(SceneError) as refused:
        ask()
    assert "\n" not in str(refused.value) and len(str(refused.value)) < 1000
    return str(refused.value)


def test_a_sound_folder_is_read(folder):
    result = load_result(str(folder))
    assert len(result.history) == 3 and result.history["time_s"].tolist() == [0.0, 1e-3, 2e-3]
    assert result.events.mode.tolist() == [2] and np.isnan(result.events.released[0])
    assert result.events.x.tolist() == [[0.01, 0.02]] and result.events.true_time.tolist() == [2e-4]
    assert result.reactions is None and np.isnan(result.frames["axial_strain"][0])
    assert [result.frame(at=at).getpixel((0, 0))[0] for at in ("start", "first failure", "end")] == [10, 10, 20]
    assert result.movie()._repr_html_().count("ZmlsbQ==") == 1


def test_a_frame_that_is_gone_gives_way_to_the_next(folder):
    (folder / PICTURES[1]).unlink()
    assert load_result(folder).frame(at="end").getpixel((0, 0))[0] == 10


@pytest.mark.parametrize("place", ["nowhere", "", "\0", 3])
def test_a_place_without_a_run_is_refused(tmp_path, monkeypatch, place):
    monkeypatch.chdir(tmp_path)
    assert "folder = " in refusal(lambda: load_result(place))


def test_a_folder_without_a_list_is_refused(folder):
    (folder / manifest.FILE).unlink()
    assert "there is no manifest.txt" in refusal(lambda: load_result(folder))


@pytest.mark.parametrize("name", ["summary.json", "history.csv", "events.csv"])
@pytest.mark.parametrize("how", ["missing", "link", "pipe", "folder", "not listed"])
def test_only_files_of_the_run_itself_are_read(folder, tmp_path, name, how):
    (folder / name).rename(tmp_path / "elsewhere")
    if how == "link":
        (folder / name).symlink_to(tmp_path / "elsewhere")
    elif how == "pipe":
        os.mkfifo(folder / name)
    elif how == "folder":
        (folder / name).mkdir()
    elif how == "not listed":
        (tmp_path / "elsewhere").rename(folder / name)
        manifest.write(folder, Manifest(names=tuple(entry for entry in TEXTS if entry != name)))
    assert f"{name} is not there" in refusal(lambda: load_result(folder))


@pytest.mark.parametrize(
    "name, text",
    [
        ("summary.json", ""),
        ("summary.json", "[1]"),
        ("summary.json", "[" * 100_000),
        ("summary.json", '{"a": ' + "9" * 5000 + "}"),
        ("history.csv", ""),
        ("history.csv", "time_s\r\n1\r\n"),
        ("history.csv", TEXTS["history.csv"] + "\r\n1,2"),
        ("history.csv", TEXTS["history.csv"].replace("0.5", "__import__('os')", 1)),
        ("history.csv", TEXTS["history.csv"].replace("true_time_s", "time_s")),
        ("history.csv", TEXTS["history.csv"].replace("true_time_s", "")),
        ("history.csv", ",".join(map(str, range(20_000)))),
        ("history.csv", '"' + "x" * 200_000),
        ("events.csv", TEXTS["events.csv"].replace("shear", "3")),
        ("events.csv", TEXTS["events.csv"].replace("y_m", "z_m")),
        ("frames.csv", "frame\r\n0"),
        ("frames.csv", "frame,time_s\r\n1e300,0"),
        ("frames.csv", "frame,time_s\r\n,0"),
    ],
)
def test_what_is_damaged_is_refused(folder, name, text):
    (folder / name).write_text(text, encoding="utf-8", newline="")
    assert name in refusal(lambda: load_result(folder))


def test_bytes_that_are_no_text_are_refused(folder):
    for name in TEXTS:
        whole = (folder / name).read_bytes()
        (folder / name).write_bytes(b"\xff\xfe\x00" + whole)
        assert name in refusal(lambda: load_result(folder))
        (folder / name).write_bytes(whole)


def test_files_beyond_their_bounds_are_refused(folder, monkeypatch):
    result = load_result(folder)
    monkeypatch.setattr(painted, "MOST_BYTES", 10)
    assert "no regular file of at most" in refusal(result.frame)
    monkeypatch.setattr(movie, "MOST_BYTES", 2)
    said = result.movie()._repr_html_()
    assert said.startswith("<p>") and "a&amp;b.mp4" in said and "no regular file" in said
    monkeypatch.setattr(loading, "TABLE_BYTES", 20)
    assert "history.csv" in refusal(lambda: load_result(folder))


def test_numbers_that_are_not_finite_are_not_defined(folder):
    (folder / "history.csv").write_text(TEXTS["history.csv"].replace("0.5", "inf"), newline="")
    result = load_result(folder)
    assert np.isnan(result.history["axial_strain"]).all() and result.plot()._repr_png_()
    assert "no load was recorded" in refusal(lambda: result.frame(at="peak"))


def test_a_summary_of_anything_is_shown(folder):
    for value in (None, [], {}, "<b>", 1e400, True, -1, [["<b>"]]):
        (folder / "summary.json").write_text(json.dumps(dict.fromkeys([*json.loads(TEXTS["summary.json"]), "cracks",
            "warnings", "wall_s", "first_failure_mode", "peak_stress_Pa", "steps"], value)))  # fmt: skip
        result = load_result(folder)
        assert "<b>" not in result._repr_html_() and repr(result) and result.events.true_time.shape == (1,)


@pytest.mark.parametrize("data", [b"", b"no picture", b"\x89PNG\r\n\x1a\n" + b"\0" * 50])
def test_a_frame_that_is_no_picture_is_refused(folder, data):
    (folder / PICTURES[1]).write_bytes(data)
    assert "is no picture" in refusal(lambda: load_result(folder).frame(at="end"))


def test_a_picture_that_would_fill_memory_is_refused(folder, monkeypatch):
    monkeypatch.setattr(Image, "MAX_IMAGE_PIXELS", 10)
    assert "is no picture" in refusal(lambda: load_result(folder).frame(at="end"))


def test_frames_beyond_a_link_are_not_read(folder, tmp_path):
    (folder / "frames").rename(tmp_path / "elsewhere")
    (folder / "frames").symlink_to(tmp_path / "elsewhere")
    assert "has no frames" in refusal(lambda: load_result(folder).frame(at="end"))
