"""The process that paints and writes what a solver orders by standard input; see writer.py, which starts it."""

import json
import os
import pickle
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from typing import Any

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.output.files import write_checkpoint, write_pvd, write_vtu
from rsmpm_ti.output.writer import REPORT

NICENESS = 10
"""The solver goes first; painting takes the time that its threads leave."""

WAITING = 4
"""Painted frames, VTU files and checkpoints that may wait for the thread that writes them."""


class Desk:
    """Does orders; their names are its methods. Compressing and encoding go on beside painting, in order."""

    def __init__(self):
        self.gallery: Any = None  # until the order to open has come
        self._files, self._pending = ThreadPoolExecutor(max_workers=1), []

    def open(self, wanted) -> None:
        from rsmpm_ti.output.gallery import Gallery

        self.out = wanted.out
        start_taichi("f64", "cpu", 1)
        self.gallery = Gallery(wanted)

    def refilm(self, count: int) -> None:
        self._later(self.gallery.refilm, count)

    def frame(self, number: int, readout, history) -> None:
        self._later(self.gallery.write, number, self.gallery.paint(number, readout.snapshot(), history))

    def vtu(self, entries, readout, instant) -> None:
        self._later(write_vtu, self.out / entries[-1][1], readout.snapshot(), instant)
        self._later(write_pvd, self.out / "particles.pvd", entries)

    def checkpoint(self, arrays) -> None:
        self._later(write_checkpoint, self.out, arrays)

    def close(self, *last) -> None:
        self._settle(0)
        self.gallery.close(*last)

    def stop(self) -> None:
        """Drop what waits: after a problem, nothing may be written that comes after a gap."""
        self._files.shutdown(cancel_futures=True)

    def _later(self, work, *arguments) -> None:
        self._settle(WAITING - 1)
        self._pending.append(self._files.submit(work, *arguments))

    def _settle(self, most: int) -> None:
        while len(self._pending) > most:
            self._pending.pop(0).result()


def main() -> int:
    """Status 0 when closed or when the solver is gone, 1 with a report of the problem otherwise."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    os.environ["MPLBACKEND"] = "agg"  # matplotlib does not bear the name of one that is not there
    desk, problem, order = Desk(), "", ("",)
    while order[0] != "close" and not problem:
        try:
            order = pickle.load(sys.stdin.buffer)
        except (EOFError, pickle.UnpicklingError):
            # The solver was killed. What is complete stays; what waits is dropped, for the run may go on at once.
            os._exit(0)
        try:
            getattr(desk, order[0])(*order[1:])
        except Exception as error:  # whatever it is, the solver must hear of it in one line
            desk.stop()
            problem = (getattr(error, "strerror", None) or f"{type(error).__name__}: {error}") + _file(error)
    if problem and desk.gallery is not None:
        desk.gallery.discard()
    warning = "" if problem else desk.gallery.warning
    print(REPORT + json.dumps({"problem": problem, "warning": warning, "cpu_s": time.process_time()}), flush=True)
    return 1 if problem else 0


def _file(error: Exception) -> str:
    name = getattr(error, "filename", None)
    return f" ({name})" if name else ""
