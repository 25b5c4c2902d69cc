"""Ctrl-C before a command's main is under way, and after it is done: a line and status 130, and no traceback.

The first thing that a command imports, so it imports next to nothing itself.
"""

import contextlib
import os
import signal
import sys
from collections.abc import Iterator

LINE = "rsmpm_ti: stopped by Ctrl-C; what is complete is kept"


def module_of(words: list[str]) -> str:
    """The module that Python is asked to run by the words of its command line, without its own name; "" if none is.

    Its options end where the program or its module is named, and may be joined: `-um rsmpm_ti.scene`, `-mrsmpm_ti`.
    """
    rest = iter(words)
    for word in rest:
        if not word.startswith("-") or word == "-":
            return ""
        for k, letter in enumerate(word[1:], start=2):
            if word == "--check-hash-based-pycs" or letter in "WX" and not word[k:]:
                next(rest, "")  # what it is given
            if letter == "m":
                return word[k:] or next(rest, "")
            if letter == "c":
                return ""
            if letter in "WX-":
                break
    return ""


def _leave(*_) -> None:
    """There is nothing to tidy up, and an exception may be lost in what is imported."""
    if sys.stderr is not None:
        with contextlib.suppress(OSError, RuntimeError):  # it is closed, or being written to
            print(LINE, file=sys.stderr, flush=True)
    os._exit(128 + signal.SIGINT)


def leave_in_a_line() -> None:
    """From now on, unless Ctrl-C is ignored, or this is not the thread that may ask."""
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        with contextlib.suppress(ValueError):
            signal.signal(signal.SIGINT, _leave)


@contextlib.contextmanager
def as_exception() -> Iterator[None]:
    """Within it Ctrl-C is KeyboardInterrupt again: there is something to tidy up.

    What a library makes of that is one again on leaving: of a module in C that is being imported, an ImportError.
    """
    ours, came = signal.getsignal(signal.SIGINT) is _leave, []

    def interrupt(*_) -> None:
        came.append(True)
        raise KeyboardInterrupt

    if ours:
        signal.signal(signal.SIGINT, interrupt)
    try:
        yield
    except Exception as error:
        if came:
            raise KeyboardInterrupt from error
        raise
    finally:
        if ours:
            signal.signal(signal.SIGINT, _leave)
