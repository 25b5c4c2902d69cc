"""The folder of a run: looked at and locked before anything is computed, and the run's own from the moment it begins.

Until then nothing in it is changed. After that every file is claimed before it is made: its name goes on the list of
the folder (`manifest.py`), and what was there before and is not on that list is in the way.
"""

import contextlib
import json
import os
import stat
import tempfile
from collections.abc import Iterable
from pathlib import Path

from rsmpm_ti import __version__
from rsmpm_ti.errors import SceneError, refuse, room
from rsmpm_ti.output import manifest
from rsmpm_ti.output.earlier import check_place, previous_of, remove_aside, set_all_aside, set_aside, summary_of
from rsmpm_ti.output.files import CHECKPOINTS, whole
from rsmpm_ti.output.lock import Lock
from rsmpm_ti.output.manifest import FRAMES, NAME, Manifest, is_file, is_folder, mode_of, names_of
from rsmpm_ti.records.files import complete, part_of, plain, write_json
from rsmpm_ti.spec.scene import Scene

RENDERS = Path("renders")
"""Where runs go that are given no folder: what is in renders/NAME is this program's, and a new run replaces it."""

REMEDY = "move it away, or give another folder with --out"
RECORD, SUMMARY = "scene.json", "summary.json"


class FolderGone(SceneError):
    """The folder was moved, removed or replaced during the run, or another run has taken it."""


def prepare(
    scene: Scene,
    out: str | os.PathLike,
    name: str = "scene",
    precision: str = "f64",
    *,
    overwrite: bool = False,
    resume: bool = False,
) -> "RunFolder":
    """Look at the folder and lock it now, so that one that cannot be used costs no computing; check the painter too.

    overwrite: a run that is there will be replaced; resume: one will go on. Raises SceneError.
    """
    if scene.output.painter == "ggui" and scene.output.frames:
        from rsmpm_ti.paint.ggui import probe

        usable, reason = probe()
        if not usable:
            raise refuse("output.painter", "ggui", "raster on this machine", reason)
    if not NAME.fullmatch(f"{name}.mp4"):
        raise refuse("name", name, "a name that a file can have", "the movie is called by it")
    folder = None
    try:
        # absolute: a callback of the user may change the current folder
        renews = overwrite and not resume and Path(out) == RENDERS / name
        folder = RunFolder(Path(out).absolute(), record(scene, name, precision), renews)
        folder.check(names_of(scene, name), overwrite, resume)
    except BaseException as error:
        if folder is not None:
            folder.release()
        if isinstance(error, OSError | ValueError) and not isinstance(error, SceneError):  # of a name no file can have
            raise unwritable(Path(out), error) from None
        raise
    return folder


def unwritable(out: Path, error: Exception) -> SceneError:
    reason = getattr(error, "strerror", None) or error
    return SceneError(f"output folder {out} cannot be written: {reason}; {room(str(error))}give another with --out")


def record(scene: Scene, name: str, precision: str) -> bytes:
    """scene.json: what was run, by what, on what."""
    from rsmpm_ti.spec.review.machine import machine
    from rsmpm_ti.spec.scene_json import to_plain

    seeds = [getattr(body.seeding, "seed", None) for body in scene.bodies]
    found = {
        "rsmpm_ti": __version__, "name": name, "precision": precision, "seeds": seeds, "machine": machine(),
        "time_scale": scene.time_scale, "scene": to_plain(scene),
    }  # fmt: skip
    return f"{json.dumps(plain(found), indent=2, allow_nan=False)}\n".encode()


