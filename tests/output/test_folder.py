"""The folder of a run: what is in it is looked at before anything changes, and only a run's own files ever go."""

import os
import re
from dataclasses import replace
from pathlib import Path

import pytest
from folders import FILES, SCENE, begun, contents, mark_of, refusal, run

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output import lock, manifest
from rsmpm_ti.output.earlier import previous_of
from rsmpm_ti.output.folder import FolderGone, prepare
from rsmpm_ti.records.files import write_json
from rsmpm_ti.run.attempts import Attempts

YOURS = (
    "checkpoint_mine.npz", "frames/photo_0001.png", "frames/stress_0001_small.png", "particles_0099.vtu",
    ".notes.part1", ".writable", "frames/.thumbs.part.png", "notes.txt",
)  # fmt: skip


@pytest.fixture(autouse=True)
def no_loss_of_power(monkeypatch):
    """Nothing here waits for the disk."""
    monkeypatch.setattr(os, "fsync", lambda _: None)


def test_a_run_is_refused_where_one_is_unless_it_replaces_it_or_goes_on(tmp_path):
    out = tmp_path / "out"
    run(out, "first")
    assert "--overwrite" in refusal(out) and "--resume" in refusal(out)
    run(out, "second", overwrite=True)
    assert mark_of(out) == "second" and not previous_of(out).exists()
    run(out, "second", resume=True)
    assert mark_of(out) == "second"


def test_files_of_the_user_stay_whatever_their_names(tmp_path):
    (tmp_path / "frames").mkdir()
    for name in YOURS:
        (tmp_path / name).write_text("yours")
    for how in ({}, {"overwrite": True}, {"resume": True}, {"overwrite": True}):
        run(tmp_path, "run", **how)
        assert all((tmp_path / name).read_text() == "yours" for name in YOURS)
    assert not previous_of(tmp_path).exists()


@pytest.mark.parametrize("name", ["history.csv", "frames/cracks_0003.png", "checkpoint.npz", ".cube.part.mp4"])
@pytest.mark.parametrize("how", [{}, {"resume": True}])
def test_a_file_of_the_user_under_a_name_of_the_run_is_refused_and_stays(tmp_path, name, how):
    (tmp_path / name).parent.mkdir(exist_ok=True)
    (tmp_path / name).write_text("yours")
    assert f"{name} is in the way" in refusal(tmp_path, **how)
    (tmp_path / name).unlink()
    run(tmp_path, "run")
    (tmp_path / name).unlink(missing_ok=True)
    listed = manifest.read(tmp_path)
    manifest.write(tmp_path, replace(listed, names=tuple(n for n in listed.names if n != name)))
    (tmp_path / name).write_text("yours")
    assert f"{name} is in the way" in refusal(tmp_path, overwrite=True)


def test_a_file_that_comes_in_the_way_later_is_refused_too(tmp_path):
    folder = begun(tmp_path)
    (tmp_path / "events.csv").write_text("yours")
    with pytest.raises(SceneError, match="events.csv is in the way"):
        folder.file("events.csv")
    folder.release()


def test_the_run_before_is_kept_until_the_new_one_is_complete(tmp_path):
    out, previous = tmp_path / "out", tmp_path / "out.previous"
    run(out, "first")
    run(out, "stopped", complete=False, overwrite=True)
    assert (mark_of(out), mark_of(previous)) == ("stopped", "first")
    (previous / "notes.txt").write_text("yours")
    run(out, "again", complete=False, overwrite=True)  # the one that is not complete goes, not the complete one
    assert (mark_of(out), mark_of(previous)) == ("again", "first")
    run(out, "again", resume=True)
    assert mark_of(out) == "again" and [p.name for p in previous.iterdir()] == ["notes.txt"]


def test_something_else_in_the_place_of_the_run_before_is_refused(tmp_path):
    out, previous = tmp_path / "out", tmp_path / "out.previous"
    run(out, "first")
    run(previous, "a run of its own")
    assert "out.previous is in the way" in refusal(out, overwrite=True)
    assert mark_of(previous) == "a run of its own"


def test_what_the_user_put_beside_the_run_that_was_set_aside_stays(tmp_path):
    out, previous = tmp_path / "out", tmp_path / "out.previous"
    run(out, "first")
    run(out, "second", complete=False, overwrite=True)
    run(out, "second", resume=True, complete=False)
    names = manifest.read(previous)
    (previous / "history.csv").write_text("yours")
    manifest.write(previous, replace(names, names=tuple(name for name in names.names if name != "history.csv")))
    write_json(out / "summary.json", {"complete": True})
    with pytest.raises(SceneError, match="history.csv is in the way"):
        run(out, "third", overwrite=True)
    assert (previous / "history.csv").read_text() == "yours"
    assert (mark_of(out), (previous / FILES[0]).read_text()) == ("second", "first")


def test_a_full_disk_leaves_a_list(tmp_path, monkeypatch):
    folder, write = begun(tmp_path), os.write
    with monkeypatch.context() as patch:
        patch.setattr(os, "write", lambda descriptor, data: write(descriptor, data[:5]))
        with pytest.raises(SceneError, match="cannot be written: No space left on device"):
            folder.file("history.csv")
    folder.file("events.csv")
    folder.release()
    assert manifest.read(tmp_path).names == ("scene.json", "events.csv")


HEAD = f"{manifest.HEAD}, {'0' * 32}, here\n"


@pytest.mark.parametrize(
    "listed",
    ["../victim", "/etc/passwd", "frames/../../victim", "a/b.csv", "notes.txt", "history.csv/..", "", "x\\y.csv"],
)
def test_a_list_that_names_what_no_run_makes_is_refused(tmp_path, listed):
    (tmp_path / manifest.FILE).write_text(f"{HEAD}scene.json\n{listed}\n")
    assert "is no list of a run's files" in refusal(tmp_path, overwrite=True)


