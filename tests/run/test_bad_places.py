"""Folders that cannot be written, full disks, missing programs, files that mean harm: one line, and nothing is lost."""

import errno
import importlib.metadata
import io
import json
import os
import resource
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest
from snapshots import snapshot_of
from writer_orders import NO_ROWS, started

from rsmpm_ti.backend import kernel_cache
from rsmpm_ti.errors import SceneError, still_kept
from rsmpm_ti.output.files import CHECKPOINTS, write_checkpoint
from rsmpm_ti.paint.movie import Movie
from rsmpm_ti.paint.png import write_png
from rsmpm_ti.records.files import write_json
from rsmpm_ti.run import checkpoint
from rsmpm_ti.run.attempts import Attempts
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.scene import main
from rsmpm_ti.spec.loader import load_scene
from rsmpm_ti.spec.review import memory
from rsmpm_ti.spec.review.machine import machine
from rsmpm_ti.spec.scene_json import read_scene, to_plain

ROOT = Path(__file__).resolve().parents[2]


def full(*_, **__):
    raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.fixture
def refused(monkeypatch, capsys):
    """refused(*arguments) -> the one line with which the command ends before Taichi is started."""
    monkeypatch.setattr("rsmpm_ti.run.run.start_taichi", lambda *_: pytest.fail("Taichi was started"))
    monkeypatch.setattr("rsmpm_ti.output.writer.Writer", lambda *_: pytest.fail("a process was started"))

    def run(*arguments: str) -> str:
        assert main(["cube", "--quick", *arguments]) == 2
        out, err = capsys.readouterr()
        assert out == "" and err.count("\n") == 1 and err.startswith("rsmpm_ti: ")
        return err

    return run


def in_the_way(tmp_path: Path, kind: str) -> str:
    """An output folder that cannot be: also for root, whom permissions do not bind."""
    if kind == "a file":
        (tmp_path / "out").write_text("kept")
    if kind == "frames is a file":
        (tmp_path / "out").mkdir()
        (tmp_path / "out" / "frames").write_text("kept")
    if kind == "a link in a circle":
        (tmp_path / "out").symlink_to(tmp_path / "out")
    names = {"through a file": "file/out", "too long": "x" * 300, "of no file": "a\0b", "a device": "/dev/null/out"}
    (tmp_path / "file").write_text("kept")
    return names[kind] if kind == "a device" else str(tmp_path / names.get(kind, "out"))


@pytest.mark.parametrize(
    "kind", ["a file", "frames is a file", "a link in a circle", "through a file", "too long", "of no file", "a device"]
)
def test_folder_that_cannot_be_written_is_refused_before_anything_starts(refused, tmp_path, kind):
    message = refused("--out", in_the_way(tmp_path, kind))
    assert "cannot be written" in message and "--out" in message and "make room" not in message
    assert all(path.read_text() == "kept" for path in tmp_path.rglob("*") if path.is_file())


@pytest.mark.parametrize("call", ["tempfile.TemporaryFile", "os.write"])
def test_disk_that_is_full_already_is_refused_before_anything_starts(refused, tmp_path, monkeypatch, call):
    monkeypatch.setattr(call, full)
    assert "No space left on device; make room" in refused("--out", str(tmp_path))
    assert not [path for path in tmp_path.rglob("*") if ".part" in path.name]


def test_file_that_cannot_be_finished_leaves_the_old_one_and_no_part(tmp_path, monkeypatch):
    write_json(tmp_path / "summary.json", {"a": 1})
    write_checkpoint(tmp_path, {"a": np.zeros(3)})
    write_png(tmp_path / "frame.png", np.zeros((4, 4, 3), dtype=np.uint8))
    before = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
    monkeypatch.setattr("os.replace", full)
    monkeypatch.setattr("os.fsync", full)
    for write in (
        lambda: write_json(tmp_path / "summary.json", {"a": 2}),
        lambda: write_checkpoint(tmp_path, {"a": np.ones(3)}),
        lambda: write_png(tmp_path / "frame.png", np.ones((4, 4, 3), dtype=np.uint8)),
    ):
        with pytest.raises(OSError, match="No space left on device"):
            write()
    assert {path.name: path.read_bytes() for path in tmp_path.iterdir()} == before


def test_file_is_on_the_disk_before_it_has_its_name_and_the_name_before_the_next_file(tmp_path, monkeypatch):
    """So that after a loss of power a checkpoint has every frame before it."""
    sync, replace, done = os.fsync, os.replace, []

    def fsync(descriptor: int) -> None:
        done.append(os.path.basename(os.readlink(f"/proc/self/fd/{descriptor}")))
        sync(descriptor)

    def rename(source, target) -> None:
        done.append(f"-> {Path(target).name}")
        replace(source, target)

    monkeypatch.setattr("os.fsync", fsync)
    monkeypatch.setattr("os.replace", rename)
    write_png(tmp_path / "frame.png", np.zeros((4, 4, 3), dtype=np.uint8))
    assert done == [".frame.part.png", "-> frame.png", tmp_path.name]


