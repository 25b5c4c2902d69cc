"""Whether threads can start: Taichi ends the process, or waits for ever, where one of its own cannot."""

import os
import threading

from rsmpm_ti.errors import SceneError

COMPILERS = 4
"""Threads by which Taichi compiles, beside those that step."""

WRITER = 10
"""Threads of the process that paints and writes, its first one included, and two by which it is listened to; more are
those of BLAS."""

STACK = 256 * 1024
"""Of a thread that is tried [B]. Usual ones take memory, whose lack would be told as one of threads."""

BLAS_MOST = 64
"""What the BLAS in wheels of NumPy and SciPy was built for."""


def cores() -> int:
    return os.cpu_count() or 1


def blas_threads() -> int:
    """Those that NumPy and SciPy start, each its own, when they are imported."""
    said = os.environ.get("OPENBLAS_NUM_THREADS") or os.environ.get("OMP_NUM_THREADS") or ""
    return 2 * (min(int(said) if said.isdigit() else cores(), BLAS_MOST) - 1)


def run_threads(threads: int | None, writes: bool) -> int:
    """All that a run starts, once NumPy and SciPy are there. threads: that step; writes: by a process of its own."""
    return (threads or cores()) + COMPILERS + (WRITER + blas_threads() if writes else 0)


def check_run_threads(threads: int | None, writes: bool) -> None:
    """Raises SceneError where those of a run cannot be started; arguments as of `run_threads`."""
    fewer = "" if threads == 1 else f"; or give less than {threads or cores()} --threads (threads)"
    check_threads(run_threads(threads, writes), fewer)


def startable(most: int) -> int:
    """How many threads can be started now, at most `most`. They are started and end."""
    done, begun = threading.Event(), []
    usual = threading.stack_size(STACK)
    try:
        for _ in range(most):
            thread = threading.Thread(target=done.wait, daemon=True)
            thread.start()
            begun.append(thread)
    except (RuntimeError, MemoryError):  # of processes, or of addresses for a stack
        pass
    finally:
        threading.stack_size(usual)
        done.set()
        for thread in begun:
            thread.join()
    return len(begun)


def check_threads(needed: int, remedy: str = "") -> None:
    """Raises SceneError where so many cannot be started. remedy: beside allowing more."""
    found = startable(needed)
    if found < needed:
        raise SceneError(
            f"{needed} threads are needed, and {found} can be started{_limit()}: allow more, by `ulimit -u` or in the "
            f"limits of the container, or end other processes{remedy}"
        )


def _limit() -> str:
    try:
        import resource

        most = resource.getrlimit(resource.RLIMIT_NPROC)[0]
    except (ImportError, AttributeError, OSError):  # not on every system
        return ""
    return "" if most == resource.RLIM_INFINITY else f" (limit of this user's processes and threads: {most})"
