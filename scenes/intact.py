"""The cube without a flaw: the uniform state whose modulus and strength are known exactly."""

import math

from rsmpm_ti import GPa, Hooke, Length, MohrCoulomb, MPa, Rock, Scene, mm, uniaxial_test

QUICK = {"dx": 1.0 * mm}


def scene(*, dx: Length = 0.5 * mm, strain_end: float = 1.6e-3, time_scale: float | str = 10.0) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    return uniaxial_test(
        title="Uniaxial test of an intact specimen",
        rock=rock,
        dx=dx,
        speed=math.copysign(2.5e-3, strain_end),  # a negative strain pulls: direct tension
        strain_end=strain_end,
        time_scale=time_scale,
    )
