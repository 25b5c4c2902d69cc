"""Whether an object that a scene file brought answers as a region does. Any with `contains` and `bounds` is one.

What it says is held to this when it is put into a scene, and again whenever it is asked about particles.
"""

import itertools
from typing import Protocol

import numpy as np

from rsmpm_ti.checks import KNOWN, MAX_COORDINATE, MIN_POSITIVE
from rsmpm_ti.errors import SceneError, reason, refuse, shown


class Answers(Protocol):
    """A region: frozen, with positions in metres.

    contains: x [n, dim] -> bool [n], also for n = 0. bounds: lower and upper corner [dim] of a box around it, dim 2 or
    3; the nearer they are, the less is seeded in vain.
    """

    def contains(self, x: np.ndarray) -> np.ndarray: ...

    def bounds(self) -> tuple[np.ndarray, np.ndarray]: ...


def sound(region):
    """The region, of a class from outside too. Raises SceneError for wrong answers."""
    if KNOWN.get(type(region).__name__) is type(region):
        return region
    name = type(region).__name__
    try:
        low, high = (np.asarray(bound, dtype=float) for bound in region.bounds())
    except Exception as error:  # code of a scene file
        raise SceneError(f"{name}.bounds() must return two corners [dim] in metres: {reason(error)}") from None
    if low.shape != high.shape or low.shape not in ((2,), (3,)):
        raise refuse(f"{name}.bounds()", (low.tolist(), high.tolist()), "two corners of 2 or 3 coordinates each")
    if not (np.all(np.abs([low, high]) <= MAX_COORDINATE) and np.all(high - low >= MIN_POSITIVE)):
        allowed = f"a lower and an upper corner of finite coordinates, at most {MAX_COORDINATE:g} m"
        raise refuse(f"{name}.bounds()", (low.tolist(), high.tolist()), allowed)
    steps = np.array(list(itertools.product((0.0, 0.3, 0.5, 1.0), repeat=len(low))))
    for x in (low + steps * (high - low), np.zeros((0, len(low)))):
        inside(region, x)
    return region


def inside(region: Answers, x: np.ndarray) -> np.ndarray:
    """`region.contains(x)`, held to what it must be: x [n, dim] -> bool [n]. Raises SceneError."""
    if KNOWN.get(type(region).__name__) is type(region):
        return region.contains(x)
    name = f"{type(region).__name__}.contains(x)"
    try:
        found = np.asarray(region.contains(x))
    except Exception as error:  # code of a scene file
        raise SceneError(f"{name} failed for x of shape {list(x.shape)}: {reason(error)}") from None
    if found.dtype != bool or found.shape != (len(x),):
        got = f"{found.dtype} {list(found.shape)}"
        raise SceneError(f"{name} gave {shown(got)} for x of shape {list(x.shape)}: it must be bool [{len(x)}]")
    return found
