"""The program that makes a movie of pictures: ffmpeg, which imageio-ffmpeg brings, in a process of its own.

It is started here and not by imageio, which neither says whether it ended well nor can end it where it hangs.
"""

import contextlib
import os
import select
import shutil
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import reason

MAX_FRAME = (1920, 1080)
"""Width and height [px] that a movie fits in."""

PATIENCE = 30.0
"""Seconds for which the encoder is waited for: it takes a picture in a tenth of one, and finishes a file in a few."""

# Players guess the colour matrix of an untagged stream, so it is both converted to and tagged as bt709.
# bicubic: a frame takes 44 ms in place of 74 with Lanczos; lines and numbers stay sharp at 3/4 of the size
SCALE = "scale={}:{}:flags=bicubic:out_color_matrix=bt709:out_range=tv"
COLOURS = ("-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709")
CODEC = ("-c:v", "libx264", "-pix_fmt", "yuv420p", "-crf", "18", "-preset", "veryfast", "-movflags", "+faststart")


def find_encoder() -> str:
    """Path of the program. Raises RuntimeError, in one line, where there is none."""
    try:
        import imageio_ffmpeg

        program = imageio_ffmpeg.get_ffmpeg_exe()
        if shutil.which(program) is None:  # what IMAGEIO_FFMPEG_EXE names is not looked at by imageio_ffmpeg
            raise RuntimeError(f"{program} is no program")
    except (ImportError, RuntimeError) as error:
        raise RuntimeError(f"no encoder, pip install imageio-ffmpeg ({error})") from error
    return program


class Encoder:
    """Encodes pictures of one size as they come, uint8 [h, w, 3], into an mp4 (H.264).

    Raises RuntimeError, in one line, where it cannot be started, ends, or does not answer for PATIENCE seconds.
    """

    def __init__(self, program: str, path: Path, shape: tuple[int, ...], fps: float):
        height, width = shape[:2]
        source = ("-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{width}x{height}", "-r", f"{fps:g}", "-i", "-")
        scale = SCALE.format(*movie_size(width, height))
        # -nostdin: what comes by the pipe is pictures, not keys
        command = [program, "-nostdin", "-y", "-v", "error", *source, "-vf", scale, *COLOURS, *CODEC, str(path)]
        self._path, self._words = path, tempfile.TemporaryFile()
        try:
            self._process = subprocess.Popen(
                command, bufsize=0, stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._words
            )
        except OSError as error:
            raise RuntimeError(f"its encoder cannot be started: {error}") from None
        assert self._process.stdin is not None
        self._pipe = self._process.stdin
        if os.name == "posix":
            os.set_blocking(self._pipe.fileno(), False)  # so that it can be waited for with a limit

    def add(self, picture: np.ndarray) -> None:
        rest = memoryview(np.ascontiguousarray(picture)).cast("B")
        with self._failing():
            while rest:
                if os.name == "posix" and not select.select([], [self._pipe], [], PATIENCE)[1]:
                    raise TimeoutError
                rest = rest[self._pipe.write(rest) or 0 :]

    def close(self) -> None:
        """Finish the file, and wait for it."""
        with self._failing():
            self._pipe.close()
            if self._process.wait(PATIENCE) != 0:
                raise OSError
            if self._path.is_symlink() or not self._path.is_file():
                raise RuntimeError(f"its encoder left {self._path}, which is no file: remove it")
            with open(self._path, "rb") as file:
                if file.read(8)[4:] != b"ftyp":  # with which an mp4 begins (ISO/IEC 14496-12, 4.3)
                    raise OSError(f"{self._path.name} is no movie")

    def kill(self) -> None:
        """End it at once. Never raises."""
        self._process.kill()
        self._process.wait()
        with contextlib.suppress(OSError):
            self._pipe.close()

    @contextlib.contextmanager
    def _failing(self):
        """Whatever fails within ends the encoder, and is told in its own words where it had any."""
        try:
            yield
        except (TimeoutError, subprocess.TimeoutExpired):
            self.kill()
            raise RuntimeError(f"its encoder did not answer for {PATIENCE:g} s") from None
        except (OSError, ValueError) as error:  # ValueError: the pipe is closed
            self.kill()
            self._words.seek(0)
            said = [line.strip() for line in self._words.read().decode(errors="replace").splitlines() if line.strip()]
            why = said[-1] if said else reason(error)
            raise RuntimeError(f"its encoder ended with status {self._process.returncode}: {why}") from None


def movie_size(width: int, height: int) -> tuple[int, int]:
    """Width and height of the movie of such pictures: within MAX_FRAME, never enlarged, even numbers for H.264."""
    scale = min(1.0, MAX_FRAME[0] / width, MAX_FRAME[1] / height)
    return 2 * round(width * scale / 2), 2 * round(height * scale / 2)
