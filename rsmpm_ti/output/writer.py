"""The solver's end of the process that paints and writes while the solver runs.

A child process, not a fork and not `multiprocessing`: Taichi does not survive a fork, and a user's script that calls
`simulate` has no main guard. Orders are done one after another, so a checkpoint is on disk only when every frame before
it is, and a run can go on from it without a gap.
"""

import contextlib
import json
import pickle
import subprocess
import tempfile
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace

import numpy as np

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output.pictures import Commission
from rsmpm_ti.process import python_command
from rsmpm_ti.solver.readout import Readout

WAITING_BYTES = 512 * 2**20
"""Orders that may wait for the child, which is behind while much fails: each holds a copy of the particles. One order
may be larger."""

CHILD = "from rsmpm_ti.output.writer_process import main; sys.exit(main())"

REPORT = "rsmpm_ti writer: "
"""Begins the line by which the child says how it went; Taichi prints to the same pipe."""


class Writer:
    """Paints and writes the files of one run in a process of its own. `warning`, `cpu_s`: known after `close`."""

    def __init__(self, wanted: Commission):
        """Starts the child, which gets ready while the caller goes on. Raises SceneError where it cannot be started."""
        self.out, self.warning, self.cpu_s = wanted.out, "", 0.0
        try:
            wanted = replace(wanted, out=wanted.out.absolute())
            self._errors = tempfile.TemporaryFile()
            self._child = subprocess.Popen(
                python_command(CHILD),
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors,
                cwd=wanted.out,  # libraries read settings in the current folder, which may be gone besides
                start_new_session=True,  # Ctrl-C is for the solver, which then says what is still to be written
            )  # fmt: skip
        except OSError as error:
            raise SceneError(f"the process that paints and writes cannot be started: {error}") from None
        self._sender = ThreadPoolExecutor(max_workers=1)
        self._pending: list[tuple[int, Future]] = []  # bytes of each order on its way
        self._order("open", wanted)

    def refilm(self, count: int) -> None:
        """The movie begins with so many frames that are there already."""
        self._order("refilm", count)

    def frame(self, number: int, readout: Readout, history: np.ndarray) -> None:
        self._order("frame", number, readout, history)

    def vtu(self, entries: list[tuple[float, str]], readout: Readout, instant: dict[str, float]) -> None:
        """entries: (time [s], file name) of every VTU so far, the last of which is to be written; instant: its field
        data."""
        self._order("vtu", entries, readout, instant)

    def checkpoint(self, arrays: dict[str, np.ndarray]) -> None:
        self._order("checkpoint", arrays)

    def close(self, *last) -> None:
        """Wait for everything, the movie and summary.png last; arguments as of `Gallery.close`."""
        self._order("close", *last)
        self._settle(0)
        self._end()

    def abandon(self) -> None:
        """End the child without finishing the movie; what it has written stays. Never raises."""
        self._sender.shutdown(wait=False, cancel_futures=True)
        self._child.kill()  # which also frees a sender that waits for it to read
        self._child.wait()
        self._sender.shutdown()
        for pipe in filter(None, (self._child.stdin, self._child.stdout, self._errors)):
            with contextlib.suppress(OSError):  # what was not sent cannot be
                pipe.close()

    def _order(self, *order) -> None:
        """Hand an order over, beside the caller; wait while too much is on its way.

        Raises SceneError, with the reason that the child gives, where it has ended.
        """
        message = pickle.dumps(order, protocol=5)
        self._settle(WAITING_BYTES - len(message))
        self._pending.append((len(message), self._sender.submit(self._send, message)))

    def _send(self, message: bytes) -> None:
        assert self._child.stdin is not None
        self._child.stdin.write(message)
        self._child.stdin.flush()

    def _settle(self, most: int) -> None:
        """Wait until at most so many bytes are on their way."""
        while self._pending and (self._pending[0][1].done() or sum(size for size, _ in self._pending) > most):
            try:
                self._pending.pop(0)[1].result()
            except OSError:  # a broken pipe: the child has ended, and `_end` says why
                self._end()

    def _end(self) -> None:
        """Read the child's report; raise SceneError if it did not do everything."""
        self._sender.shutdown(cancel_futures=True)
        self._pending.clear()
        output, _ = self._child.communicate()
        lines = [line for line in output.decode(errors="replace").splitlines() if line.startswith(REPORT)]
        report = json.loads(lines[-1].removeprefix(REPORT)) if lines else {}
        problem = report.get("problem", "") or self._silence()
        self._errors.close()
        if problem:
            raise SceneError(f"{self.out} cannot be written: {problem}")
        self.warning, self.cpu_s = report["warning"], report["cpu_s"]

    def _silence(self) -> str:
        """Why a child that reported nothing has ended; "" if it ended well."""
        if self._child.returncode == 0:
            return ""
        self._errors.seek(0)
        said = [line.strip() for line in self._errors.read().decode(errors="replace").splitlines() if line.strip()]
        reason = f": {said[-1]}" if said else ""
        return f"the process that paints and writes ended with status {self._child.returncode}{reason}"
