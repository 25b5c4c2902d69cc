"""The solver's end of the process that paints and writes while the solver runs.

It may be killed, stopped, or starved of memory, disk or descriptors at any moment, and so may the encoder, a process of
its own. The first such problem is kept for whoever asks (`check`); later orders are dropped, so that those who give
them need not know. And nobody waits for ever: it gives a sign of life every second (`writer_process.py`), and without
one for `PATIENCE` it is ended.

A child process, not a fork and not `multiprocessing`: Taichi does not survive a fork, and a user's script that calls
`simulate` has no main guard. Orders are done one after another, so a checkpoint is on disk only when every frame before
it is, and a run can go on from it without a gap.
"""

import contextlib
import json
import os
import pickle
import signal
import subprocess
import tempfile
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor

import numpy as np

from rsmpm_ti.errors import SceneError
from rsmpm_ti.output.files import COLLECTION, frame_name
from rsmpm_ti.output.folder import RunFolder
from rsmpm_ti.output.pictures import Commission
from rsmpm_ti.process import python_command
from rsmpm_ti.solver.readout import Readout

WAITING_BYTES = 512 * 2**20
"""Orders that may wait for the child, which is behind while much fails: each holds a copy of the particles. One order
may be larger."""

CHILD = "from rsmpm_ti.output.writer_process import main; sys.exit(main())"

REPORT, READY, ALIVE = "rsmpm_ti writer: ", "rsmpm_ti writer is ready", "rsmpm_ti writer is alive"
"""The line by which the child says how it went begins with the first; it is up by the second; the third is a sign of
life. Taichi prints to the same pipe."""

PATIENCE = 45.0
"""Seconds without a sign of life after which the child counts as stuck, while it is waited for. Its longest silence,
compiling its kernels beside a busy solver, is a few."""


