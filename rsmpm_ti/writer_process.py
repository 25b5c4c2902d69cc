"""python -m rsmpm_ti.writer_process: paints and writes what a solver orders through standard input; see writer.py."""

import json
import os
import pickle
import sys
import time

from rsmpm_ti.output import write_checkpoint, write_pvd, write_vtu
from rsmpm_ti.run import start_taichi
from rsmpm_ti.writer import REPORT

NICENESS = 10
"""The solver goes first; painting takes the time that its threads leave."""


class Desk:
    """Does orders one after another; their names are its methods."""

    gallery = None

    def open(self, wanted) -> None:
        from rsmpm_ti.gallery import Gallery

        self.out = wanted.out
        start_taichi("f64", "cpu", 1)
        self.gallery = Gallery(wanted)

    def refilm(self, count: int) -> None:
        self.gallery.refilm(count)

    def frame(self, number: int, snapshot, history) -> None:
        self.gallery.frame(number, snapshot, history)

    def vtu(self, entries, snapshot) -> None:
        write_vtu(self.out / entries[-1][1], snapshot)
        write_pvd(self.out / "particles.pvd", entries)

    def checkpoint(self, arrays) -> None:
        write_checkpoint(self.out, arrays)

    def close(self, *last) -> None:
        self.gallery.close(*last)


def main() -> int:
    """Status 0 when closed or when the solver is gone, 1 with a report of the problem otherwise."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    desk, problem, order = Desk(), "", ("",)
    while order[0] != "close" and not problem:
        try:
            order = pickle.load(sys.stdin.buffer)
        except (EOFError, pickle.UnpicklingError):  # the solver was killed: what is complete stays, without a movie
            return 0
        try:
            getattr(desk, order[0])(*order[1:])
        except Exception as error:  # whatever it is, the solver must hear of it in one line
            problem = (getattr(error, "strerror", None) or f"{type(error).__name__}: {error}") + _file(error)
    if problem and desk.gallery is not None:
        desk.gallery.discard()
    warning = "" if problem else desk.gallery.warning
    print(REPORT + json.dumps({"problem": problem, "warning": warning, "cpu_s": time.process_time()}), flush=True)
    return 1 if problem else 0


def _file(error: Exception) -> str:
    name = getattr(error, "filename", None)
    return f" ({name})" if name else ""


if __name__ == "__main__":
    sys.exit(main())
