"""Observers: whoever looks at a run while it goes, each at its own interval."""

import math

from rsmpm_ti.errors import ObserverError, refuse
from rsmpm_ti.solver.view import View


class Observer:
    """Looks at a run: subclass it, and give an object of the class to `simulate(..., observers=(...,))`.

    every: fraction of the run between two looks, in (0, 1]; for so many seconds of the run's time, seconds /
    scene.t_end. 0: at the start and at every history row. The first look is at the start, the last at the end. Looks
    are at history rows, so one that is due between two rows comes with the second.
    """

    every: float = 0.0

    def see(self, view: View) -> None:
        """Look. What is raised here ends the run, in one line, once all that can be written is written."""
        raise NotImplementedError

    def state(self) -> dict:
        """What `resume` needs to go on from a checkpoint: numbers, texts, None, lists and dicts of them with texts as
        keys (tuples come back as lists), and NumPy arrays of numbers or texts, which are not within those. Anything
        else ends a run that writes files in one line as it starts: this is asked after the first look."""
        return {}

    def resume(self, state: dict) -> None:
        """Go on where an observer with this `state()` was."""

    def realign(self, fraction: float) -> None:
        """After `resume`, in a run whose end or output is another than before; fraction: of it that is done."""


class Watch:
    """An observer and the next look that is due. own: of this package, whose errors say what they mean already."""

    def __init__(self, observer: Observer, own: bool = False):
        self.observer, self.own, self.name = observer, own, type(observer).__name__
        self._next = 0
        every = getattr(observer, "every", None)
        number = isinstance(every, int | float) and math.isfinite(every) and 0.0 <= every <= 1.0
        if not number:
            raise refuse(f"{self.name}.every", every, "a fraction of the run in (0, 1], or 0 for every history row")
        if isinstance(observer, type):
            raise refuse("observers", observer, "objects, not classes", f"write {observer.__name__}()")
        for name in ("see", "state", "resume"):
            if not callable(getattr(observer, name, None)):
                raise refuse("observers", observer, "objects with every, see, state and resume", f"{name} is missing")

    def look(self, view: View) -> None:
        """Let it see if it is due; one that failed is due again at the next row."""
        every = self.observer.every
        if every == 0.0 or view.fraction >= self._next * every - 1e-9:
            self._ask(self.observer.see, view)
            self._next = math.floor(view.fraction / every + 1e-9) + 1 if every else 0

    def realign(self, fraction: float) -> None:
        """The run has another end, or output, than before it was resumed: what is due next counts from where it is."""
        every = self.observer.every
        self._next = math.floor(fraction / every + 1e-9) + 1 if every else 0
        if self.own:
            self.observer.realign(fraction)

    def state(self) -> dict:
        own = self._ask(self.observer.state)
        if not isinstance(own, dict):
            raise ObserverError(f"observer {self.name}: state() must return a dict, not a {type(own).__name__}")
        return {"next": self._next, "own": own}

    def resume(self, state: dict) -> None:
        self._next = state["next"]
        self._ask(self.observer.resume, state["own"])

    def _ask(self, method, *arguments):
        try:
            return method(*arguments)
        except (Exception, SystemExit, GeneratorExit) as error:  # a user's may say sys.exit()
            if self.own:
                raise
            said = f"{type(error).__name__}: {error}"
            raise ObserverError(f"observer {self.name} failed in {method.__name__}(): {said}") from error


def look_all(watches: list[Watch], view: View) -> None:
    """Let everybody look. One that fails does not keep the others from it; the first failure is then raised."""
    problem = None
    for watch in watches:
        try:
            watch.look(view)
        except ObserverError as error:
            problem = problem or error
    if problem is not None:
        raise problem