class Writer:
    """Paints and writes the files of one run in a process of its own. `warning`, `cpu_s`: known after `close`."""

    def __init__(self, wanted: Commission, folder: RunFolder, hurried: Callable[[], bool] = lambda: False):
        """Starts the child, which gets ready while the caller goes on. Raises SceneError where it cannot be started.

        hurried: whether whoever waits for the child wants to wait no longer.
        """
        self.out, self.folder, self.warning, self.cpu_s, self.problem = wanted.out, folder, "", 0.0, ""
        self._kinds, self._movie = wanted.kinds, (f"{wanted.name}.mp4",) if wanted.movie else ()
        self._hurried = hurried
        try:
            self._errors = tempfile.TemporaryFile()
            self._child = subprocess.Popen(
                python_command(CHILD),
                stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=self._errors,
                cwd=os.path.abspath(os.sep),  # libraries read settings in the current folder, which may be gone besides
                start_new_session=True,  # Ctrl-C is for the solver, which then says what is still to be written
                pass_fds=folder.lock.passed,
            )  # fmt: skip
        except OSError as error:
            raise SceneError(f"the process that paints and writes cannot be started: {error}") from None
        self._report: dict = {}
        self._ready = False
        self._heard = time.monotonic()
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._sender = ThreadPoolExecutor(max_workers=1)
        self._pending: list[tuple[int, Future]] = []  # bytes of each order on its way
        try:
            self._listener.start()
            self._order("open", wanted)
        except RuntimeError as error:  # no more threads or processes are allowed
            self.abandon()
            raise SceneError(f"the process that paints and writes cannot be used: {error}") from None

    def ready(self) -> None:
        """Wait until the child is up. Raises as `check`."""
        self._wait(lambda: self._ready or self._child.poll() is not None)
        if not self._ready:
            self._end()
        self.check()

    def refilm(self, numbers: list[int]) -> None:
        """The movie begins with these frames, which are there already."""
        if numbers:
            self._claim(*self._movie)
            self._order("refilm", numbers)

    def frame(self, number: int, readout: Readout, history: np.ndarray) -> None:
        self._claim(*(frame_name(kind, number) for kind in self._kinds), *self._movie)
        self._order("frame", number, readout, history)

    def vtu(self, entries: list[tuple[float, str]], readout: Readout, instant: dict[str, float]) -> None:
        """entries: (time [s], file name) of every VTU so far, the last of which is to be written; instant: its field
        data."""
        self._claim(entries[-1][1], COLLECTION)
        self._order("vtu", entries, readout, instant)

    def collect(self, entries: list[tuple[float, str]]) -> None:
        """particles.pvd again, of these VTU files."""
        self._claim(COLLECTION)
        self._order("collect", entries)

    def checkpoint(self, arrays: dict[str, np.ndarray]) -> None:
        self._claim(*self.folder.checkpoint_names())
        self._order("checkpoint", arrays)

    def close(self, *last) -> None:
        """Wait for everything, the movie and summary.png last; arguments as of `Gallery.close`. Raises as `check`."""
        self._claim("summary.png")
        self._order("close", *last)
        self._wait(lambda: self._child.poll() is not None)
        self._end()
        self.check()

    def check(self) -> None:
        """Raise SceneError where something could not be done, with the reason that the child gave."""
        if self.problem:
            raise SceneError(f"{self.out} cannot be written: {self.problem}")

    def abandon(self) -> None:
        """End the child without finishing the movie; what it has written stays. Never raises."""
        self._sender.shutdown(wait=False, cancel_futures=True)
        self._kill()
        self._sender.shutdown()
        for pipe in filter(None, (self._child.stdin, self._child.stdout, self._errors)):
            with contextlib.suppress(OSError):  # what was not sent cannot be
                pipe.close()

    def _claim(self, *names: str) -> None:
        """Before the order for files; none of theirs is made after a problem."""
        if not self.problem:
            self.folder.claim(*names)

    def _order(self, *order) -> None:
        """Hand an order over, beside the caller; wait while too much is on its way. After a problem: nothing."""
        if self.problem:
            return
        message = pickle.dumps(order, protocol=5)
        self._wait(lambda: self._on_the_way() + len(message) <= WAITING_BYTES or not self._pending)
        if not self.problem:
            try:
                self._pending.append((len(message), self._sender.submit(self._send, message)))
            except RuntimeError as error:  # this process is ending: a run in a thread beside it
                self._give_up(f"nothing can be handed to the process that paints and writes: {error}")

    def _send(self, message: bytes) -> None:
        assert self._child.stdin is not None
        self._child.stdin.write(message)
        self._child.stdin.flush()

    def _on_the_way(self) -> int:
        """Bytes of orders that the child has not taken. Ends the child's account where one cannot be sent."""
        while self._pending and self._pending[0][1].done():
            if self._pending.pop(0)[1].exception() is not None:  # a broken pipe: the child has ended or is about to
                self._wait(lambda: self._child.poll() is not None)
                self._end()
        return sum(size for size, _ in self._pending)

    def _wait(self, done: Callable[[], bool]) -> None:
        """Until done, or there is a problem: the child is stuck, or whoever waits is in a hurry."""
        while not self.problem and not done():
            if self._hurried():
                self._give_up("given up at a second signal")
            elif time.monotonic() - self._heard > PATIENCE:
                self._give_up(f"the process that paints and writes gave no sign of life for {PATIENCE:g} s")
            time.sleep(0.01)

    def _listen(self) -> None:
        """Signs of life and the report, until the child's end."""
        assert self._child.stdout is not None
        with contextlib.suppress(OSError, ValueError):  # closed by `abandon`
            for line in self._child.stdout:
                self._heard = time.monotonic()
                self._ready = self._ready or line.startswith(READY.encode())
                if line.startswith(REPORT.encode()):
                    self._report = json.loads(line[len(REPORT) :])

    def _end(self) -> None:
        """The child has ended: read its report."""
        if self.problem:
            return
        self._kill()  # an encoder that has outlived it
        self._listener.join(PATIENCE)
        problem = self._report.get("problem", "") if self._report else self._silence()
        if problem:
            self._give_up(problem)
        else:
            self.warning, self.cpu_s = self._report["warning"], self._report["cpu_s"]
            self.abandon()

    def _give_up(self, problem: str) -> None:
        self.problem = problem
        self._pending.clear()
        self.abandon()

    def _kill(self) -> None:
        """The child and what it has started, which are a session of their own."""
        with contextlib.suppress(OSError):
            if hasattr(os, "killpg"):
                os.killpg(self._child.pid, signal.SIGKILL)
        self._child.kill()  # which also frees a sender that waits for it to read
        self._child.wait()

    def _silence(self) -> str:
        """Why a child that reported nothing has ended."""
        self._errors.seek(0)
        said = [line.strip() for line in self._errors.read().decode(errors="replace").splitlines() if line.strip()]
        reason = f": {said[-1]}" if said else ""
        return f"the process that paints and writes ended with status {self._child.returncode}{reason}"
