"""Arrays out of a file that may be anything: each is what it says to be, and no larger than the file.

An .npz file is a zip of .npy files. Ours are stored as they are, so what they hold takes as much on the disk: a few
megabytes cannot become gigabytes in memory.
"""

import math
import stat
import zipfile
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np

MOST_ARRAYS = 10_000


class Damaged(Exception):
    """A file that is no checkpoint of this run, and why, in a few words."""


class Header(NamedTuple):
    """What an array says of itself."""

    dtype: np.dtype
    shape: tuple[int, ...]
    by_columns: bool


def need(sound, reason: str) -> None:
    """Raise Damaged, for a reason, where something is not so."""
    if not sound:
        raise Damaged(reason)


def find_file(folder: Path, name: str) -> Path | None:
    """A file of a run's folder, itself and no device; None where there is none.

    Opening a FIFO would wait for ever, and a link may lead to where nobody looks.
    """
    path = folder / name
    try:
        kind = path.lstat().st_mode
    except (FileNotFoundError, NotADirectoryError):
        return None
    if stat.S_ISLNK(kind):
        target = path.resolve()
        need(target.parent == folder.resolve(), "it is a link out of the folder")
        kind = target.stat().st_mode
    need(stat.S_ISREG(kind), "it is no regular file")
    return path


class StoredArrays:
    """The arrays of an open .npz file, by name. `headers` are known at once, `read` reads one."""

    def __init__(self, file):
        self._zip = zipfile.ZipFile(file)
        entries = self._zip.infolist()
        need(len(entries) <= MOST_ARRAYS, f"it holds {len(entries)} arrays, more than {MOST_ARRAYS}")
        need(all(e.compress_type == zipfile.ZIP_STORED for e in entries), "it is compressed")
        held, size = sum(e.file_size for e in entries), file.seek(0, 2)
        need(held <= size, f"its arrays would take {held} bytes and the file has {size}")
        self._entries = {e.filename.removesuffix(".npy"): e for e in entries}
        need(len(self._entries) == len(entries), "two of its arrays have the same name")
        self.size = held
        self.headers = {name: self._header(name) for name in self._entries}

    def _header(self, name: str) -> Header:
        entry = self._entries[name]
        with self._zip.open(entry) as file:
            return _read_header(file, entry.file_size, name)

    def read(self, name: str) -> np.ndarray:
        """All of an array, against its checksum."""
        entry = self._entries[name]
        with self._zip.open(entry) as file:
            header = _read_header(file, entry.file_size, name)
            data = bytearray(file.read())
        order: Literal["C", "F"] = "F" if header.by_columns else "C"
        return np.frombuffer(data, dtype=header.dtype).reshape(header.shape, order=order)


def _read_header(file, size: int, name: str) -> Header:
    """The header of an .npy file of so many bytes, which leaves the file where its numbers begin."""
    version = np.lib.format.read_magic(file)
    need(version in ((1, 0), (2, 0)), f"array {name} has format {version}")
    read = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
    shape, by_columns, dtype = read(file)
    need(not dtype.hasobject, f"array {name} holds objects")
    need(all(type(n) is int and n >= 0 for n in shape), f"array {name} has shape {shape}")
    told = math.prod(shape) * dtype.itemsize
    need(file.tell() + told == size, f"array {name} of {told} bytes has {size - file.tell()}")
    return Header(dtype, shape, by_columns)
