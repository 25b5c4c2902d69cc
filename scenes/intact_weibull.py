"""The cube without a flaw, of rock whose strength varies from place to place: it shears from its weak places."""

import math
from dataclasses import replace

from rsmpm_ti import Jittered, Length, Scene, Weibull, lab_rock, mm, uniaxial_test

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm, "time_scale": 20.0}


def scene(
    *,
    weibull_modulus: float = 6.0,
    seed: int = 1,
    correlation_length: Length = 2.0 * mm,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    strain_end: float = 1.3e-3,
    time_scale: float | str = 10.0,
) -> Scene:
    strength = Weibull(
        shape=weibull_modulus,
        reference_volume=math.pi * (2.0 * mm) ** 2,  # so that 1 is the scale of the factor at the default correlation
        seed=seed,
        correlation_length=correlation_length,
    )
    return uniaxial_test(
        title="Uniaxial compression of a heterogeneous specimen",
        rock=replace(lab_rock(length=length), heterogeneity=strength),
        seeding=Jittered(amount=0.1),
        room=15.0 * mm,
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
    )
