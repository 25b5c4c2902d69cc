"""The cube without a flaw: the uniform state whose modulus and strength are known exactly."""

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    Domain,
    GPa,
    Hooke,
    Lattice,
    Length,
    Loading,
    MohrCoulomb,
    MPa,
    Platen,
    Rock,
    Scene,
    Schedule,
    mm,
)

QUICK = {"dx": 1.0 * mm}


def scene(*, dx: Length = 0.5 * mm, strain_end: float = 1.6e-3, time_scale: float | str = 10.0) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    sign = 1.0 if strain_end > 0.0 else -1.0  # a negative strain pulls: direct tension
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3 * sign),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3 * sign),
    )
    return Scene(
        title="Uniaxial test of an intact specimen",
        domain=Domain(lower=(-5.0 * mm, 0.0), upper=(55.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm)), seeding=Lattice()),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm),
        schedule=Schedule(strain_end=strain_end),
    )
