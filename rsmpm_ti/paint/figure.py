"""Frames: the panel of particles with axes, colour bar, legend, numbers and the load curve up to now."""

import functools
import math
import os
from dataclasses import replace

import matplotlib
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from rsmpm_ti.errors import refuse
from rsmpm_ti.paint.frame_axes import MEGA, MILLI, draw_chrome
from rsmpm_ti.paint.frame_kinds import Look, crack_look, cracking_look, margin_look, stress_look
from rsmpm_ti.paint.ggui import Ggui, probe
from rsmpm_ti.paint.layout import TEXT_LINE, Box, lay_out
from rsmpm_ti.paint.palette import View
from rsmpm_ti.paint.raster import Raster
from rsmpm_ti.paint.words import drawable
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.records.snapshot import INTACT, SHEAR, TENSION, Pattern, Snapshot

KINDS = ("stress", "cracks", "margin")
PAINTERS = {"raster": Raster, "ggui": Ggui}
TEXT_LINES = 8  # the most that `FramePainter._lines` writes
SMOOTH = 3  # the inset's curve is drawn this many times larger and reduced
INTERFACE = (0x70, 0x70, 0x68)  # colour of the line where two rocks meet
MARGIN = 10  # pixels around the inset's box that its marker may stick out


class FramePainter:
    """Paints frames of one kind, all of one size and with the same limits, as a movie needs them.

    kind: "stress" (largest principal stress), "cracks" (failure modes) or "margin" (how near to failure); lower, upper:
    corners of the specimen [m], in 3D those of the face seen along z; stress_limit: end of the colour bar [Pa], the
    same for both signs (needed for "stress"); strain_limit [1] and load_limit [Pa]: ends of the inset's axes, both or
    there is no inset; softens: "cracks" tints rock that has begun to lose strength and not failed; backend: "raster" or
    "ggui"; size: even (width, height) in pixels, by default from the specimen's shape; convention: written on the
    colour bar of "stress"; strain_name, load_name: axes of the inset; interface: ids of particles beside each other of
    two rocks, [pairs, 2], between which "cracks" shows a line.

    Allocates Taichi fields: make it after `ti.init`, and `close` it before the next.
    """

    def __init__(
        self,
        *,
        kind: str,
        lower: tuple[float, float],
        upper: tuple[float, float],
        stress_limit: float | None = None,
        strain_limit: float | None = None,
        load_limit: float | None = None,
        softens: bool = False,
        backend: str = "raster",
        size: tuple[int, int] | None = None,
        title: str | None = None,
        convention: str = "tension positive",
        strain_name: str = "axial strain",
        load_name: str = "total axial stress",
        interface: np.ndarray | None = None,
    ):
        if kind not in KINDS:
            raise refuse("kind", kind, f"one of {', '.join(KINDS)}")
        if backend not in PAINTERS:
            raise refuse("painter", backend, f"one of {', '.join(PAINTERS)}")
        if not (upper[0] > lower[0] and upper[1] > lower[1]):
            raise refuse("upper", upper, f"above and right of lower = {lower}")
        for name, limit in (("stress_limit", stress_limit), ("strain_limit", strain_limit), ("load_limit", load_limit)):
            if limit is not None and not (math.isfinite(limit) and limit > 0.0):
                raise refuse(name, limit, "a positive finite number")
        if kind == "stress" and stress_limit is None:
            raise refuse("stress_limit", stress_limit, "given for stress frames", "the colour bar ends there")
        if backend == "ggui" and not probe()[0]:
            raise refuse("painter", backend, "raster on this machine", probe()[1])

        self.kind = kind
        self.backend = backend
        self._interface = interface if kind == "cracks" else None
        words = [None if text is None else drawable(text) for text in (title, convention, strain_name, load_name)]
        look = self._look(stress_limit, softens, *words)
        self._palette, self.wording, self._value = look.palette, look.wording, look.value
        self.layout = lay_out(lower[:2], upper[:2], size, TEXT_LINES, len(look.wording.legend))
        self._limits = None if strain_limit is None or load_limit is None else (strain_limit, load_limit)
        self._chrome = functools.cache(lambda limits: draw_chrome(self.layout, self._palette, self.wording, limits))
        self._painter = PAINTERS[backend](self.layout.view, self._palette)

    def _look(self, stress_limit, softens, title, convention, strain_name, load_name) -> Look:
        inset = {"inset_x": f"{strain_name} [%]", "inset_y": f"{load_name} [MPa]"}
        if self.kind == "stress":
            return stress_look(stress_limit, title, convention, inset)
        if self.kind == "margin":
            return margin_look(title, inset)
        return cracking_look(title, inset) if softens else crack_look(title, inset)

    def panel(self, snapshot: Snapshot | Pattern) -> np.ndarray:
        """The particles alone, uint8 [h, w, 3]; `extent_mm` says what it spans."""
        shown = slab(snapshot)
        dim = snapshot.x.shape[1]
        half = 0.5 * np.maximum(snapshot.volume[shown], 0.0) ** (1.0 / dim)
        value = self._value(snapshot)
        if value is not None:
            value = value[shown]
        image = self._painter.image(snapshot.x[shown], half, snapshot.failure_mode[shown], value)
        if self._interface is None:
            return image
        return draw_interface(image, self.layout.view, snapshot, shown, self._interface)

    @property
    def extent_mm(self) -> tuple[float, float, float, float]:
        """Left, right, bottom and top of the panel."""
        view = self.layout.view
        return tuple(MILLI * c for c in (view.lower[0], view.upper[0], view.lower[1], view.upper[1]))

    def paint(self, snapshot: Snapshot, history: np.ndarray, frame: int | None = None) -> np.ndarray:
        """One frame, uint8 [H, W, 3].

        history: rows up to now with the fields HISTORY_COLUMNS, perhaps none; where no strain was ever recorded the
        frame has neither inset nor load.
        """
        strain, load = load_curve(history)
        loaded = self._limits is not None and (len(strain) == 0 or bool(np.isfinite(strain * load).any()))
        limits = self._limits if loaded else None
        image = self._chrome(limits).copy()
        panel = self.layout.panel
        image[panel.top - 1 : panel.bottom + 1, panel.left - 1 : panel.right + 1] = 0  # the axes' frame
        image[panel.top : panel.bottom, panel.left : panel.right] = self.panel(snapshot)

        text, inset = self.layout.text, self.layout.inset
        column = image[text.top : inset.bottom + MARGIN, text.left :]
        picture = Image.fromarray(column)  # of the whole frame the way there and back takes 10 ms
        if limits is not None:
            box = replace(inset, left=inset.left - text.left, top=inset.top - text.top)
            draw_curve(picture, box, strain / limits[0], load / limits[1])
        draw = ImageDraw.Draw(picture)
        for line, words in enumerate(self._lines(snapshot, strain, load, frame)):
            draw.text((0, line * TEXT_LINE), words, fill=(0, 0, 0), font=mono_font(18))
        column[:] = picture
        return image

    def close(self) -> None:
        """Gives back the painter's window, if it has one."""
        self._painter.close()

    def _lines(self, snapshot: Snapshot, strain: np.ndarray, load: np.ndarray, frame: int | None) -> list[str]:
        tension = int(np.count_nonzero(snapshot.failure_mode == TENSION))
        shear = int(np.count_nonzero(snapshot.failure_mode == SHEAR))
        rows = [] if frame is None else [("frame", str(frame), "")]
        rows.append(("time", f"{snapshot.time * 1e3:.3f}", "ms"))
        if len(strain) and np.isfinite(strain[-1]):
            rows.append(("strain", f"{strain[-1] * 100.0:.3f}", "%"))
        if len(load) and np.isfinite(load[-1]):
            rows.append(("load", f"{load[-1] * MEGA:.2f}", "MPa"))
        failed = 100.0 * (tension + shear) / max(1, len(snapshot.failure_mode))
        rows += [("tension", str(tension), ""), ("shear", str(shear), ""), ("failed", f"{failed:.2f}", "%")]
        if self._painter.skipped:
            rows.append(("not finite", str(self._painter.skipped), "not shown"))
        return [f"{name:<10}{number:>9} {unit}" for name, number, unit in rows]


