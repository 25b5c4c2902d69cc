"""A blast hole: a pulse of pressure on its wall, a wave that runs away, and cracks that run after it.

The pressure rises within 8 us and decays; the rock has its true density. Around the hole the hoop stress is tension as
large as the pressure (Lame), so cracks start from the wall in all directions and a few of them win, as in Kutter &
Fairhurst (1971), Int. J. Rock Mech. Min. Sci. 8:181. No gas follows into them. The block goes on beyond its sides.
"""

import math

from rsmpm_ti import (
    Absorbing,
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    HolePressure,
    Jittered,
    Length,
    Loading,
    MPa,
    Output,
    Pressure,
    Scene,
    Schedule,
    Time,
    lab_rock,
    mm,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm, "width": 80.0 * mm, "t_end": 30e-6}


def pulse(peak: float, rise: float, decay: float) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Times [s] and pressures [Pa]: sin^2 up to the peak, then exp(-t/decay)."""
    up, down = [k / 8 for k in range(1, 9)], [k / 4 for k in range(1, 25)]
    times = [rise * s for s in up] + [rise + decay * s for s in down]
    pressures = [peak * math.sin(0.5 * math.pi * s) ** 2 for s in up] + [peak * math.exp(-s) for s in down]
    return tuple(times), tuple(pressures)


def scene(
    *,
    radius: Length = 5.0 * mm,
    width: Length = 120.0 * mm,  # of the block, as high as wide
    peak: Pressure = 16.0 * MPa,
    rise: Time = 8e-6,
    decay: Time = 20e-6,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    t_end: Time = 60e-6,
) -> Scene:
    half = 0.5 * width
    block, hole = Box(lower=(-half, -half), upper=(half, half)), Disc(centre=(0.0, 0.0), radius=radius)
    times, pressures = pulse(peak, rise, decay)
    return Scene(
        title="Blast hole",
        domain=Domain(lower=(-half, -half), upper=(half, half), dx=dx),
        bodies=(Body(region=Difference(whole=block, removed=(hole,)), seeding=Jittered(seed=seed, fitted=True)),),
        rock=lab_rock(length=length),
        loading=Loading(
            boundaries=tuple(
                Absorbing(axis=axis, side=side, position=half if side == "upper" else -half)
                for axis in (0, 1)
                for side in ("lower", "upper")
            ),
            holes=(HolePressure(region=hole, times=times, pressures=pressures),),
        ),
        schedule=Schedule(t_end=t_end, cfl=0.3),
        output=Output(stress_limit=0.25 * peak),
    )
