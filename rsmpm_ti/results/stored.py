"""The folder of a run that is done, read as a stranger's: regular files of its own list, of a bounded size."""

import os
import stat
from pathlib import Path

from rsmpm_ti.errors import SceneError, reason, refuse
from rsmpm_ti.output import manifest
from rsmpm_ti.output.manifest import is_file


class Stored:
    """path: of the folder; run: by which its list of files identifies the run; names: on that list."""

    def __init__(self, path: Path):
        """Raises SceneError where there is no run."""
        self.path = path
        try:
            found = manifest.read(path)
        except (OSError, ValueError) as error:  # ValueError: a name that no folder can have, or a SceneError
            raise error if isinstance(error, SceneError) else refuse("folder", str(path), "of a run") from None
        if found is None:
            raise refuse("folder", str(path), "of a run", f"there is no {manifest.FILE}")
        self.run = found.run
        self.names = [name for name in found.names if is_file(path, name)]

    def bytes(self, name: str, most: int) -> bytes:
        """What a file holds. Raises SceneError for one that cannot be read, or has more bytes than `most`."""
        path = self.path / name
        if name not in self.names or not is_file(self.path, name):
            raise SceneError(f"{path} is not there")
        not_beyond = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)
        try:
            with open(os.open(path, os.O_RDONLY | not_beyond), "rb") as file:
                data = file.read(most + 1) if stat.S_ISREG(os.fstat(file.fileno()).st_mode) else None
        except OSError as error:
            raise SceneError(f"{path} cannot be read: {reason(error)}") from None
        if data is None or len(data) > most:
            raise SceneError(f"{path} is no regular file of at most {most >> 20} MiB")
        return data


def stored(out: Path | None, run: str) -> Stored:
    """The folder of a result. Raises SceneError where nothing was written, or the folder is of another run by now."""
    if out is None:
        raise SceneError("the run was not written, so it has no pictures; give simulate a folder, out=...")
    folder = Stored(out)
    if folder.run != run:
        raise SceneError(f"{out} holds another run by now; load_result reads the one that is there")
    return folder
