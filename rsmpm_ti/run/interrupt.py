"""Ctrl-C and SIGTERM, turned into a wish that the run loop heeds after the step."""

import contextlib
import signal
import threading


class Interrupt:
    """The signal by which a run was asked to stop; 0 for none."""

    signal = 0

    def set(self, number: int) -> None:
        self.signal = self.signal or number  # the first says why


@contextlib.contextmanager
def asked_to_stop(interrupt: Interrupt):
    """Ctrl-C and SIGTERM set it instead of ending the process; only Python's main thread may ask for that."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    old = {number: signal.signal(number, lambda n, _: interrupt.set(n)) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
