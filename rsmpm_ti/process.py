"""This process and the Pythons that it starts: what they see, and what is done where a command's output ends."""

import contextlib
import errno
import functools
import multiprocessing
import multiprocessing.util
import os
import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import ParamSpec, TextIO

from rsmpm_ti.ctrl_c import LINE, as_exception
from rsmpm_ti.errors import SceneError, reason

START = """
import importlib.util, sys
sys.path[:], sys.pycache_prefix = {path}, {prefix}
spec = importlib.util.spec_from_file_location("rsmpm_ti", {init}, submodule_search_locations=[{folder}])
sys.modules["rsmpm_ti"] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(sys.modules["rsmpm_ti"])
"""


def python_command(code: str, *arguments: str) -> list[str]:
    """Command of a Python that runs `code` and sees what this one sees: search path, flags, warnings, this package.

    `python -m`, or a folder in PYTHONPATH, would put the current folder or all installed packages before the standard
    library: somebody's ./json.py would be run. So it starts alone (-I) and is told its path; the current folder, by its
    name or as an empty entry, is left out.
    """
    package = Path(__file__).resolve().parent
    entries = [entry for entry in sys.path[_is_current() :] if isinstance(entry, str) and entry]
    path = [os.path.abspath(entry) if os.path.exists(entry) else entry for entry in entries]
    start = START.format(
        path=ascii(path),
        prefix=ascii(sys.pycache_prefix),
        init=ascii(str(package / "__init__.py")),
        folder=ascii(str(package)),
    )
    return [sys.executable, *_alone_flags(), "-c", start + code, *arguments]


def _alone_flags() -> list[str]:
    """Flags of this Python, of a Python that looks for nothing in the current folder, its home or its variables."""
    flags = subprocess._args_from_interpreter_flags()  # type: ignore[attr-defined]  # as multiprocessing does
    compiled = ["-X", f"pycache_prefix={sys.pycache_prefix}"] if sys.pycache_prefix else []
    return [*flags, "-I", "-X", f"utf8={sys.flags.utf8_mode}", *compiled]


def _is_current() -> bool:
    """Whether the search path begins with the current folder, as `python -m` makes it: with its whole name."""
    try:
        return bool(sys.path) and os.path.samefile(sys.path[0] or ".", ".")
    except (OSError, ValueError, TypeError):
        return False


@contextlib.contextmanager
def no_current_folder() -> Iterator[None]:
    """Within it processes of `multiprocessing` start alone (-I); they are told the search path of this one.

    They run `python -c`, which looks in the current folder first, and a Python 3.10 does so whatever its environment
    says. What keeps count of their semaphores is started in the same way.
    """
    before = multiprocessing.util._args_from_interpreter_flags  # type: ignore[attr-defined]
    multiprocessing.util._args_from_interpreter_flags = _alone_flags  # type: ignore[attr-defined]
    try:
        yield
    finally:
        multiprocessing.util._args_from_interpreter_flags = before  # type: ignore[attr-defined]


def end_with_parent() -> None:
    """Called in a process of `multiprocessing`: it ends where the one that started it has ended, killed or not."""
    parent = multiprocessing.parent_process()

    def follow() -> None:
        if parent is not None:
            parent.join()
            os._exit(1)

    threading.Thread(target=follow, daemon=True).start()


@contextlib.contextmanager
def without_ctrl_c() -> Iterator[None]:
    """Processes of `multiprocessing` that start within it, from this thread or one that it starts, do not hear Ctrl-C:
    who started them does, and ends them."""
    if not hasattr(signal, "pthread_sigmask"):  # Windows
        yield
        return
    from multiprocessing import resource_tracker

    resource_tracker.ensure_running()  # which would let the signal in again
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


Arguments = ParamSpec("Arguments")


def command(main: Callable[Arguments, int]) -> Callable[Arguments, int]:
    """Decorator of a command's main, which gives its exit status: it may have streams that are closed, full or ASCII.

    Closed ones are opened to nowhere, or a file of the run would get their number and all that is printed. A letter
    that cannot be printed is escaped. Ctrl-C is a line and a status. Output that cannot be written does not end what
    the command does; its status is then 2, after a line. That its reader has gone, as `head` does, is no failure.
    """

    @functools.wraps(main)
    def run(*arguments: Arguments.args, **keywords: Arguments.kwargs) -> int:
        _open_streams()
        if sys.stdout is None or isinstance(sys.stdout, Output):  # of a command that runs this one
            return main(*arguments, **keywords)
        output = Output(sys.stdout)
        with _as_stdout(output):
            try:
                with as_exception():
                    status = main(*arguments, **keywords)
            except KeyboardInterrupt:
                tell(LINE)
                status = 128 + signal.SIGINT
            except (SceneError, OSError, MemoryError) as error:
                tell(f"rsmpm_ti: {reason(error) if not isinstance(error, SceneError) else error}{_place(error)}")
                status = 2
            except SystemExit:  # --help, or an option that there is not
                if output.complete():
                    raise
                return 2
        return status if output.complete() else 2

    return run


def _place(error: BaseException) -> str:
    name = getattr(error, "filename", None)
    return f" ({name})" if name else ""


class Output:
    """A stream that raises nothing where it cannot be written, but knows that."""

    def __init__(self, stream: TextIO):
        self.stream, self.error = stream, 0
        with contextlib.suppress(AttributeError):  # of what stands in for a stream
            stream.reconfigure(errors="backslashreplace")  # type: ignore[attr-defined]

    def __getattr__(self, name: str):
        return getattr(self.stream, name)

    def write(self, text: str) -> int:
        self._try(lambda: self.stream.write(text))
        return len(text)

    def flush(self) -> None:
        self._try(self.stream.flush)

    def complete(self) -> bool:
        """Whether everything is written that somebody reads; a line says why not."""
        self.flush()
        if self.error:
            os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python flushes once more when it ends
        if self.error in (0, errno.EPIPE):
            return True
        tell(f"rsmpm_ti: standard output cannot be written: {os.strerror(self.error)}; send it elsewhere")
        return False

    def _try(self, write: Callable[[], object]) -> None:
        try:
            write()
        except OSError as error:
            self.error = error.errno or errno.EIO


@contextlib.contextmanager
def _as_stdout(output: Output) -> Iterator[None]:
    """Taichi takes a standard output that is not the first one for a notebook's: it says so, and kernels get slower."""
    now, first = sys.stdout, sys.__stdout__
    sys.stdout = output  # it does what a stream does
    if first is now:
        sys.__stdout__ = output  # type: ignore[misc, assignment]
    try:
        yield
    finally:
        sys.stdout, sys.__stdout__ = now, first  # type: ignore[misc]


def tell(line: str) -> None:
    """A line on standard error, which ends nothing where it cannot be written."""
    if sys.stderr is not None:
        with contextlib.suppress(OSError):
            print(line, file=sys.stderr, flush=True)


def _open_streams() -> None:
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.open(os.devnull, os.O_RDWR)  # the lowest number that is free
