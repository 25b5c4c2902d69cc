"""How a scene starts, and with it how fast its platens move: `factor` is their speed over the full one. NumPy-free."""

import math
from dataclasses import dataclass

from rsmpm_ti.errors import refuse


def _check_time(owner: str, time: float) -> None:
    if not (math.isfinite(time) and time > 0.0):
        raise refuse(owner, time, "a positive time in seconds")


@dataclass(frozen=True, kw_only=True)
class Affine:
    """Start with the velocity field of uniform straining between the platens: no first-wave shock."""

    def factor(self, time: float) -> float:
        return 1.0


@dataclass(frozen=True, kw_only=True)
class Ramp:
    """Start at rest; platens reach full speed after `time` [s] by a smooth step. At least 5 wave transits."""

    time: float

    def __post_init__(self):
        _check_time("start.time", self.time)

    def factor(self, time: float) -> float:
        """Smooth step 3 s^2 - 2 s^3."""
        s = min(1.0, time / self.time)
        return s * s * (3.0 - 2.0 * s)


@dataclass(frozen=True, kw_only=True)
class Press:
    """Start at rest, press during `time` [s] with a speed of sin^2, then hold: what is left is a static state.

    The strain is that of `time`/2 at full speed. At least 5 wave transits; with 8 what still swings is about 0.1 %.
    """

    time: float

    def __post_init__(self):
        _check_time("start.time", self.time)

    def factor(self, time: float) -> float:
        return math.sin(math.pi * time / self.time) ** 2 if time < self.time else 0.0


@dataclass(frozen=True, kw_only=True)
class AtRest:
    """Bodies keep their own initial velocity and platens move at full speed from the first step."""

    def factor(self, time: float) -> float:
        return 1.0
