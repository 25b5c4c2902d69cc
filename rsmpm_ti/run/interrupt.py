"""Ctrl-C and SIGTERM, turned into a wish that the run loop heeds after the step."""

import contextlib
import signal
import threading


@contextlib.contextmanager
def asked_to_stop(event: threading.Event):
    """Ctrl-C and SIGTERM set the event instead of ending the process; only Python's main thread may ask for that."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    old = {number: signal.signal(number, lambda *_: event.set()) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, handler in old.items():
            signal.signal(number, handler)
