"""Scenes whose parts are not held to each other for a while: by whoever changes more than one of them."""

import contextlib
from contextvars import ContextVar

UNCHECKED = ContextVar("UNCHECKED", default=False)


@contextlib.contextmanager
def unchecked():
    """Within it the parts of a scene are not held to each other: whoever changes more of them builds it again after."""
    token = UNCHECKED.set(True)
    try:
        yield
    finally:
        UNCHECKED.reset(token)
