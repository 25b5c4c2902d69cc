"""The cube without a flaw, of rock whose strength varies from place to place: it shears from its weak places."""

import math
from dataclasses import replace

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    Domain,
    Jittered,
    Length,
    Loading,
    Platen,
    Scene,
    Schedule,
    Weibull,
    lab_rock,
    mm,
)

QUICK = {"dx": 1.0 * mm, "time_scale": 20.0}


def scene(
    *,
    weibull_modulus: float = 6.0,
    seed: int = 1,
    correlation_length: Length = 2.0 * mm,
    dx: Length = 0.5 * mm,
    strain_end: float = 1.2e-3,
    time_scale: float | str = 10.0,
) -> Scene:
    strength = Weibull(
        shape=weibull_modulus,
        reference_volume=math.pi * (2.0 * mm) ** 2,  # so that 1 is the scale of the factor at the default correlation
        seed=seed,
        correlation_length=correlation_length,
    )
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3),
    )
    return Scene(
        title="Uniaxial compression of a heterogeneous specimen",
        domain=Domain(lower=(-15.0 * mm, 0.0), upper=(65.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm)), seeding=Jittered(amount=0.1)),),
        rock=replace(lab_rock(), heterogeneity=strength),
        loading=Loading(boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm),
        schedule=Schedule(strain_end=strain_end),
    )
