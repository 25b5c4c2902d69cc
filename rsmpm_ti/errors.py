"""What can go wrong, as two exceptions: a scene that cannot be run, and a run that became unstable."""


class SceneError(ValueError):
    """A scene, option or file is refused before anything compiles (exit status 2).

    The message is one line: field, value, allowed range, and what to do.
    """


class UnstableRun(RuntimeError):
    """The run left the range in which its numbers mean something (exit status 3).

    The message gives step, place, likely cause and remedy.
    """


def refuse(field: str, value: object, allowed: str, remedy: str = "") -> SceneError:
    """The one form in which bad input is refused."""
    return SceneError(f"{field} = {value!r} is refused: it must be {allowed}" + (f"; {remedy}" if remedy else ""))
