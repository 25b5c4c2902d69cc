"""The frame of a run that was painted nearest to an instant, from its folder."""

import io

import numpy as np
from PIL import Image

from rsmpm_ti.errors import SceneError, refuse, shown
from rsmpm_ti.output.files import frame_name
from rsmpm_ti.paint.figure import KINDS
from rsmpm_ti.results.stored import Stored

MOST_BYTES = 64 * 2**20


def frame_nearest(folder: Stored, frames: np.ndarray | None, time: float, kind: str) -> Image.Image:
    """The picture of a kind nearest to a time [s], of two as near the earlier; infinite: the last one.

    frames: the columns of frames.csv. `info` of the picture holds its row of them. Raises SceneError where no frame of
    the kind is in the folder, or it cannot be read.
    """
    if kind not in KINDS:
        raise refuse("kind", kind, f"one of {', '.join(KINDS)}")
    there = set(folder.names)
    rows = [] if frames is None else [row for row in frames if frame_name(kind, int(row["frame"])) in there]
    if not rows:
        remedy = "run it with output.margin" if kind == "margin" else "run it with output.frames"
        raise SceneError(f"{folder.path} has no frames of kind {shown(kind)}; {remedy}")
    times = np.array([row["time_s"] for row in rows])
    row = rows[-1] if time == np.inf else rows[int(np.argmin(np.abs(times - time)))]
    name = frame_name(kind, int(row["frame"]))
    try:
        with Image.open(io.BytesIO(folder.bytes(name, MOST_BYTES)), formats=["PNG"]) as picture:
            image = picture.convert("RGB")
    except (OSError, ValueError, SyntaxError, Image.DecompressionBombError) as error:  # Pillow raises each of them
        raise error if isinstance(error, SceneError) else SceneError(f"{folder.path / name} is no picture") from None
    image.info = {key: float(row[key]) for key in frames.dtype.names}  # type: ignore[union-attr]
    return image
