"""What can go wrong: a scene that cannot be run, one that is hard to believe, an unstable run, a failed observer."""

import errno
import os


class SceneError(ValueError):
    """A scene, option or file is refused before anything compiles (exit status 2).

    The message is one line: field, value, allowed range, and what to do. What a terminal would act on is escaped.
    """

    result: object = None  # of what had run, where files could not be written any more

    def __init__(self, message: str):
        line = " ".join(message.split())
        super().__init__("".join(c if c.isprintable() else repr(c)[1:-1] for c in line))


class ObserverError(SceneError):
    """A user's own observer or history column raised. The run was sound, and what there was of it is written."""


class UnstableRun(RuntimeError):
    """The run left the range in which its numbers mean something (exit status 3).

    The message gives step, position, likely cause and remedy.
    """

    result: object = None  # of what had run


class BrokenApart(UnstableRun):
    """Rock that has failed is beyond what can be followed, or pieces have left the domain; nothing else is wrong.

    After a peak that is how a specimen ends, and the run a result (status 0); before one it is an unstable run.
    """


class RockWarning(UserWarning):
    """Something in a scene is hard to believe, or means something else than it seems to; the run goes on.

    `simulate` warns by Python's warnings; commands print the sentences on stderr.
    """


MAX_SHOWN = 200
"""Characters of a refused value that are shown: enough to know it again."""


def refuse(field: str, value: object, allowed: str, remedy: str = "") -> SceneError:
    """The one form in which bad input is refused."""
    return SceneError(f"{field} = {shown(value)} is refused: it must be {allowed}" + (f"; {remedy}" if remedy else ""))


def shown(value: object) -> str:
    """A value in one line of bounded length, whatever it is."""
    try:
        return short(" ".join(repr(value).split()))
    except Exception:  # an integer of thousands of digits, or an object of a scene file that cannot show itself
        return f"<{type(value).__name__}>"


def short(text: str) -> str:
    """The beginning of a text from outside."""
    return text if len(text) <= MAX_SHOWN else f"{text[:MAX_SHOWN]}..."


def reason(error: BaseException) -> str:
    """Why something failed, in a few words."""
    if isinstance(error, MemoryError):
        return "memory has run out"
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    return short(f"{type(error).__name__}: {error}")


FULL = tuple(os.strerror(getattr(errno, name)) for name in ("ENOSPC", "EDQUOT") if hasattr(errno, name))
"""What a disk or a quota that is full says."""


def room(said: str, link: str = ", or ") -> str:
    """The remedy of what went wrong where a disk is full, and "" for anything else."""
    return f"make room{link}" if any(full in said for full in FULL) else ""


def still_kept(said: str) -> str:
    """What to do after a failure of a run that can go on."""
    return f"what is complete is kept; {room(said, ' and ')}go on with --resume"
