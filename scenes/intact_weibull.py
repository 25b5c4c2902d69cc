"""The cube without a flaw, of rock whose strength varies from place to place: it breaks from its weak places."""

import math

from rsmpm_ti.boundaries import Platen
from rsmpm_ti.heterogeneity import Weibull
from rsmpm_ti.laws import Hooke, MohrCoulomb, Rock
from rsmpm_ti.regions import Box
from rsmpm_ti.seeding import Jittered
from rsmpm_ti.spec import Affine, Body, Domain, Loading, Scene, Schedule
from rsmpm_ti.units import GPa, MPa, mm

QUICK = {"dx": 1.0 * mm, "time_scale": 20.0}


def scene(
    *,
    weibull_modulus: float = 6.0,
    seed: int = 1,
    correlation_length: float = 2.0 * mm,
    dx: float = 0.5 * mm,
    strain_end: float = 5.0e-4,
    time_scale: float = 10.0,
) -> Scene:
    strength = Weibull(
        shape=weibull_modulus,
        reference_volume=math.pi * (2.0 * mm) ** 2,  # so that 1 is the scale of the factor at the default correlation
        seed=seed,
        correlation_length=correlation_length,
    )
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
        heterogeneity=strength,
    )
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3),
    )
    return Scene(
        title="Uniaxial compression of a heterogeneous specimen",
        domain=Domain(lower=(-10.0 * mm, 0.0), upper=(60.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm)), seeding=Jittered(amount=0.1)),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm),
        schedule=Schedule(strain_end=strain_end),
    )
