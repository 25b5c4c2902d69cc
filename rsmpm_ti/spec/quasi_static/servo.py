"""A servo that slows the platens while rock breaks, as a stiff testing machine with feedback does.

Cracks grow at the speed of waves at most, and mass scaling makes waves slow. Platens that go on at full speed meanwhile
press on rock whose cracks have had no time to grow: the load at the peak is too high by what is loaded in a wave
transit of the specimen, and what breaks afterwards swings. So the servo looks at the energy that breaking rock
dissipates in a transit, over the most elastic energy that there has been. Above `activity` the platens slow down, below
half of it they are let on, by a factor SLOWER or FASTER in each transit; slowing sends a wave of up to rho c v. In the
laboratory it is the rate of acoustic emission or the lateral strain that is held so: Terada, Yanagidani & Ehara (1984),
3rd Conf. Acoustic Emission, 159; Hudson, Crouch & Fairhurst (1972), Eng. Geol. 6:155. The kinetic energy comes too
late: it rises when a crack already runs. A specimen that holds less than SPENT of its largest elastic energy has
nothing more to give: what flies then needs no slow platens.

Rock here knows no time of its own, so only the product of the platens' speed and the time scale matters: to slow the
platens by s is to divide the time scale by s, in another clock (docs/method.md).
"""

import math
from dataclasses import dataclass
from typing import Annotated

from annotated_types import Interval

from rsmpm_ti.checks import Remedy, checked
from rsmpm_ti.errors import refuse

SLOWER, FASTER = 0.05, 2.0
"""What the platens' speed is multiplied by in a wave transit at most."""

SPENT = 0.02
"""Fraction of the largest elastic energy below which a specimen is spent."""

LOOKS = 8
"""Looks at the energies in a wave transit."""


AUTO_DAMPING = 0.5
"""Local damping of a test whose time scale is found: what swings loses two thirds of its amplitude in half a period."""


@checked("servo")
@dataclass(frozen=True, kw_only=True)
class Servo:
    """Slows the platens while the energy dissipated in a wave transit is above `activity`, a fraction of the largest
    elastic energy so far. slowest: least fraction of the platens' speed that it goes down to, so that a run ends."""

    activity: Annotated[float, Interval(ge=1e-6, le=0.1), Remedy("a fraction of the elastic energy")] = 2e-3
    slowest: Annotated[float, Interval(ge=1e-4, le=1.0), Remedy("a fraction of the platens' speed")] = 0.1

    def next(self, pace: float, activity: float, stored: float, transits: float) -> float:
        """Fraction of the platens' speed after so many wave transits at `pace`.

        activity, stored: energy dissipated in a transit, and elastic energy, over the largest elastic energy so far.
        """
        if stored <= SPENT or activity < 0.5 * self.activity:
            return min(1.0, pace * FASTER**transits)
        if activity > self.activity:
            return max(self.slowest, pace * SLOWER**transits)
        return pace

    def look_steps(self, transit: float) -> int:
        """Steps between two looks; transit: steps of a wave through the specimen."""
        return max(1, math.floor(transit / LOOKS))


def check_quasi_static(scene) -> None:
    """Raises SceneError where a servo has no platens to slow, or local damping knows no motion to spare."""
    loading, servo = scene.loading, scene.loading.servo
    ends = loading.ends
    if loading.local_damping and ends is None:
        raise refuse("loading.local_damping", loading.local_damping, "0 where nothing faces a platen")
    if servo is None:
        return
    remedy = "it slows platens that close at a speed"
    if ends is None or not loading.strain_rate or any(boundary.held for boundary in loading.boundaries):
        raise refuse("loading.servo", servo, "none without two ends that move at a strain rate", remedy)
    if scene.schedule.adaptive:
        raise refuse("loading.servo", servo, "none with schedule.adaptive", "one of them says how time goes on")
    if loading.force_field is not None:
        raise refuse("loading.servo", servo, "none with a loading.force_field", "it has a time of its own")
