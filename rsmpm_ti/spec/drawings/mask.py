"""A region of the pixels of an image: a thin section, a slice of a tomogram, a drawing in black and white."""

import io
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval

from rsmpm_ti.checks import Coordinate, checked
from rsmpm_ti.errors import SceneError, reason, refuse
from rsmpm_ti.spec.drawings.drawn_file import FileName, read

MAX_BYTES, MAX_PIXELS = 256 * 2**20, 64_000_000
"""Of a file, and of what it unfolds to: 8000 x 8000 pixels."""

FORMATS = ("PNG", "TIFF", "JPEG", "BMP", "PPM")
"""That are pictures and nothing else: Pillow would hand some others to another program."""

MAX_GREY = 65535
OPAQUE = 128
"""Of 255, from which on a pixel is there."""

Grey = Annotated[float, Interval(ge=0.0, le=MAX_GREY)]


@checked("mask")
@dataclass(frozen=True, kw_only=True)
class Mask:
    """The pixels of an image whose grey is in `greys`, 2D; each is a square of `mm_per_pixel`.

    image: a PNG, TIFF, JPEG, BMP or PGM file; its top row is up. greys: lowest and highest level that is rock, both
    included, (k, k) for one level; 0 is black and 255 white, up to 65535 in images of 16 bits. Colours become the grey
    of their luma, 0.299 R + 0.587 G + 0.114 B; a pixel that is more transparent than not is no rock. origin: the lower
    left corner of the image [m]; `bounds` are those of the rock in it. sha256: of the file, filled in when it is read
    (see `drawn_file.py`). Raises SceneError where the file is none of these, or holds no such pixel.

    When it fails: single pixels of noise become single particles; smooth and clean the image first.
    """

    image: FileName
    mm_per_pixel: Annotated[float, Interval(ge=1e-6, le=1e6)]
    greys: tuple[Grey, Grey]
    origin: tuple[Coordinate, Coordinate] = (0.0, 0.0)
    sha256: str | None = None

    def __post_init__(self):
        file = read("mask.image", self.image, self.sha256, MAX_BYTES)
        level, there = _pixels(self.image, file.data)
        solid = (level >= self.greys[0]) & (level <= self.greys[1]) & there
        if not solid.any():
            held = f"greys of the image, {level.min():g} to {level.max():g}, lowest first"
            raise refuse("mask.greys", self.greys, held, "no pixel is of these")
        self.__dict__.update({"sha256": file.sha256, "drawn": solid[::-1]})

    @property
    def _solid(self) -> np.ndarray:
        """Whether a pixel is rock [rows, columns], the lowest row first."""
        return self.__dict__["drawn"]

    @property
    def _pixel(self) -> float:
        return 1e-3 * self.mm_per_pixel

    def contains(self, x: np.ndarray) -> np.ndarray:
        """x [n, 2] -> bool [n]."""
        place = np.floor((x - np.array(self.origin)) / self._pixel)
        within = np.all((place >= 0) & (place < self._solid.shape[::-1]), axis=1)
        column, row = place[within].astype(int).T
        inside = np.zeros(len(x), dtype=bool)
        inside[within] = self._solid[row, column]
        return inside

    def bounds(self) -> tuple[np.ndarray, np.ndarray]:
        edges = [np.flatnonzero(self._solid.any(axis=axis))[[0, -1]] + (0, 1) for axis in (0, 1)]
        low, high = np.array(self.origin) + self._pixel * np.array(edges).T
        return low, high

    @property
    def area(self) -> float:
        """[m^2]."""
        return float(np.count_nonzero(self._solid)) * self._pixel**2

    @property
    def hull(self) -> np.ndarray:
        """Corners of the first and last pixel of each row [m], [n, 2]: their convex hull is that of the region."""
        row = np.flatnonzero(self._solid.any(axis=1))
        first = self._solid[row].argmax(axis=1)
        last = self._solid.shape[1] - self._solid[row][:, ::-1].argmax(axis=1)
        corners = [np.stack([x, y], axis=1) for x in (first, last) for y in (row, row + 1)]
        return np.array(self.origin) + self._pixel * np.concatenate(corners)


def _pixels(name: str, data: bytes) -> tuple[np.ndarray, np.ndarray]:
    """Grey and whether it is opaque of each pixel, [rows, columns], the top row first."""
    from PIL import Image, ImageOps, UnidentifiedImageError  # a twentieth of a second, for scenes with an image

    try:
        with Image.open(io.BytesIO(data), formats=FORMATS) as opened:
            if opened.width * opened.height > MAX_PIXELS:
                size = f"an image of at most {MAX_PIXELS:.3g} pixels"
                raise refuse("mask.image", name, size, f"it has {opened.width} x {opened.height}: scale it down")
            if getattr(opened, "n_frames", 1) > 1:
                raise refuse("mask.image", name, "one image", f"it holds {opened.n_frames}: save the one you mean")
            image = ImageOps.exif_transpose(opened)
            there = np.array(True)
            if image.has_transparency_data:
                there = np.asarray(image.convert("RGBA").getchannel("A")) >= OPAQUE
            keeps = image.mode.startswith("I") or image.mode == "F"  # levels of more than 8 bits
            return np.asarray(image if keeps else image.convert("L")), there
    except SceneError:
        raise
    except Exception as error:  # a damaged file makes Pillow raise whatever it meets
        allowed = f"an image, one of {', '.join(FORMATS)}"
        why = "" if isinstance(error, UnidentifiedImageError) else reason(error)
        raise refuse("mask.image", name, allowed, why) from None