class RunFolder:
    """The folder of one run; `prepare` makes it, `release` gives it back."""

    def __init__(self, path: Path, record: bytes, renews: bool):
        """path: absolute; renews: it is the default one, in which everything is a run's."""
        self.path, self.begun = path, False
        self._record = record
        self._made = [folder for folder in (path, *path.parents) if not folder.exists()]
        self._frames: os.stat_result | None = None
        try:
            path.mkdir(parents=True, exist_ok=True)
            self.lock = Lock(path)
        except BaseException:
            self._unmake()
            raise
        try:
            self._place = os.stat(path)
            with tempfile.TemporaryFile(dir=path) as probe:  # an empty file is made on a full disk too
                probe.write(record)
            if is_folder(path / FRAMES):
                tempfile.TemporaryFile(dir=path / FRAMES).close()  # files are moved out of it too
            self._manifest = manifest.read(path)
            self._names = set(self._manifest.names) if self._manifest else set()
            self._previous = previous_of(path)
            # everything may be moved as it is: filled by a version without lists
            self._all_aside = renews and self._manifest is None and is_file(path, RECORD)
        except BaseException:
            self.release()
            raise

    def check(self, names: Iterable[str], overwrite: bool, resume: bool) -> None:
        """Refuse what must stay as it is. names: of all files that the run may make."""
        frames = mode_of(self.path / FRAMES)
        if frames and not stat.S_ISDIR(frames):
            raise SceneError(f"{self.path / FRAMES} is no folder, so that frames cannot be written: {REMEDY}")
        for name in self._names:
            if mode_of(self.path / name) and not is_file(self.path, name):
                raise SceneError(f"{self.path / name} is no plain file, so no run has made it: {REMEDY}")
        if self._all_aside:
            check_place(self._previous, None)
            return
        if self._manifest is None and mode_of(part_of(self.path / manifest.FILE)):
            raise SceneError(f"{part_of(self.path / manifest.FILE)} is in the way, no run has made it: {REMEDY}")
        beside = os.stat(self.path.parent)
        if self._manifest is not None and overwrite and beside.st_dev != self._place.st_dev:
            remedy = "the run before is kept beside it, and files do not move between disks; give a folder in it"
            raise refuse("out", str(self.path), "no disk of its own", remedy)
        if self._manifest is not None and not (overwrite or resume):
            remedy = "--overwrite (overwrite=True) replaces it, --resume goes on with it"
            raise refuse("out", str(self.path), "a folder without a run", remedy)
        for name in names:
            self._check_free(name)
        if self._manifest is not None and not resume:
            check_place(self._previous, self._manifest)

    def start_anew(self) -> None:
        """Where there is nothing to go on from, refuse to replace a run that is complete: nobody asked for that."""
        if self._manifest is not None:
            if summary_of(self.path).get("complete"):
                remedy = "the run there is complete; --overwrite (overwrite=True) replaces it"
                raise refuse("resume", True, f"False without a checkpoint in {self.path}", remedy)
            check_place(self._previous, self._manifest)

    def begin(self, *, goes_on: bool = False) -> None:
        """From here on the folder is this run's. goes_on: with the run that is there, which else is set aside."""
        earlier = self._manifest
        self._check_here()
        try:
            if earlier is not None:
                manifest.sweep(self.path, earlier.names)
            elif not self._all_aside:
                self._list((RECORD,))
            with complete(self.path / RECORD) as part:
                part.write_bytes(self._record)  # a full disk is found while everything is where it was
                if self._all_aside:
                    set_all_aside(self.path, self._previous)
                elif earlier is not None and not goes_on:
                    set_aside(self.path, earlier, self._previous)
                self._list(self._go_on(earlier.names) if earlier is not None and goes_on else (RECORD,))
                if not is_folder(self.path / FRAMES):
                    (self.path / FRAMES).mkdir()
        except (OSError, SceneError) as error:
            if earlier is None:
                with contextlib.suppress(OSError):
                    (self.path / manifest.FILE).unlink()
            raise error if isinstance(error, SceneError) else unwritable(self.path, error) from None
        self._frames, self.begun = os.lstat(self.path / FRAMES), True

    def _go_on(self, names: tuple[str, ...]) -> tuple[str, ...]:
        """The run that is there is not complete any more, and its movie is made again from its frames. Returns the
        names of its files that are there."""
        said = summary_of(self.path)
        stale = [name for name in names if name.endswith(".mp4")]
        try:
            if said:
                write_json(self.path / SUMMARY, said | {"complete": False})
        except RecursionError:
            said = {}
        manifest.remove(self.path, stale if said else [*stale, SUMMARY])
        return (RECORD, *(name for name in names if name != RECORD and is_file(self.path, name)))

    def _list(self, names: tuple[str, ...]) -> None:
        """A new list, of a run that may go on elsewhere than the one before it."""
        self._manifest, self._names = Manifest(names=names), set(names)
        manifest.write(self.path, self._manifest)

    @property
    def run(self) -> str:
        """By which manifest.txt identifies the run in the folder; "" where there is none."""
        return self._manifest.run if self._manifest else ""

    @property
    def names(self) -> list[str]:
        """Of files that this run has made."""
        return sorted(self._names)

    def claim(self, *names: str) -> None:
        """Before files are first made. Raises SceneError where the folder is gone or another's file has the name."""
        self._check_here()
        new = [name for name in names if name not in self._names]
        for name in new:
            if not NAME.fullmatch(name):
                raise refuse("name", name, "a name of a run's file")
            self._check_free(name)
        if new:
            try:
                manifest.append(self.path, new)
            except OSError as error:
                raise unwritable(self.path, error) from None
            self._names.update(new)

    def file(self, name: str) -> Path:
        """The path of a file that is to be written now."""
        self.claim(name)
        return self.path / name

    def checkpoint_names(self) -> tuple[str, ...]:
        """Of the files that the next checkpoint makes: the one before it is kept."""
        latest, previous = CHECKPOINTS
        return (latest, previous) if latest in self._names else (latest,)

    def remove(self, names: Iterable[str]) -> None:
        """Remove files that this run has made, and no others."""
        names = [name for name in names if name in self._names]
        manifest.remove(self.path, names)
        self._names.difference_update(names)

    def lost(self, names: Iterable[str]) -> list[str]:
        """Those of the pictures and particle files that are not there any more, or not whole; what is left of them is
        removed."""
        gone = [name for name in names if not (is_file(self.path, name) and whole(self.path / name))]
        self.remove(gone)
        return gone

    def verify(self, unless: Iterable[str] = ()) -> None:
        """Raises SceneError where a file that was written is not there. unless: names that may be missing."""
        self._check_here()
        names = [name for name in self.names if name not in unless]
        gone = [n for n in names if not (is_file(self.path, n) and os.lstat(self.path / n).st_size)]
        if gone:
            raise FolderGone(f"{named(gone)} in {self.path} went missing, or was emptied, during the run")

    def complete(self) -> None:
        """The run is done and all of it is written: the one before it is not needed any more."""
        with contextlib.suppress(OSError, SceneError):  # what stays of it goes after the next run
            remove_aside(self._previous)

    def release(self) -> None:
        """Let others have the folder; one that was made for a run that was refused goes again."""
        self.lock.release()
        if not self.begun:
            self._unmake()

    def _unmake(self) -> None:
        for folder in self._made:
            with contextlib.suppress(OSError):
                folder.rmdir()

    def _check_here(self) -> None:
        try:
            here = os.path.samestat(os.stat(self.path), self._place)
            if self._frames is not None:
                here = here and os.path.samestat(os.lstat(self.path / FRAMES), self._frames)
        except OSError:
            here = False
        if not here:
            raise FolderGone(f"output folder {self.path} was moved, removed or replaced during the run")
        try:
            self.lock.keep()
        except SceneError as error:
            raise FolderGone(str(error)) from None

    def _check_free(self, name: str) -> None:
        """Refuse a name that is not on the list, and has a file."""
        for path in (self.path / name, part_of(self.path / name)):
            if name not in self._names and mode_of(path):
                unknown = "" if self._manifest else f"; without {manifest.FILE} a run's files cannot be told from yours"
                raise SceneError(f"{path} is in the way, no run in its folder has made it: {REMEDY}{unknown}")


def named(names: list[str], most: int = 5) -> str:
    """The first of many names."""
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + more
