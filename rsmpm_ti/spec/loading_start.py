"""How a scene starts, and with it how fast its platens move: `factor` is their speed, or
force, over the full one. NumPy-free."""

import bisect
import itertools
import math
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from rsmpm_ti.checks import MAX_SIZE, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import Time

Duration = Annotated[Time, Interval(ge=1e-18, le=MAX_SIZE)]


@checked("start")
@dataclass(frozen=True, kw_only=True)
class Affine:
    """Start with the velocity field of uniform straining between the platens: no first-wave shock."""

    def factor(self, time: float) -> float:
        return 1.0


@checked("start")
@dataclass(frozen=True, kw_only=True)
class Ramp:
    """Start at rest; platens reach full speed after `time` [s] by a smooth step. At least 5 wave transits."""

    time: Duration

    def factor(self, time: float) -> float:
        """Smooth step 3 s^2 - 2 s^3."""
        s = min(1.0, time / self.time)
        return s * s * (3.0 - 2.0 * s)

    def duration(self, at_full_speed: float) -> float:
        """When platens have come as far as in that time at full speed [s]: `time`/2 later, or within the ramp where
        its integral, time (s^3 - s^4/2), is that much."""
        if at_full_speed >= 0.5 * self.time:
            return at_full_speed + 0.5 * self.time
        low, high = 0.0, 1.0
        for _ in range(60):
            s = 0.5 * (low + high)
            low, high = (s, high) if s**3 - 0.5 * s**4 < at_full_speed / self.time else (low, s)
        return high * self.time


@checked("start")
@dataclass(frozen=True, kw_only=True)
class Press:
    """Start at rest, press during `time` [s] with a speed of sin^2, then hold: what is left is a static state.

    The strain is that of `time`/2 at full speed. At least 5 wave transits; with 8 what still swings is about 0.1 %.
    """

    time: Duration

    def factor(self, time: float) -> float:
        return math.sin(math.pi * time / self.time) ** 2 if time < self.time else 0.0


@checked("start")
@dataclass(frozen=True, kw_only=True)
class Program:
    """Start at rest and follow a table: at `times` [s] platens have `factors` of their speed, force or stress.

    Between them linear, after the last the last. Load, hold and unload: forces take factors such as (0, 1, 1, 0).
    """

    times: tuple[Duration, ...]
    factors: tuple[Annotated[float, Interval(ge=-1e3, le=1e3)], ...]

    def __post_init__(self):
        if not self.times or any(b <= a for a, b in itertools.pairwise(self.times)):
            raise refuse("start.times", self.times, "times that grow, at least one")
        if len(self.factors) != len(self.times):
            raise refuse("start.factors", self.factors, f"{len(self.times)} numbers, one for each of start.times")

    def factor(self, time: float) -> float:
        times, factors = (0.0, *self.times), (0.0, *self.factors)
        k = bisect.bisect_right(times, time)
        if k == len(times):
            return factors[-1]
        part = (time - times[k - 1]) / (times[k] - times[k - 1])
        return factors[k - 1] + part * (factors[k] - factors[k - 1])


@checked("start")
@dataclass(frozen=True, kw_only=True)
class AtRest:
    """Bodies keep their own initial velocity and platens move at full speed from the first step."""

    def factor(self, time: float) -> float:
        return 1.0
