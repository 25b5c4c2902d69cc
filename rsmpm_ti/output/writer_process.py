"""The process that paints and writes what a solver orders by standard input; see writer.py, which starts it."""

import contextlib
import errno
import json
import os
import pickle
import signal
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.output.files import COLLECTION, write_checkpoint, write_pvd, write_vtu
from rsmpm_ti.output.lock import holder
from rsmpm_ti.output.manifest import FRAMES
from rsmpm_ti.output.writer import ALIVE, READY, REPORT

NICENESS = 10
"""The solver goes first; painting takes the time that its threads leave."""

WAITING = 8
"""Painted frames, VTU files and checkpoints that may wait for the thread that writes them."""

NOBODY = (0, "")
"""Of a lock that was removed: the solver puts it back, or ends."""

SIGN_S = 1.0
"""Seconds between two signs of life, which say that this process is neither stopped nor starved."""


class Desk:
    """Does orders; their names are its methods. Compressing and encoding go on beside painting, in order."""

    def __init__(self):
        self.gallery: Any = None  # until the order to open has come
        self._files, self._pending = ThreadPoolExecutor(max_workers=1), []
        self._places: dict = {}  # folders by name, when they were first written into

    def open(self, wanted) -> None:
        from rsmpm_ti.output.gallery import Gallery

        self.out, self._holder = wanted.out, holder(wanted.out)
        start_taichi("f64", "cpu", 1)
        self.gallery = Gallery(wanted)
        print(READY, flush=True)

    def refilm(self, numbers: list[int]) -> None:
        self._later(self.gallery.refilm, numbers)

    def frame(self, number: int, readout, history) -> None:
        snapshot = readout.snapshot()
        images = self.gallery.paint(number, snapshot, history)
        for kind, image in images.items():
            self._later(self.gallery.write, kind, number, image, snapshot.time)
        self._later(self.gallery.film, images["stress"], images["cracks"])

    def vtu(self, entries, readout, instant) -> None:
        self._later(write_vtu, self.out / entries[-1][1], readout.snapshot(), instant)
        self.collect(entries)

    def collect(self, entries) -> None:
        self._later(write_pvd, self.out / COLLECTION, entries)

    def checkpoint(self, arrays) -> None:
        self._later(write_checkpoint, self.out, arrays)

    def close(self, *last) -> None:
        self._settle(0)
        self._here(self.gallery.close, *last)

    def stop(self) -> None:
        """Drop what waits: after a problem, nothing may be written that comes after a gap."""
        self._files.shutdown(cancel_futures=True)

    def _later(self, work, *arguments) -> None:
        self._settle(WAITING - 1)
        self._pending.append(self._files.submit(self._here, work, *arguments))

    def _here(self, work, *arguments) -> None:
        """Nothing is written into what has taken the place of the run's folder."""
        for folder in (self.out, self.out / FRAMES):
            found = os.lstat(folder)
            if self._places.setdefault(folder, (found.st_dev, found.st_ino)) != (found.st_dev, found.st_ino):
                raise OSError(errno.ESTALE, "it was moved, removed or replaced during the run", str(folder))
        if holder(self.out) not in (self._holder, NOBODY):
            raise OSError(errno.ESTALE, "its lock was removed during the run, and another has it", str(self.out))
        work(*arguments)

    def _settle(self, most: int) -> None:
        while len(self._pending) > most:
            self._pending.pop(0).result()


def main() -> int:
    """Status 0 when closed or when the solver is gone, 1 with a report of the problem otherwise."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    threading.Thread(target=_live, daemon=True).start()
    os.environ["MPLBACKEND"] = "agg"  # matplotlib does not bear the name of one that is not there
    desk, problem, order = Desk(), "", ("",)
    while order[0] != "close" and not problem:
        try:
            order = pickle.load(sys.stdin.buffer)
        except (EOFError, pickle.UnpicklingError):
            # The solver was killed. What is complete stays; what waits is dropped, for the run may go on at once.
            _vanish()
        try:
            getattr(desk, order[0])(*order[1:])
        except BaseException as error:  # whatever it is, the solver must hear of it in one line
            desk.stop()
            problem = (getattr(error, "strerror", None) or f"{type(error).__name__}: {error}") + _file(error)
    if problem and desk.gallery is not None:
        desk.gallery.discard()
    warning = "" if problem else desk.gallery.warning
    print(REPORT + json.dumps({"problem": problem, "warning": warning, "cpu_s": time.process_time()}), flush=True)
    return 1 if problem else 0


def _live() -> None:
    """Until the solver, or this process, is gone."""
    with contextlib.suppress(OSError, ValueError):
        while True:
            print(ALIVE, flush=True)
            time.sleep(SIGN_S)


def _vanish() -> None:
    """Leave at once, and take the encoder along. Never returns."""
    if hasattr(os, "killpg") and os.getpgrp() == os.getpid():  # else the group is that of whoever started it
        os.killpg(0, signal.SIGKILL)
    os._exit(0)


def _file(error: BaseException) -> str:
    name = getattr(error, "filename", None)
    return f" ({name})" if name else ""
