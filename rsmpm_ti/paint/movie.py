"""Movies of frames: H.264 through imageio-ffmpeg, or GIF through Pillow alone."""

import contextlib
import os
import shutil
from pathlib import Path

import numpy as np

from rsmpm_ti.records.files import complete

MAX_FRAME = (1920, 1080)
"""Width and height [px] that a movie fits in."""

ENCODING = ("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709")
QUALITY = ("-crf", "18", "-preset", "veryfast", "-movflags", "+faststart")


class Movie:
    """An mp4 with crack growth on the left and stress on the right, encoded as frames arrive.

    The file appears under its name only on `close`, complete; nothing is written where no frame was added.
    Raises RuntimeError, in one line, where the encoder is not installed: a run can go on without a movie.
    """

    def __init__(self, path: str | os.PathLike, fps: float = 20):
        try:
            import imageio_ffmpeg
            from imageio import v2 as imageio

            encoder = imageio_ffmpeg.get_ffmpeg_exe()
            if shutil.which(encoder) is None:  # what IMAGEIO_FFMPEG_EXE names is not looked at by imageio_ffmpeg
                raise RuntimeError(f"{encoder} is no program")
        except (ImportError, RuntimeError) as error:
            raise RuntimeError(f"no movie is written, pip install imageio imageio-ffmpeg ({error})") from error
        self.path = Path(path)
        self.fps = fps
        self._open = imageio.get_writer
        self._file = contextlib.ExitStack()  # holds the unfinished file
        self._part = None
        self._writer = None
        self._shape = None

    def add(self, stress_image: np.ndarray, cracks_image: np.ndarray) -> None:
        """Appends one frame from two pictures, uint8 [h, w, 3]; sizes must stay those of the first."""
        frame = side_by_side(cracks_image, stress_image)
        if self._writer is None:
            self._shape = frame.shape
            self._writer = self._start()
        if frame.shape != self._shape:
            raise ValueError(f"a movie of {self._shape} frames cannot take one of {frame.shape}")
        self._writer.append_data(frame)

    def close(self) -> Path | None:
        """Finishes the file and returns its path; None where there was no frame."""
        if self._writer is None:
            return None
        self._writer.close()
        self._writer = None
        self._file.close()
        return self.path

    def discard(self) -> None:
        """Gives the movie up, where it cannot be finished, and removes what there is of it; never raises."""
        with contextlib.suppress(Exception):  # an encoder that has failed fails again when it is closed
            if self._writer is not None:
                self._writer.close()
        self._writer = None
        with contextlib.suppress(OSError):
            if self._part is not None:
                self._part.unlink(missing_ok=True)
                self._file.close()

    def _start(self):
        self._part = self._file.enter_context(complete(self.path))
        width, height = movie_size(self._shape[1], self._shape[0])
        # Players guess the colour matrix of an untagged stream, so it is both converted to and tagged as bt709.
        # bicubic: a frame takes 44 ms in place of 74 with Lanczos; lines and numbers stay sharp at 3/4 of the size
        scale = f"scale={width}:{height}:flags=bicubic:out_color_matrix=bt709:out_range=tv"
        return self._open(
            self._part,
            format="FFMPEG",
            mode="I",
            fps=self.fps,
            codec="libx264",
            quality=None,
            pixelformat="yuv420p",
            macro_block_size=2,
            ffmpeg_params=["-vf", scale, *ENCODING, *QUALITY],
        )


def movie_size(width: int, height: int) -> tuple[int, int]:
    """Width and height of the movie of such frames: within MAX_FRAME, never enlarged, even numbers for H.264."""
    scale = min(1.0, MAX_FRAME[0] / width, MAX_FRAME[1] / height)
    return 2 * round(width * scale / 2), 2 * round(height * scale / 2)


def side_by_side(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    """Two pictures in one of even size, on white, uint8 [h, w, 3]."""
    height, width = max(len(left), len(right)), left.shape[1] + right.shape[1]
    frame = np.full((height + height % 2, width + width % 2, 3), 255, dtype=np.uint8)
    frame[: len(left), : left.shape[1]] = left
    frame[: len(right), left.shape[1] : width] = right
    return frame


def gif(path: str | os.PathLike, frames: list[str | os.PathLike], fps: float = 10, width: int = 480) -> Path:
    """A small looping GIF from picture files, scaled to `width` pixels; returns its path.

    All frames share one palette, made from the first, middle and last: a palette per frame flickers, and dithering
    looks like particles that failed.
    """
    from PIL import Image

    def load(name) -> Image.Image:
        with Image.open(name) as picture:
            rgb = picture.convert("RGB")
        return rgb.resize((width, round(rgb.height * width / rgb.width)), Image.Resampling.LANCZOS)

    if not frames:
        raise ValueError("a GIF needs at least one frame")
    samples = [np.array(load(frames[k])) for k in (0, len(frames) // 2, -1)]
    palette = Image.fromarray(np.vstack(samples)).quantize(255)
    pictures = [load(name).quantize(palette=palette, dither=Image.Dither.NONE) for name in frames]
    path = Path(path)
    with complete(path) as part:
        pictures[0].save(
            part, save_all=True, append_images=pictures[1:], duration=round(1000 / fps), loop=0, optimize=False
        )
    return path
