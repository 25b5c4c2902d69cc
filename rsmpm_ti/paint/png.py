"""PNG files: written whole or not at all, with notes such as the painter's name in them."""

import os
import struct
import zlib
from pathlib import Path

import fpng
import numpy as np

from rsmpm_ti.records.files import complete

NOTES_AT = 33
"""Bytes of the signature and of the first chunk, which must be IHDR; others may follow in any order."""

TIME_NOTE = "time_s"
"""Key of the note that says at what time of its run a frame was [s]."""


def write_png(path: str | os.PathLike, image: np.ndarray, **notes: str) -> Path:
    """Writes uint8 [h, w, 3] under its name only when complete; notes go into the file as text (Latin-1).

    fpng takes a tenth of Pillow's time, which goes into trying filters, for files of the same size.
    """
    path = Path(path)
    data = fpng.from_ndarray(np.ascontiguousarray(image))
    texts = [text_chunk(key, note) for key, note in notes.items()]
    with complete(path) as part:
        part.write_bytes(b"".join((data[:NOTES_AT], *texts, data[NOTES_AT:])))
    return path


def text_chunk(key: str, note: str) -> bytes:
    """A tEXt chunk (PNG specification, 11.3.3.2): length, type, data and the check sum of the latter two."""
    body = b"tEXt" + key.encode("latin-1") + b"\0" + note.encode("latin-1")
    return struct.pack(">I", len(body) - 4) + body + struct.pack(">I", zlib.crc32(body))


def read_png(path: str | os.PathLike, size: tuple[int, int]) -> np.ndarray:
    """What `write_png` wrote, uint8 [h, w, 3]. Raises ValueError where it has another (width, height), before that is
    decoded."""
    from imageio.v3 import improps, imread

    height, width = improps(path, plugin="pillow").shape[:2]
    if (width, height) != size:
        raise ValueError(f"{width} x {height} pixels and not {size[0]} x {size[1]}")
    return imread(path, plugin="pillow", mode="RGB")
