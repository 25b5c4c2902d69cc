"""How fast a specimen that swings as a whole may be loaded: slowly against its first period."""

from rsmpm_ti.spec.mass_scaling import MAX_TIME_SCALE

PERIODS = 2.0
"""Of the first swing until the peak. A load that rises steadily after a smooth ramp then swings by less than 1/(2 pi
PERIODS) of itself, 8 %, and local damping takes two thirds of that in half a period."""


def slow_time_scale(duration: float, period: float) -> float:
    """The largest time scale at which the peak comes after so many periods; 1 at least.

    duration: until the peak [s]; period: of the first swing at the true density [s].
    """
    return min(max(1.0, duration / (PERIODS * period)), MAX_TIME_SCALE)
