"""Pictures and movie of a run, small and within the page: before the first failure, at the peak, at the end."""

import base64
import io
import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from rsmpm_ti.lab.report.curves import across, across_name
from rsmpm_ti.lab.standard import Measured
from rsmpm_ti.paint.layout import lay_out
from rsmpm_ti.paint.png import TIME_NOTE
from rsmpm_ti.records.files import known
from rsmpm_ti.records.history_table import nominal_stress

SHOWN_RUNS = 6
"""Runs with pictures in the page; those of the others stay in their folders."""

WIDTH, QUALITY = 480, 82
"""Of a picture in the page [px], and of WebP."""

MOVIE_BYTES = 3_000_000
"""A larger movie stays beside the page."""


@dataclass(frozen=True, kw_only=True)
class Picture:
    """source: a data: address; width, height [px]."""

    title: str
    caption: str
    source: str
    width: int
    height: int


def pictures_of(test: str, one: Measured) -> list[Picture]:
    """Of the frames of cracks that are there and can be read: at most three, in the order of time."""
    frames = frames_of(one.folder)
    return [
        picture
        for title, (time, path) in chosen(frames, one).items()
        if (picture := _picture(test, one, title, time, path)) is not None
    ]


def frames_of(folder: Path) -> list[tuple[float, Path]]:
    """Time [s] and path of every frame of cracks that says its time, in the order of time."""
    found = []
    for path in sorted((folder / "frames").glob("cracks_*.png")):
        try:
            with Image.open(path) as image:
                time = float(image.info.get(TIME_NOTE, "nan"))
        except (OSError, ValueError, SyntaxError):  # Pillow raises each of them for a damaged file
            continue
        if math.isfinite(time):
            found.append((time, path))
    return sorted(found)


def chosen(frames: list[tuple[float, Path]], one: Measured) -> dict[str, tuple[float, Path]]:
    """Title -> frame. At the peak: that of the largest load; before: the last one before the first failure."""
    if not frames:
        return {}
    load = [abs(_at(time, one, nominal_stress(one.history))) for time, _ in frames]
    peak = int(np.nanargmax(load)) if np.isfinite(load).any() else 0
    first = known(one.summary.get("first_failure_time_s"))
    whole = [k for k, (time, _) in enumerate(frames) if first is None or time < first]
    before = min(whole[-1] if whole else 0, max(peak - 1, 0))
    titles = {}
    for k, title in ((before, "Before the peak"), (peak, "At the peak"), (len(frames) - 1, "At the end")):
        if frames[k] not in titles.values():
            titles[title] = frames[k]
    return titles


def _at(time: float, one: Measured, values: np.ndarray) -> float:
    """Of a column, at a time of the run [s]."""
    rows = np.isfinite(values)
    return float(np.interp(time, one.history["time_s"][rows], values[rows])) if rows.any() else math.nan


def _picture(test: str, one: Measured, title: str, time: float, path: Path) -> Picture | None:
    try:
        with Image.open(path) as image:
            panel = image.convert("RGB").crop(panel_box(one, image.size))
            panel.thumbnail((WIDTH, 2 * WIDTH))
    except (OSError, ValueError, SyntaxError):
        return None
    file = io.BytesIO()
    panel.save(file, "WEBP", quality=QUALITY, method=6)
    name, _, unit = across_name(test).rpartition(" ")
    where = f"{name} {_at(time, one, across(test, one)):.3g} {unit.strip('[]')}"
    load = f"nominal stress {1e-6 * abs(_at(time, one, nominal_stress(one.history))):.3g} MPa"
    return Picture(
        title=title, caption=f"{where}, {load}", source=data_address("image/webp", file.getvalue()),
        width=panel.width, height=panel.height,
    )  # fmt: skip


def panel_box(one: Measured, size: tuple[int, int]) -> tuple[int, int, int, int]:
    """Of the specimen, within a frame of this size; all of a frame that is not laid out as this version does it."""
    layout = lay_out(*corners(one), None, 0, 0)
    panel = layout.panel
    return (panel.left, panel.top, panel.right, panel.bottom) if layout.size == size else (0, 0, *size)


def corners(one: Measured) -> tuple[tuple[float, float], tuple[float, float]]:
    """Lower and upper one of the specimen [m]."""
    low, high = zip(*(body.region.bounds() for body in one.specimen.scene.bodies), strict=True)
    return tuple(np.min(low, axis=0)[:2]), tuple(np.max(high, axis=0)[:2])


def data_address(kind: str, data: bytes) -> str:
    return f"data:{kind};base64,{base64.b64encode(data).decode()}"


def movie_of(one: Measured) -> tuple[str, str]:
    """Data address of a run's movie, "" where it is too large or there is none; and why, "" where it is there."""
    path = one.folder / "run.mp4"
    try:
        size = path.stat().st_size
        if size > MOVIE_BYTES:
            return "", f"The movie has {size / 1e6:.1f} MB and is not in this page."
        return data_address("video/mp4", path.read_bytes()), ""
    except OSError:
        return "", "No movie was written."
