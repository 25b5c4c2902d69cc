"""The file of a drawing: where it is looked for, what of it is read, and how it is known again.

A recorded scene names its files, and a stranger may have written it: only regular files of a bounded size are opened,
so no device or pipe is. The record holds the SHA-256 of what was read, and another file is refused.
"""

import contextlib
import hashlib
import os
import stat
from collections.abc import Iterator
from contextvars import ContextVar
from pathlib import Path, PurePath
from typing import Annotated, NamedTuple

from annotated_types import Len
from pydantic import BeforeValidator

from rsmpm_ti.checks import Remedy
from rsmpm_ti.errors import reason, refuse, shown


def _as_text(path):
    return os.fspath(path) if isinstance(path, PurePath) else path


FileName = Annotated[
    str, Len(1, 4096), BeforeValidator(_as_text), Remedy("it names a file, in the current folder or beside the scene's")
]

_FOLDER: ContextVar[Path | None] = ContextVar("_FOLDER", default=None)


@contextlib.contextmanager
def beside(folder: Path) -> Iterator[None]:
    """Within it a file that is not in the current folder is looked for in another one: that of the scene's own file."""
    token = _FOLDER.set(folder)
    try:
        yield
    finally:
        _FOLDER.reset(token)


class Drawn(NamedTuple):
    """What a file held when it was read."""

    data: bytes
    sha256: str


def read(field: str, name: str, sha256: str | None, most: int) -> Drawn:
    """The bytes of a file, `most` of them at most.

    field: its name in refusals, as "mask.image"; sha256: in hexadecimal digits what it must be, None for any file.
    Raises SceneError for what is no regular file, is larger, cannot be read, or has another digest.
    """
    try:
        data = _bytes(_found(Path(name)), most)
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise refuse(field, name, "a file that can be read", reason(error)) from None
    if data is None:
        raise refuse(field, name, f"a regular file of at most {most >> 20} MiB")
    digest = hashlib.sha256(data).hexdigest()
    if sha256 not in (None, digest):
        owner = field.rpartition(".")[0]
        known = f"the file of which {owner}.sha256 = {shown(sha256)} is known"
        raise refuse(field, name, known, f"this one has {digest}; without a sha256 it would be taken")
    return Drawn(data, digest)


def _found(path: Path) -> Path:
    folder = _FOLDER.get()
    there = folder is None or path.is_absolute() or path.exists()
    return path if there else folder / path  # type: ignore[operator]


def _bytes(path: Path, most: int) -> bytes | None:
    """None for what is no regular file, or is larger. Asked before it is opened, as opening a device may do something,
    and after, as it may have become another."""
    if not stat.S_ISREG(path.stat().st_mode):
        return None
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    with open(descriptor, "rb") as file:
        there = os.fstat(descriptor)
        if not stat.S_ISREG(there.st_mode) or there.st_size > most:
            return None
        data = file.read(most + 1)
    return data if len(data) <= most else None
