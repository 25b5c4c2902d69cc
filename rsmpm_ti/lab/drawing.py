"""A specimen as it is drawn: by its outline, by an image, or by a trace map of flaws in a specimen of the standard."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.drawings.mask import Mask
from rsmpm_ti.spec.drawings.mesh import Mesh
from rsmpm_ti.spec.regions import Segments

TABLES = (".csv", ".txt")
IMAGES = (".png", ".tif", ".tiff", ".jpg", ".jpeg", ".bmp", ".pgm")
OUTLINES = (".stl", ".msh", ".vtu", ".obj")

DARK = (0.0, 127.0)
"""Greys of an image that are rock: the darker half."""

CELLS_WIDE = 3.0
"""Of a flaw whose row has no width: what separates its faces."""


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """file: .csv of flaws x1, y1, x2, y2 and perhaps a width, from the specimen's lower left corner; an image, whose
    darker half is rock; or a flat mesh. scale: metres per unit of the file, or per pixel. Raises SceneError."""

    file: str
    scale: float = 1e-3

    def __post_init__(self):
        if self.kind not in (*TABLES, *IMAGES, *OUTLINES):
            raise refuse("--drawing", self.file, f"a file {', '.join((*TABLES, *IMAGES, *OUTLINES))}")

    @property
    def kind(self) -> str:
        return Path(self.file).suffix.lower()

    @property
    def is_traces(self) -> bool:
        """Whether it draws flaws, and the specimen is that of the standard."""
        return self.kind in TABLES

    def flaws(self, dx: float) -> tuple[Segments, ...]:
        """What is cut out, for cells of dx [m]."""
        try:
            return (Segments.from_csv(self.file, width=CELLS_WIDE * dx, scale=self.scale, rounded=True),)
        except SceneError as error:
            if "slit." not in str(error):
                raise
            raise SceneError(f"{error}; one unit of the file is {1e3 * self.scale:g} mm: give its --scale") from None

    def outline(self) -> tuple[Mask | Mesh, float, float]:
        """The specimen with its lower left corner at the origin, its width and its height [m]."""

        file = str(Path(self.file).resolve())  # so that the record of the run finds it from any folder

        def at(x: float, y: float):
            if self.kind in IMAGES:
                return Mask(image=file, mm_per_pixel=1e3 * self.scale, greys=DARK, origin=(x, y))
            return Mesh(file=file, scale=self.scale, origin=None if x == y == 0.0 else (x, y))

        low, high = (np.asarray(bound) for bound in at(0.0, 0.0).bounds())
        if len(low) != 2:
            raise refuse("--drawing", self.file, "flat: a mesh in the x-y plane")
        size = high - low
        return at(*(-low).tolist()), float(size[0]), float(size[1])


def check_connected(file: str, scene) -> None:
    """Refuse a drawing of which no piece reaches from platen to platen."""
    from scipy.ndimage import label

    x, dx = np.concatenate([body.x for body in scene.particles()]), scene.domain.dx
    cell = np.floor((x - x.min(axis=0)) / dx).astype(int)
    rock = np.zeros(cell.max(axis=0) + 1, dtype=bool)
    rock[tuple(cell.T)] = True
    pieces, _ = label(rock, structure=np.ones((3, 3)))
    if not set(pieces[:, 0]) & set(pieces[:, -1]) - {0}:
        raise refuse("--drawing", file, "one piece of rock from the lower platen to the upper")


def cells_of(width: float, height: float, dx: float) -> tuple[float, float]:
    """(cell that divides the height, room on each side that fills cells up) [m], for cells of about dx."""
    cell = height / max(1, round(height / dx))
    across = math.ceil(1.4 * width / cell)
    return cell, 0.5 * (across * cell - width)
