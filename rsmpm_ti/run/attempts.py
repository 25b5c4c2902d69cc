"""What is done at the end of a run although something before it may have failed: a full disk, memory that is short."""

from collections.abc import Callable
from typing import Any

from rsmpm_ti.errors import ObserverError, SceneError, reason, still_kept
from rsmpm_ti.output.folder import FolderGone


class Attempts:
    """Does one thing after another, also after one has failed. `problem`: the first failure; None where all is well."""

    def __init__(self):
        self.problem: SceneError | None = None

    def __call__(self, work: Callable, *arguments, what: str = "a file cannot be written") -> Any:
        """The result of work(*arguments), None where it failed; what: the name of such a failure, where it has none."""
        try:
            return work(*arguments)
        except (ObserverError, FolderGone) as error:  # the one is of the user's own, of the other nothing is kept
            self._take(error)
        except SceneError as error:
            self._fail(str(error))
        except OSError as error:
            self._fail(f"{error.filename or 'a file'} cannot be written: {reason(error)}")
        except Exception as error:  # whatever it is, what comes after it is still done
            self._fail(f"{what}: {reason(error)}", error)
        return None

    def _fail(self, said: str, cause: Exception | None = None) -> None:
        problem = SceneError(f"{said}; {still_kept(said)}")
        problem.__cause__ = cause
        self._take(problem)

    def _take(self, problem: SceneError) -> None:
        self.problem = self.problem or problem