def slab(snapshot: Snapshot | Pattern) -> np.ndarray | slice:
    """Which particles a frame shows: all in 2D; in 3D those within one spacing of the mid-plane in z.

    They are chosen where they were seeded, so that all frames show the same ones.
    """
    if snapshot.x.shape[1] == 2:
        return slice(None)
    z = snapshot.x[:, 2] - snapshot.displacement[:, 2]
    spacing = np.cbrt(np.nanmedian(snapshot.volume))
    # Lattice layers lie half a spacing off the middle, or on it; the margin keeps round-off from taking one side only.
    return abs(z - 0.5 * (np.nanmin(z) + np.nanmax(z))) <= 0.99 * spacing


def draw_interface(panel: np.ndarray, view: View, snapshot: Snapshot | Pattern, shown, pairs: np.ndarray) -> np.ndarray:
    """The panel with a thin line where two rocks meet: a piece between each pair of particles that are both whole.

    pairs: their ids, [k, 2]; shown: which particles the panel shows.
    """
    candidates = np.zeros(len(snapshot.id), dtype=bool)
    candidates[shown] = True
    candidates &= (snapshot.failure_mode == INTACT) & np.isfinite(snapshot.x).all(axis=1)
    place = np.minimum(np.searchsorted(snapshot.id, pairs), len(snapshot.id) - 1)
    drawn = (snapshot.id[place] == pairs).all(axis=1) & candidates[place].all(axis=1)
    scale = np.array([view.width, -view.height]) / (np.array(view.upper) - np.array(view.lower))
    a, b = ((snapshot.x[k, :2] - (view.lower[0], view.upper[1])) * scale for k in place[drawn].T)
    along = 0.5 * np.stack([a[:, 1] - b[:, 1], b[:, 0] - a[:, 0]], axis=1)
    picture = Image.fromarray(panel)
    draw = ImageDraw.Draw(picture)
    for ends in np.concatenate([0.5 * (a + b) - along, 0.5 * (a + b) + along], axis=1).tolist():
        draw.line(ends, fill=INTERFACE)
    return np.array(picture)