def test_disk_that_fills_up_ends_the_writer_in_one_line_and_keeps_what_is_complete(tmp_path):
    """The system itself refuses, by a limit on the size of a file that the writing process inherits."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, hard))
    try:
        writer = started(tmp_path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    writer.checkpoint({"a": np.arange(3)})
    writer.checkpoint({"a": np.zeros(100_000)})
    with pytest.raises(SceneError, match="cannot be written: File too large"):
        writer.close(snapshot_of(np.array([[0.025, 0.05]])), NO_ROWS, [], np.zeros(0))
    writer.abandon()
    assert np.array_equal(np.load(tmp_path / CHECKPOINTS[0])["a"], np.arange(3))
    assert not [path for path in tmp_path.rglob("*") if ".part" in path.name]


def test_every_write_is_tried_and_the_first_failure_is_told(tmp_path):
    written, attempt = [], Attempts()
    for work in (full, lambda: written.append(1), lambda: {}["key"], lambda: written.append(2)):
        attempt(work)
    assert written == [1, 2]
    remedy = "what is complete is kept; make room and go on with --resume"
    assert str(attempt.problem) == f"a file cannot be written: No space left on device; {remedy}"


@pytest.mark.parametrize("error, said", [(MemoryError(), "memory has run out"), (KeyError("a"), "KeyError: 'a'")])
def test_whatever_fails_at_the_end_is_told_in_one_line(error, said):
    def fail():
        raise error

    attempt = Attempts()
    assert attempt(fail, what="it cannot be measured") is None
    assert str(attempt.problem) == f"it cannot be measured: {said}; {still_kept(said)}"


def test_movie_is_given_up_where_its_encoder_is_no_program(tmp_path, monkeypatch):
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "ffmpeg"))
    with pytest.raises(RuntimeError, match="no encoder, .* is no program"):
        Movie(tmp_path / "cube.mp4")


def test_movie_that_cannot_be_finished_leaves_nothing(tmp_path):
    pytest.importorskip("imageio_ffmpeg")
    movie = Movie(tmp_path / "cube.mp4")
    movie.add(*(np.zeros((64, 64, 3), dtype=np.uint8) for _ in range(2)))
    movie.discard()
    movie.discard()
    assert not list(tmp_path.iterdir())


def test_machine_is_recorded_without_the_packages_that_movies_need(monkeypatch):
    version = importlib.metadata.version

    def without_imageio(name: str) -> str:
        if name == "imageio":
            raise importlib.metadata.PackageNotFoundError(name)
        return version(name)

    monkeypatch.setattr("importlib.metadata.version", without_imageio)
    assert machine()["imageio"] == "not installed" and machine()["numpy"] == np.__version__


def test_painter_that_needs_vulkan_is_refused_without_it(refused, tmp_path, monkeypatch):
    monkeypatch.setattr("rsmpm_ti.paint.ggui.probe", lambda: (False, "Vulkan finds no device"))
    message = refused("--painter", "ggui", "--out", str(tmp_path))
    assert "output.painter = 'ggui' is refused: it must be raster" in message and "Vulkan finds no device" in message


def test_scene_that_this_machine_cannot_hold_is_refused(refused, tmp_path, monkeypatch):
    monkeypatch.setattr(memory, "free_memory", lambda: 1_000_000)
    message = refused("--out", str(tmp_path / "out"))
    assert "domain.dx" in message and "GB" in message and not (tmp_path / "out").exists()


def test_grid_that_this_machine_cannot_hold_is_refused(refused, tmp_path, monkeypatch):
    """Nodes count, and the sparse grid has few of them."""
    monkeypatch.setattr(memory, "free_memory", lambda: 16e9)
    wide = ["--set", "domain.lower=-100,0", "--set", "domain.upper=100,2", "--out", str(tmp_path / "out")]
    message = refused(*wide)
    assert " nodes, about " in message
    assert "take domain.grid = sparse" in message and not (tmp_path / "out").exists()


def test_single_precision_is_refused_where_it_loses_places(refused, tmp_path):
    far = ["--set", "domain.lower=-400,0", "--set", "domain.grid=sparse", "--precision", "f32", "--out", str(tmp_path)]
    assert "precision = 'f32' is refused: it must be 'f64'" in refused(*far)


NOWHERE = {"HOME": "/dev/null", "MPLCONFIGDIR": "/dev/null/m", "TI_OFFLINE_CACHE_FILE_PATH": "/dev/null/t"}
WITHOUT_CACHES = """
import io, numpy as np
from rsmpm_ti.backend.start import start_taichi
start_taichi("f64", "cpu", 1)
import taichi as ti
field = ti.field(float, 4)
field.fill(1.0)
import matplotlib
matplotlib.use("agg")
from matplotlib import pyplot
figure = pyplot.figure()
figure.suptitle("letters")
figure.savefig(io.BytesIO())
print("ran", field.to_numpy().sum())
"""


@pytest.mark.parametrize("home", [True, False], ids=["home that cannot be written", "no home"])
def test_caches_that_cannot_be_written_do_not_end_the_process(tmp_path, home):
    """Taichi alone ends it by a signal: on leaving with the first, on being imported with the second."""
    kept = {name: value for name, value in os.environ.items() if name not in NOWHERE}
    cache = {kernel_cache.VARIABLE: str(tmp_path / "kernels")}  # not the one that others use at the same time
    environment = kept | {"TMPDIR": str(tmp_path), "PYTHONPATH": str(ROOT)} | (NOWHERE if home else cache)
    command = [sys.executable, "-c", WITHOUT_CACHES]
    done = subprocess.run(command, env=environment, capture_output=True, text=True, timeout=120)
    assert (done.returncode, done.stdout) == (0, "ran 4.0\n"), done.stderr
    assert "Traceback" not in done.stderr


def test_kernels_are_kept_where_they_always_are_if_that_can_be_written(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", str(tmp_path))
    monkeypatch.delenv(kernel_cache.VARIABLE, raising=False)
    kernel_cache.ensure_kernel_cache()
    assert kernel_cache.VARIABLE not in os.environ


def test_kernels_of_another_user_are_not_trusted(tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setenv(kernel_cache.VARIABLE, "/dev/null/t")
    (tmp_path / "elsewhere").mkdir()
    (tmp_path / f"rsmpm_ti_kernels_{os.getuid()}").symlink_to(tmp_path / "elsewhere")
    kernel_cache.ensure_kernel_cache()
    chosen = Path(os.environ[kernel_cache.VARIABLE])
    assert chosen.parent == tmp_path and not chosen.is_symlink()


class Harmful:
    """Unpickled, it makes a file."""

    def __init__(self, path: Path):
        self.path = path

    def __reduce__(self):
        return (open, (str(self.path), "w"))


def test_checkpoint_that_means_harm_is_refused_and_not_executed(tmp_path):
    scene, mark = load_scene("cube", quick=True), tmp_path / "executed"
    harmful = np.array([Harmful(mark)], dtype=object)
    buffer = io.BytesIO()
    np.save(buffer, harmful, allow_pickle=True)
    with zipfile.ZipFile(tmp_path / CHECKPOINTS[0], "w") as file:
        file.writestr("text.npy", buffer.getvalue())
    with pytest.raises(SceneError, match="is damaged"):
        checkpoint.read(tmp_path, scene, scene.particles(), Settings())
    assert not mark.exists()
    np.load(tmp_path / CHECKPOINTS[0], allow_pickle=True)["text"]
    assert mark.exists()  # the file does what it is made for where pickles are allowed


@pytest.mark.parametrize(
    "harm",
    [
        {"type": "os.system", "command": "touch executed"},
        {"__reduce__": ["os.system", ["touch executed"]], "type": "Box"},
        {"type": "__import__('os').system('touch executed')"},
        "__import__('os').system('touch executed')",
    ],
)
def test_recorded_scene_that_means_harm_is_refused_and_not_executed(tmp_path, monkeypatch, harm):
    monkeypatch.chdir(tmp_path)
    plain = to_plain(load_scene("cube", quick=True))
    plain["rock"]["criterion"] = harm
    (tmp_path / "scene.json").write_text(json.dumps(plain))
    with pytest.raises(SceneError, match="criterion"):
        read_scene(tmp_path / "scene.json")
    plain = to_plain(load_scene("cube", quick=True)) | {"title": "$(touch executed) `touch executed` {0.__class__}"}
    (tmp_path / "scene.json").write_text(json.dumps(plain))
    assert read_scene(tmp_path / "scene.json").title == plain["title"]
    assert not (tmp_path / "executed").exists()


@pytest.mark.validation
def test_run_without_home_caches_and_encoder_writes_everything_else(tmp_path):
    command = [sys.executable, "-m", "rsmpm_ti.scene", "cube", "--out", str(tmp_path / "out"), "--frames", "1"]
    small = ["--set", "dx=0.002", "--set", "flaw_width=0.006", "--set", "strain_end=2e-5", "--set", "output.vtu=1"]
    environment = os.environ | NOWHERE | {"IMAGEIO_FFMPEG_EXE": "/dev/null/ffmpeg", "PYTHONPATH": str(ROOT)}
    done = subprocess.run(command + small, env=environment, capture_output=True, text=True, timeout=300, cwd=ROOT)
    assert done.returncode == 0 and "Traceback" not in done.stderr, done.stderr
    assert "warning: no movie is written" in done.stdout
    written = {path.name for path in (tmp_path / "out").rglob("*")}
    assert {"stress_0000.png", "history.csv", "summary.json", "summary.png", "checkpoint.npz"} <= written
