"""Ctrl-C, SIGTERM and SIGHUP, turned into wishes that the run heeds: the first to stop, a second to stop waiting.

A third Ctrl-C ends whatever goes on, as Python does it.
"""

import contextlib
import signal
import threading

HEEDED = tuple(getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name))
"""Signals by which a run is asked to stop; Windows has no SIGHUP."""


class Interrupt:
    """The signal by which a run was asked to stop; 0 for none. hurried: it was asked again, and waits for nothing."""

    signal = 0
    hurried = False

    def set(self, number: int) -> None:
        if self.hurried and number == signal.SIGINT:
            raise KeyboardInterrupt
        self.hurried = bool(self.signal)
        self.signal = self.signal or number  # the first says why


@contextlib.contextmanager
def asked_to_stop(interrupt: Interrupt):
    """The signals set it instead of ending the process; only Python's main thread may ask for that.

    One that is ignored already stays so: nohup, and a shell that puts a command in the background, mean it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    heeded = [number for number in HEEDED if signal.getsignal(number) != signal.SIG_IGN]
    old = {number: signal.signal(number, lambda n, _: interrupt.set(n)) for number in heeded}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