def load_curve(history: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Axial strain [1] and the mean of the stresses on both platens [Pa], [rows], compression positive."""
    return history["axial_strain"], nominal_stress(history)


def draw_curve(picture: Image.Image, box: Box, across: np.ndarray, up: np.ndarray) -> None:
    """Draws a curve into the inset, with a marker at its end; `across` and `up` run from 0 to 1 over the box."""
    finite = np.isfinite(across) & np.isfinite(up)
    if not finite.any():
        return
    region = (box.left - MARGIN, box.top - MARGIN, box.right + MARGIN, box.bottom + MARGIN)
    width, height = region[2] - region[0], region[3] - region[1]
    large = picture.crop(region).resize((width * SMOOTH, height * SMOOTH), Image.Resampling.NEAREST)
    draw = ImageDraw.Draw(large)
    x = SMOOTH * (MARGIN + np.clip(across[finite], 0.0, 1.0) * box.width)
    y = SMOOTH * (MARGIN + (1.0 - np.clip(up[finite], 0.0, 1.0)) * box.height)
    points = list(zip(x.tolist(), y.tolist(), strict=True))
    if len(points) > 1:
        draw.line(points, fill=(64, 64, 64), width=2 * SMOOTH)
    draw.circle(points[-1], 5 * SMOOTH, fill=(0xD5, 0x5E, 0x00))
    picture.paste(large.reduce(SMOOTH), region)


@functools.cache
def mono_font(size: int) -> ImageFont.FreeTypeFont:
    """DejaVu Sans Mono from matplotlib's own files, so that no system font is needed."""
    return ImageFont.truetype(os.path.join(matplotlib.get_data_path(), "fonts", "ttf", "DejaVuSansMono.ttf"), size)
