"""Movies of frames: H.264 by ffmpeg, or GIF through Pillow alone."""

import contextlib
import os
from pathlib import Path

import numpy as np

from rsmpm_ti.paint.encoder import Encoder, find_encoder
from rsmpm_ti.records.files import complete


class Movie:
    """An mp4 with crack growth on the left and stress on the right, encoded as frames arrive.

    The file appears under its name only on `close`, complete; nothing is written where no frame was added.
    Raises RuntimeError, in one line, where the encoder is not installed, and later where it fails or does not answer:
    a run can go on without a movie.
    """

    def __init__(self, path: str | os.PathLike, fps: float = 20):
        self.path, self.fps = Path(path), fps
        self._program = find_encoder()
        self._file = contextlib.ExitStack()  # holds the unfinished file
        self._part: Path | None = None
        self._encoder: Encoder | None = None
        self._shape: tuple[int, ...] = ()

    def add(self, stress_image: np.ndarray, cracks_image: np.ndarray) -> None:
        """Appends one frame from two pictures, uint8 [h, w, 3]; sizes must stay those of the first."""
        frame = side_by_side(cracks_image, stress_image)
        if self._encoder is None:
            self._shape, self._part = frame.shape, self._file.enter_context(complete(self.path))
            self._encoder = Encoder(self._program, self._part, self._shape, self.fps)
        if frame.shape != self._shape:
            raise ValueError(f"a movie of {self._shape} frames cannot take one of {frame.shape}")
        self._encoder.add(frame)

    def close(self) -> Path | None:
        """Finishes the file and returns its path; None where there was no frame."""
        if self._encoder is None:
            return None
        self._encoder.close()
        self._encoder = None
        try:
            self._file.close()
        except IsADirectoryError:
            raise RuntimeError(f"{self.path} has become a folder: remove it") from None
        return self.path

    def discard(self) -> None:
        """Gives the movie up, where it cannot be finished, and removes what there is of it; never raises.

        A folder that the encoder has left in place of its file goes only if it is empty.
        """
        if self._encoder is not None:
            self._encoder.kill()
        self._encoder = None
        if self._part is not None:
            with contextlib.suppress(OSError):
                self._part.unlink(missing_ok=True)
            with contextlib.suppress(OSError):
                self._part.rmdir()
            with contextlib.suppress(OSError):
                self._file.close()


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
