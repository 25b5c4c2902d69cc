"""One run at a time in a folder: a lock that the system drops with the processes that hold it, so it is never stale.

The process that paints holds it too: where the solver is killed, the folder is free when both have ended. Written with
`fcntl` and not with `filelock`: that one can neither be handed to a child nor say who holds it.
"""

import contextlib
import errno
import os
import re
import stat
import time
from pathlib import Path
from typing import Any

from rsmpm_ti.errors import SceneError, refuse

fcntl: Any
try:
    import fcntl
except ImportError:  # not on every system: there the file itself is the lock, and stays after a kill
    fcntl = None

FILE = ".rsmpm_ti.lock"
NOT_BEYOND = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)
"""Of opening what a stranger may have put there: no link is followed, no pipe waited for."""

GRACE_S, POLL_S = 30.0, 0.05
"""How long the painter of a run that was killed may take to end what it was at, and how often to look."""


class Lock:
    """Takes the lock of a folder on being made; every process that writes there is to hold it."""

    def __init__(self, folder: Path):
        """Raises SceneError where another run has it, and says which."""
        self._folder, self._path = folder, folder / FILE
        patience = time.monotonic() + GRACE_S
        while True:
            descriptor = self._take()
            if descriptor is not None:
                self.descriptor = descriptor
                break
            process, since = self._holder()
            if _lives(process) or time.monotonic() > patience:
                raise self._held(process, since)
            time.sleep(POLL_S)
        self._line = f"process {os.getpid()} since {time.strftime('%Y-%m-%d %H:%M:%S')}\n".encode()
        try:
            os.write(self.descriptor, self._line)
        except OSError:  # a full disk
            self.release()
            raise

    @property
    def passed(self) -> tuple[int, ...]:
        """Descriptors that a child process is to be given."""
        return () if fcntl is None else (self.descriptor,)

    def keep(self) -> None:
        """To be called before something is written: puts the lock's file back where it was removed and nobody has taken
        the folder since; else raises SceneError. The painter goes on holding the one before, and looks at the name in
        the new one."""
        if self._is(self.descriptor):
            return
        descriptor = None
        try:
            descriptor, made = self._open()
            if fcntl is not None:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
            if os.read(descriptor, 100) != (b"" if made else self._line) or not self._is(descriptor):
                raise FileExistsError
        except OSError:
            if descriptor is not None:
                os.close(descriptor)
            raise self._lost() from None
        with contextlib.suppress(OSError):  # a full disk: it is locked, if it does not say by whom
            os.pwrite(descriptor, self._line, 0)
        os.close(self.descriptor)
        self.descriptor = descriptor

    def _lost(self) -> SceneError:
        process, since = self._holder()
        who = f"process {process} has the folder since {since}" if process else "something else has its place"
        return SceneError(
            f"the lock {FILE} of {self._folder} was removed during the run, and {who}: nothing more is written there"
        )

    def _open(self) -> tuple[int, bool]:
        """A descriptor of the lock's file, and whether it was made here. Raises FileExistsError for what is no lock."""
        with contextlib.suppress(FileExistsError):
            return os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_EXCL | NOT_BEYOND, 0o644), True
        found = os.lstat(self._path)
        # a second name of it is that of a file of somebody else; nothing but a file is so much as opened
        if fcntl is None or not stat.S_ISREG(found.st_mode) or found.st_nlink != 1:
            raise FileExistsError
        return os.open(self._path, os.O_RDWR | NOT_BEYOND), False

    def _take(self) -> int | None:
        """A descriptor of a new file that is locked; None while another process has it."""
        while True:
            try:
                descriptor, made = self._open()
            except FileNotFoundError:  # removed in between
                if not self._folder.is_dir():
                    raise
                continue
            except FileExistsError:
                if fcntl is None:
                    return None
                raise self._foreign() from None
            except OSError as error:
                if error.errno == errno.ELOOP:
                    raise self._foreign() from None
                raise
            if fcntl is None:
                return descriptor
            try:
                fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
                if self._is(descriptor):
                    if made:
                        return descriptor
                    if os.fstat(descriptor).st_size > 0 and self._holder()[0] == 0:
                        raise self._foreign()
                    self._path.unlink()  # of a run that was killed, before it could write into it or later
            except BlockingIOError:
                os.close(descriptor)
                return None
            except BaseException:
                os.close(descriptor)
                raise
            os.close(descriptor)

    def _is(self, descriptor: int) -> bool:
        """Whether the file under the lock's name is the one that is open; the holder before may have removed it."""
        try:
            return os.path.samestat(os.fstat(descriptor), os.lstat(self._path))
        except FileNotFoundError:
            return False

    def _holder(self) -> tuple[int, str]:
        return holder(self._folder)

    def _foreign(self) -> SceneError:
        return SceneError(f"{self._path} is no lock of a run; move it away, or give another folder with --out")

    def _held(self, process: int, since: str) -> SceneError:
        who = f"process {process} has since {since}" if process else "another process has"
        remedy = f"wait for it, or give another folder (--out); {who} the lock {FILE}"
        if fcntl is None:
            remedy += "; remove that file if the process is no more"
        return refuse("out", str(self._folder), "a folder into which no other run writes", remedy)

    def release(self) -> None:
        """Never raises; the lock's file goes too, unless the folder is another by now."""
        try:
            if self._is(self.descriptor):
                self._path.unlink()
            os.close(self.descriptor)
        except OSError:
            pass

    def __enter__(self) -> "Lock":
        return self

    def __exit__(self, *_) -> None:
        self.release()


def holder(folder: Path) -> tuple[int, str]:
    """Process and start of who made the lock of a folder; 0 where its file is not there, or does not say."""
    try:
        with open(os.open(folder / FILE, os.O_RDONLY | NOT_BEYOND), "rb") as file:
            words = re.match(rb"process (\d{1,9}) since ([0-9: -]{19})\n", file.read(100) or b"")
    except OSError:
        words = None
    return (0, "") if words is None else (int(words[1]), words[2].decode())


def _lives(process: int) -> bool:
    """Whether a process is there; taken for granted where that cannot be asked."""
    if fcntl is None or process == 0:
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
