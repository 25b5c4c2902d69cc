"""Whether this process is the fork of one in which Taichi ran: its threads are gone, and it would wait for them.

Imported with the package, before anything else of it, so that a fork after that is seen; it imports nothing itself.
"""

import os
import sys

_marked = False


def runtime():
    """Of a Taichi that has been started in this process; else None."""
    ti = sys.modules.get("taichi")
    found = ti.lang.impl.get_runtime() if hasattr(ti, "lang") else None
    return None if getattr(found, "prog", None) is None else found


def is_fork() -> bool:
    """Also of a fork before this package was imported, where the system tells how many threads there are."""
    found = runtime()
    if _marked or found is None:
        return _marked
    config = found.prog.config()  # which counts its own threads; on a GPU it has others
    if config.arch != sys.modules["taichi"].cpu:
        return False
    try:
        return len(os.listdir("/proc/self/task")) < 1 + config.cpu_max_num_threads + config.num_compile_threads
    except OSError:
        return False


def _mark() -> None:
    global _marked
    _marked = _marked or runtime() is not None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_mark)
