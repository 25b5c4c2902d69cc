"""The folder of a run: made ready before anything is computed, and filled with tables when the run has ended."""

import errno
import os
from collections.abc import Callable
from pathlib import Path

from rsmpm_ti import __version__
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.scene import Scene


def prepare(scene: Scene, out: str | os.PathLike, *, keep: bool = False) -> Path:
    """Make the folder now, so that one that cannot be written costs no computing; check the painter likewise.

    keep: leave the pictures of the run that is to go on; else an earlier run's are removed, since a shorter run must
    not leave the frames of a longer one behind. Raises SceneError.
    """
    if scene.output.painter == "ggui" and scene.output.frames:
        from rsmpm_ti.paint.ggui import probe

        usable, reason = probe()
        if not usable:
            raise refuse("output.painter", "ggui", "raster on this machine", reason)
    out = Path(out)
    try:
        (out / "frames").mkdir(parents=True, exist_ok=True)
        probe_file = out / ".writable"
        probe_file.write_bytes(bytes(4096))  # an empty file is made on a full disk too
        probe_file.unlink()
        for part in (*out.glob(".*.part*"), *out.glob("frames/.*.part*")):  # of a run that was killed
            part.unlink()
        if not keep:
            for pattern in ("frames/*_[0-9]*.png", "particles_[0-9]*.vtu"):
                forget(out, pattern, keep=0)
            for old in out.glob("checkpoint*.npz"):
                old.unlink()
    except (OSError, ValueError) as error:  # ValueError: a name that no file can have
        raise _unwritable(out, error) from None
    return out


def _unwritable(out: Path, error: Exception) -> SceneError:
    reason = getattr(error, "strerror", None) or error
    return SceneError(f"output folder {out} cannot be written: {reason}; {room(error)}give another with --out")


def room(error: Exception) -> str:
    """The remedy of a disk or a quota that is full, and of nothing else."""
    full = [os.strerror(number) for number in (errno.ENOSPC, errno.EDQUOT)]
    return "make room, or " if any(reason in str(error) for reason in full) else ""


def forget(out: Path, pattern: str, *, keep: int) -> None:
    """Remove numbered files, such as frames, from number `keep` on."""
    for path in out.glob(pattern):
        if int(path.stem.rpartition("_")[2]) >= keep:
            path.unlink()


def write_record(out: Path, scene: Scene, name: str, precision: str) -> None:
    """scene.json: what was run, by what, on what. Raises SceneError where it cannot be written."""
    from rsmpm_ti.records.files import write_json
    from rsmpm_ti.spec.loader import machine
    from rsmpm_ti.spec.scene_json import to_plain

    seeds = [getattr(body.seeding, "seed", None) for body in scene.bodies]
    record = {
        "rsmpm_ti": __version__, "name": name, "precision": precision, "seeds": seeds, "machine": machine(),
        "time_scale": scene.time_scale, "scene": to_plain(scene),
    }  # fmt: skip
    try:
        write_json(out / "scene.json", record)
    except OSError as error:
        raise _unwritable(out, error) from None


def write_all(writes: list[Callable[[], None]]) -> None:
    """Do every write, also after one has failed, so that what can be kept is; then raise SceneError for the first."""
    problem, remedy = None, ""
    for write in writes:
        try:
            write()
        except SceneError as error:
            remedy, problem = remedy or room(error), problem or error
        except OSError as error:
            remedy = remedy or room(error)
            problem = problem or SceneError(f"{error.filename or 'a file'} cannot be written: {error.strerror}")
    if problem is not None:
        raise SceneError(
            f"{problem}; what is complete is kept: {remedy.replace(', or', ' and')}go on with --resume"
        ) from None
