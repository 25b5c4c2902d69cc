"""One run at a time in a process: Taichi has one set of fields, and a second run would take the first one's away."""

import functools
import threading
from collections.abc import Callable
from typing import ParamSpec, TypeVar

from rsmpm_ti.backend.start import check_process
from rsmpm_ti.errors import SceneError

Arguments = ParamSpec("Arguments")
Outcome = TypeVar("Outcome")

_under_way = threading.Lock()


def alone(run: Callable[Arguments, Outcome]) -> Callable[Arguments, Outcome]:
    """Decorator: refuses before anything else is done where a run is under way, in another thread or as the caller of
    an observer, a column or `progress`, and where Taichi cannot be started."""

    @functools.wraps(run)
    def guarded(*arguments: Arguments.args, **keywords: Arguments.kwargs) -> Outcome:
        check_process()
        if not threading.main_thread().is_alive():
            raise SceneError("this process is ending, and no run can begin in it: wait for the run before it ends")
        if not _under_way.acquire(blocking=False):
            raise SceneError(
                "a run is under way in this process, and there can be one at a time: wait for its end, or start this "
                "one in a process of its own, by multiprocessing.get_context('spawn')"
            )
        try:
            return run(*arguments, **keywords)
        finally:
            _under_way.release()

    return guarded