def test_a_list_whose_last_line_a_kill_has_cut_is_a_list(tmp_path):
    run(tmp_path, "run")
    with open(tmp_path / manifest.FILE, "a") as file:
        file.write("frames/stre")
    run(tmp_path, "again", overwrite=True)
    assert mark_of(tmp_path) == "again"


LINKS = ("frames", "frames/stress_0000.png", "summary.json", "scene.json", manifest.FILE, lock.FILE, ".writable")


@pytest.mark.parametrize("how", [{"overwrite": True}, {"resume": True}])
@pytest.mark.parametrize("link", [*LINKS, ".scene.part.json", ".manifest.part.txt"])
def test_no_link_is_followed_out_of_the_folder(tmp_path, link, how):
    out, outside = tmp_path / "out", tmp_path / "outside"
    run(out, "first")
    outside.mkdir()
    (outside / "stress_0000.png").write_text("yours")
    target = outside if link == "frames" else outside / "stress_0000.png"
    if link == "frames":
        for path in (out / "frames").iterdir():
            path.unlink()
        (out / "frames").rmdir()
    (out / link).unlink(missing_ok=True)
    (out / link).symlink_to(target)
    if link.startswith(".") and link != lock.FILE:  # a name that is new each time, or made so
        run(out, "second", **how)
    else:
        refusal(out, **how)
    assert contents(outside) == {"stress_0000.png": b"yours"}


def test_a_pipe_in_place_of_a_file_does_not_hang(tmp_path):
    for name in (manifest.FILE, lock.FILE):
        os.mkfifo(tmp_path / name)
        with pytest.raises(SceneError, match=name):
            prepare(SCENE, tmp_path, "cube")
        (tmp_path / name).unlink()


def test_a_run_that_is_refused_leaves_no_folder_behind(tmp_path):
    folder = prepare(SCENE, tmp_path / "a" / "b", "cube")
    folder.release()
    assert not (tmp_path / "a").exists()


@pytest.mark.parametrize(
    ("how", "when"),
    [*((how, when) for how in ("renamed", "removed", "replaced") for when in ("before it begins", "after")),
     ("frames replaced", "after")],
)  # fmt: skip
def test_a_folder_that_is_not_the_one_it_was_is_told(tmp_path, how, when):
    out = tmp_path / "out"
    folder = prepare(SCENE, out, "cube")
    if when == "after":
        folder.begin()
    if how == "frames replaced":
        (out / "frames").rename(tmp_path / "elsewhere")
        (out / "frames").mkdir()
    elif how == "removed":
        for path in sorted(out.rglob("*"), reverse=True):
            path.rmdir() if path.is_dir() else path.unlink()
        out.rmdir()
    else:
        out.rename(tmp_path / "elsewhere")
    if how == "replaced":
        out.mkdir()
        (out / "history.csv").write_text("yours")
    with pytest.raises(FolderGone, match="was moved, removed or replaced during the run"):
        folder.begin() if when != "after" else folder.file("history.csv")
    folder.release()
    if how == "replaced":
        assert contents(out) == {"history.csv": b"yours"}


@pytest.mark.parametrize("harm", ["removed", "emptied"])
def test_files_that_went_missing_during_the_run_are_told(tmp_path, harm):
    folder = begun(tmp_path)
    for name in FILES:
        folder.file(name).write_text("run")
    folder.verify()
    (tmp_path / FILES[0]).unlink() if harm == "removed" else (tmp_path / FILES[0]).write_bytes(b"")
    attempt = Attempts()
    attempt(folder.verify)
    assert isinstance(attempt.problem, FolderGone)
    assert re.search("frames/stress_0000.png in .* went missing, or was emptied, during the run$", str(attempt.problem))
    folder.release()


def test_the_default_folder_of_a_version_without_lists_is_moved_as_a_whole(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    out = Path("renders/cube")
    out.mkdir(parents=True)
    for name in ("scene.json", "cube.mp4", "notes.txt"):
        (out / name).write_text("old")
    other = Path("elsewhere")
    other.mkdir()
    (other / "scene.json").write_text("old")
    for how in ({}, {"overwrite": True}, {"resume": True}):
        assert "without manifest.txt a run's files cannot be told from yours" in refusal(other, **how)
    run(out, "new", overwrite=True)
    assert mark_of(out) == "new"
    assert contents(Path("renders/cube.previous")) == dict.fromkeys(("scene.json", "cube.mp4", "notes.txt"), b"old")
    assert "cube.previous is in the way" in refusal(out, overwrite=True), "nobody knows what may be removed there"


def test_a_run_that_goes_on_is_not_complete_meanwhile_and_loses_no_table(tmp_path):
    run(tmp_path, "first")
    folder = begun(tmp_path, resume=True)
    assert '"complete": false' in (tmp_path / "summary.json").read_text()
    assert mark_of(tmp_path) == "first"
    folder.release()


def test_without_a_checkpoint_resume_does_not_replace_a_complete_run(tmp_path):
    run(tmp_path, "first")
    folder = prepare(SCENE, tmp_path, "cube", resume=True)
    with pytest.raises(SceneError, match="the run there is complete; --overwrite"):
        folder.start_anew()
    folder.release()
    assert mark_of(tmp_path) == "first"


@pytest.mark.parametrize("name", ["", "a/b", "a\nb", "../a"])
def test_a_name_that_is_no_file_name_is_refused(tmp_path, name):
    with pytest.raises(SceneError, match="^name = "):
        prepare(SCENE, tmp_path / "out", name)
