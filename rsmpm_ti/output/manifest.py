"""The list of a run's files, kept in its folder: what is not on it is never removed, moved or replaced.

A name is on the disk in the list before its file is first made, so that no kill leaves a file that is nobody's. A list
may come from a stranger: only names that this program gives are read from it, all of them within the folder.
"""

import errno
import os
import re
import stat
import uuid
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output.files import CHECKPOINTS, COLLECTION, frame_name, vtu_name
from rsmpm_ti.output.pictures import kinds_of
from rsmpm_ti.records.files import complete, part_of
from rsmpm_ti.spec.scene import Scene

FILE = "manifest.txt"
HEAD = "rsmpm_ti: files of a run"

HERE, MOVING, ASIDE = "here", "moving", "aside"
"""States of a run in a folder: where it was run; on its way into the folder of an earlier run; there as a whole."""

FRAMES = "frames"
NAME = re.compile(
    r"frames/[a-z]+_\d{4,}\.png|particles_\d{4,}\.vtu|particles\.pvd|checkpoint(\.previous)?\.npz"
    r"|(scene|summary)\.json|[a-z]+\.csv|summary\.png|[^/\\\0\r\n]+\.mp4"
)
"""Every name that this program gives to a file of a run."""

LARGEST_BYTES = 16 * 2**20


def names_of(scene: Scene, name: str) -> Iterator[str]:
    """Every name that a new run of a scene may make a file of."""
    wanted = scene.output
    yield from (*CHECKPOINTS, "scene.json", "summary.json", "summary.png")
    yield from (f"{table}.csv" for table in ("history", "reactions", "events", "cracks", "fragments", "acoustic"))
    if wanted.movie:
        yield f"{name}.mp4"
    if wanted.vtu:
        yield COLLECTION
        yield from map(vtu_name, range(wanted.vtu + 1))
    if wanted.frames:  # jumps add as many, at most
        yield "frames.csv"
        for kind in kinds_of(scene):
            yield from (frame_name(kind, number) for number in range(2 * wanted.frames + 1))


def new_id() -> str:
    return uuid.uuid4().hex


@dataclass(frozen=True)
class Manifest:
    """run: identifies it; state: HERE, MOVING or ASIDE; names: relative to the folder, in the order of their making."""

    run: str = field(default_factory=new_id)
    state: str = HERE
    names: tuple[str, ...] = ()


def read(folder: Path) -> Manifest | None:
    """The list in a folder; None where there is none. Raises SceneError for a file of that name that is no list."""
    path = folder / FILE
    try:
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0))
    except (FileNotFoundError, NotADirectoryError):
        return None
    except OSError:  # a link, for one
        raise _no_list(path) from None
    with open(descriptor, "rb") as file:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise _no_list(path)
        data = file.read(LARGEST_BYTES + 1)
    head, *lines = data.decode("utf-8", "surrogateescape").split("\n")
    words = re.fullmatch(rf"{HEAD}, ([0-9a-f]{{32}}), ({HERE}|{MOVING}|{ASIDE})", head)
    names = tuple(dict.fromkeys(lines[:-1]))  # the last line has no end where a kill cut it, and then no file
    if words is None or len(data) > LARGEST_BYTES or not all(NAME.fullmatch(name) for name in names):
        raise _no_list(path)
    return Manifest(words[1], words[2], names)


def _no_list(path: Path) -> SceneError:
    return SceneError(f"{path} is no list of a run's files, so that nothing can be told there; move the folder away")


def write(folder: Path, manifest: Manifest) -> None:
    """Replace the list of a folder."""
    lines = (f"{HEAD}, {manifest.run}, {manifest.state}", *manifest.names)
    with complete(folder / FILE) as part:
        part.write_bytes("".join(f"{line}\n" for line in lines).encode("utf-8", "surrogateescape"))


def append(folder: Path, names: Iterable[str]) -> None:
    """More names, on the disk on return."""
    lines = "".join(f"{name}\n" for name in names).encode("utf-8", "surrogateescape")
    not_beyond = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)  # somebody may have put a pipe there
    descriptor = os.open(folder / FILE, os.O_RDWR | os.O_APPEND | not_beyond)
    found = os.fstat(descriptor)
    size = found.st_size
    try:
        head = os.pread(descriptor, len(HEAD), 0) if stat.S_ISREG(found.st_mode) else b""
        if head != HEAD.encode():
            size = -1
            raise OSError(errno.EIO, "it is no list of a run any more", str(folder / FILE))
        if os.write(descriptor, lines) < len(lines):
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(folder / FILE))
        os.fsync(descriptor)
    except OSError:
        if size >= 0:
            os.ftruncate(descriptor, size)  # half a name would make no list of it
        raise
    finally:
        os.close(descriptor)


def mode_of(path: Path) -> int:
    """What a path is, by its own mode and not that of what a link leads to; 0 where there is nothing."""
    try:
        return os.lstat(path).st_mode
    except FileNotFoundError:
        return 0


def is_folder(path: Path) -> bool:
    return stat.S_ISDIR(mode_of(path))


def is_file(folder: Path, name: str) -> bool:
    """Whether a name on a list is a file within the folder itself: no link, and not beyond one."""
    path = folder / name
    return (path.parent == folder or is_folder(path.parent)) and stat.S_ISREG(mode_of(path))


def remove(folder: Path, names: Iterable[str]) -> None:
    """Remove files that are on the list of a folder."""
    for name in names:
        if is_file(folder, name):
            (folder / name).unlink()


def sweep(folder: Path, names: Iterable[str]) -> None:
    """Remove what a kill left half written of files that are on the list of a folder."""
    remove(folder, (part_of(Path(name)).as_posix() for name in names))
