"""Movies hold every frame in its true colours, and a machine without an encoder is told what to install."""

import sys

import numpy as np
import pytest
from PIL import Image

from rsmpm_ti.paint.encoder import movie_size
from rsmpm_ti.paint.movie import Movie, gif
from rsmpm_ti.paint.palette import crack_palette
from rsmpm_ti.paint.png import write_png


@pytest.mark.parametrize("shape, size", [((720, 640), (1280, 720)), ((1440, 1280), (1920, 1080)), ((51, 33), (66, 52))])
def test_movie_decodes_with_all_frames_even_size_and_true_colours(tmp_path, shape, size):
    imageio = pytest.importorskip("imageio.v2")
    pytest.importorskip("imageio_ffmpeg")
    movie = Movie(tmp_path / "cube.mp4", fps=10)
    cracks, stress = (np.full((*shape, 3), colour, dtype=np.uint8) for colour in ((213, 94, 0), (0, 114, 178)))
    for _ in range(7):
        movie.add(stress, cracks)
    assert not movie.path.exists(), "half a movie does not carry the movie's name"
    assert movie.close() == tmp_path / "cube.mp4"
    assert [p.name for p in tmp_path.iterdir()] == ["cube.mp4"]
    with imageio.get_reader(movie.path) as reader:
        meta = reader.get_meta_data()
        frames = [np.asarray(frame) for frame in reader]  # list() would ask for its length, which is infinite
    assert len(frames) == 7 and meta["size"] == size and meta["fps"] == 10
    assert meta["codec"] == "h264" and meta["pix_fmt"].startswith("yuv420p") and "bt709" in meta["pix_fmt"]
    row, column = size[1] // 2, size[0] // 4
    for position, colour in ((column, (213, 94, 0)), (3 * column, (0, 114, 178))):
        assert np.abs(frames[3][row, position].astype(int) - colour).max() <= 4, "cracks left, stress right"


def test_movie_without_frames_writes_nothing_and_without_encoder_says_so(tmp_path, monkeypatch):
    pytest.importorskip("imageio_ffmpeg")
    assert Movie(tmp_path / "empty.mp4").close() is None
    assert list(tmp_path.iterdir()) == []
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(RuntimeError, match="pip install imageio-ffmpeg"):
        Movie(tmp_path / "none.mp4")


LAST = "for last; do :; done"
HANDS = {
    "ends at once": ("exit 1", "ended with status 1"),
    "says why": ("cat > /dev/null; echo no space >&2; exit 1", "status 1: no space"),
    "takes nothing": ("sleep 1000", "did not answer for 0.5 s"),
    "never finishes": ("cat > /dev/null; sleep 1000", "did not answer for 0.5 s"),
    "makes nothing": ("cat > /dev/null; exit 0", "is no movie"),
    "leaves a folder": (
        f'{LAST}; cat > /dev/null; rm "$last"; mkdir "$last"',
        "cube.part.mp4, which is no file: remove it",
    ),
    "fails and leaves a folder": (f'{LAST}; rm "$last"; mkdir "$last"; exit 1', "ended with status 1"),
    "leaves a link": (f'{LAST}; cat > /dev/null; ln -sf "$0" "$last"', "cube.part.mp4, which is no file: remove it"),
}


@pytest.mark.parametrize("kind", HANDS)
def test_encoder_that_fails_is_named_in_one_line_and_leaves_nothing(tmp_path, monkeypatch, kind):
    pytest.importorskip("imageio_ffmpeg")
    program = tmp_path / "ffmpeg"
    program.write_text(f"#!/bin/sh\n{HANDS[kind][0]}\n")
    program.chmod(0o755)
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(program))
    monkeypatch.setattr("rsmpm_ti.paint.encoder.PATIENCE", 0.5)
    (tmp_path / "out").mkdir()
    movie = Movie(tmp_path / "out" / "cube.mp4")
    frame = np.zeros((400, 400, 3), dtype=np.uint8)  # larger than a pipe holds
    with pytest.raises(RuntimeError, match=HANDS[kind][1]) as told:
        for _ in range(2):
            movie.add(frame, frame)
        movie.close()
    movie.discard()
    assert "\n" not in str(told.value) and not list((tmp_path / "out").iterdir())


FULL = f'{LAST}; cat > /dev/null; rm "$last"; mkdir "$last"; touch "$last/yours"'
NAMED = f"{LAST}; cat > /dev/null; printf '....ftyp' > \"$last\"; mkdir out/cube.mp4"


@pytest.mark.parametrize("hand, left", [(FULL, ".cube.part.mp4"), (NAMED, "cube.mp4")])
def test_folder_in_place_of_the_movie_is_named_and_left_alone(tmp_path, monkeypatch, hand, left):
    pytest.importorskip("imageio_ffmpeg")
    (tmp_path / "ffmpeg").write_text(f"#!/bin/sh\n{hand}\n")
    (tmp_path / "ffmpeg").chmod(0o755)
    (tmp_path / "out").mkdir()
    monkeypatch.setenv("IMAGEIO_FFMPEG_EXE", str(tmp_path / "ffmpeg"))
    monkeypatch.chdir(tmp_path)
    movie = Movie(tmp_path / "out" / "cube.mp4")
    movie.add(*np.zeros((2, 40, 40, 3), dtype=np.uint8))
    with pytest.raises(RuntimeError, match=f"{left}.*: remove it$"):
        movie.close()
    movie.discard()
    assert [path.name for path in (tmp_path / "out").iterdir()] == [left]


def test_movie_fits_full_hd_and_is_never_enlarged():
    assert movie_size(2536, 1440) == (1902, 1080)
    assert movie_size(3128, 1150) == (1920, 706)
    assert movie_size(640, 360) == (640, 360)


def test_gif_has_all_frames_and_the_colours_of_cracks(tmp_path):
    paths = []
    for k in range(4):
        image = np.full((100, 200, 3), 255, dtype=np.uint8)
        image[:, : 50 * (k + 1)] = crack_palette().tension
        paths.append(write_png(tmp_path / f"{k}.png", image))
    with Image.open(gif(tmp_path / "cube.gif", paths, width=100)) as picture:
        assert (picture.n_frames, picture.size) == (4, (100, 50))
        picture.seek(2)
        pixel = picture.convert("RGB").getpixel((60, 25))
    assert np.abs(np.subtract(pixel, crack_palette().tension)).max() <= 4
