"""The painter that draws by Taichi's GGUI, off-screen, where Vulkan is found: a GPU's, or Mesa's lavapipe on a CPU.

Whether it works is asked of a child process (`probe`), because some of the ways in which it fails end the process.
"""

import functools
import json
import os
import signal
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import taichi as ti

from rsmpm_ti.paint.palette import Palette, View, squares_in_view
from rsmpm_ti.process import python_command

PROBE = """
import json, taichi as ti
assert ti._lib.core.with_vulkan(), "Vulkan finds no device"
ti.init(arch=ti.cpu, offline_cache=False)
window = ti.ui.Window("probe", (16, 16), show_window=False)
window.get_canvas().set_background_color((1.0, 0.0, 0.0))
red = [float(c) for c in window.get_image_buffer_as_numpy()[8, 8, :3]]
window.destroy()
print("PROBE", json.dumps(red))
"""


@functools.cache
def probe(timeout: float = 60.0) -> tuple[bool, str]:
    """Whether GGUI can draw here, and the reason in one line. Takes about 2 s, once per process; never raises."""
    try:
        with tempfile.TemporaryDirectory() as folder:  # a closing window writes imgui.ini where it runs
            # it follows no variables of Taichi's either, and tells its makers nothing
            quiet = {name: value for name, value in os.environ.items() if not name.startswith("TI_")}
            quiet |= {"TI_SKIP_VERSION_CHECK": "ON"}
            child = subprocess.run(
                python_command(PROBE), env=quiet, capture_output=True, text=True, timeout=timeout, cwd=folder
            )
    except subprocess.TimeoutExpired:
        return False, f"GGUI's probe did not answer within {timeout:g} s"
    except OSError as error:
        return False, f"GGUI's probe could not be started: {error}"
    return verdict(child.returncode, child.stdout, child.stderr)


def verdict(status: int, output: str, errors: str) -> tuple[bool, str]:
    """Reads the probe's exit status and what it printed."""
    if status < 0:
        return False, f"GGUI's probe was ended by {signal.Signals(-status).name}, as by a broken Vulkan driver"
    if status:
        lines = [line.strip() for line in errors.splitlines() if line.strip()]
        return False, f"GGUI cannot draw here: {lines[-1] if lines else f'its probe ended with status {status}'}"
    answers = [json.loads(line.split(" ", 1)[1]) for line in output.splitlines() if line.startswith("PROBE ")]
    if not answers or np.abs(np.subtract(answers[0], (1.0, 0.0, 0.0))).max() > 0.01:
        return False, f"GGUI painted {answers[0] if answers else 'nothing'} where red was asked for"
    return True, "GGUI draws off-screen here"


class Ggui:
    """Paints particles as two triangles each, without antialiasing; same interface as `Raster`.

    Call `probe` first, and `close` before the next `ti.init`: re-initialising under a live window ends the process.
    """

    def __init__(self, view: View, palette: Palette):
        self.view = view
        self.palette = palette
        self.skipped = 0  # particles of the last image that had no finite position, size or value
        self._room = 0
        self._litter = None if Path("imgui.ini").exists() else Path("imgui.ini").absolute()
        self._window = ti.ui.Window("rsmpm_ti", (view.width, view.height), show_window=False, vsync=False)

    def image(self, x: np.ndarray, half: np.ndarray, mode: np.ndarray, value: np.ndarray | None = None) -> np.ndarray:
        """The panel, uint8 [height, width, 3], first row on top; arguments as of `Raster.image`."""
        if self._window is None:
            raise RuntimeError("this Ggui painter is closed")
        squares, self.skipped = squares_in_view(self.view, self.palette.limit, x, half, mode, value)
        if len(squares.mode) > self._room:
            self._allocate(len(squares.mode))
        self._load(squares)

        canvas = self._window.get_canvas()
        canvas.set_background_color(tuple(c / 255.0 for c in self.palette.void))
        if self._room:
            canvas.triangles(self._corners, indices=self._indices, per_vertex_color=self._colours)
        # Reading draws what is queued and empties the queue: one read per image. The array is [x, y upwards, RGBA].
        pixels = self._window.get_image_buffer_as_numpy()
        rows = pixels[:, ::-1, :3].transpose(1, 0, 2)
        return np.rint(np.clip(rows, 0.0, 1.0) * 255.0).astype(np.uint8)

    def close(self) -> None:
        """Destroys the window; `image` refuses from then on, because GGUI itself would end the process."""
        if self._window is not None:
            self._window.destroy()
            self._window = None
            if self._litter is not None:  # written by the window's text layer, which is not used
                self._litter.unlink(missing_ok=True)

    def _allocate(self, count: int) -> None:
        # Spare room, because the number in view changes from frame to frame and fields cannot grow.
        self._room = count + count // 4 + 16
        self._corners = ti.Vector.field(2, ti.f32, shape=4 * self._room)
        self._colours = ti.Vector.field(3, ti.f32, shape=4 * self._room)
        self._indices = ti.field(ti.i32, shape=6 * self._room)
        first = 4 * np.arange(self._room, dtype=np.int32)[:, None]
        self._indices.from_numpy((first + np.array((0, 1, 2, 2, 1, 3), dtype=np.int32)).ravel())

    def _load(self, squares) -> None:
        order = np.argsort(squares.mode, kind="stable")  # later triangles lie on top: failed ones last
        corners = np.full((self._room, 4, 2), -1.0, dtype=np.float32)  # unused ones have no area, off the canvas
        colours = np.zeros((self._room, 4, 3), dtype=np.float32)
        for c, (right, down) in enumerate(((-1, -1), (1, -1), (-1, 1), (1, 1))):
            corners[: len(order), c, 0] = (squares.column + right * squares.half)[order] / self.view.width
            corners[: len(order), c, 1] = 1.0 - (squares.row + down * squares.half)[order] / self.view.height
        colours[: len(order)] = self.palette.colours(squares.value, squares.mode)[order, None, :] / 255.0
        if self._room:
            self._corners.from_numpy(corners.reshape(-1, 2))
            self._colours.from_numpy(colours.reshape(-1, 3))
