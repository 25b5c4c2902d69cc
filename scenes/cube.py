"""The paper's first example: a 50 x 100 mm specimen with an inclined flaw under uniaxial compression (sec. 4.1)."""

from rsmpm_ti import (
    Affine,
    Angle,
    Body,
    Box,
    Difference,
    Domain,
    GPa,
    Hooke,
    Jittered,
    Length,
    Loading,
    MohrCoulomb,
    MPa,
    Platen,
    Rock,
    Scene,
    Schedule,
    Slit,
    mm,
)

QUICK = {"dx": 1.0 * mm, "flaw_width": 3.0 * mm, "time_scale": 16.0}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 1.5 * mm,
    dx: Length = 0.5 * mm,
    strain_end: float = 2.5e-4,
    time_scale: float | str = 5.0,
) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle)
    block = Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm))
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3),
    )
    return Scene(
        title="Uniaxial compression of a specimen with an inclined flaw",
        domain=Domain(lower=(-5.0 * mm, 0.0), upper=(55.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Difference(whole=block, removed=(flaw,)), seeding=Jittered(amount=0.1)),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm),
        schedule=Schedule(strain_end=strain_end, cfl=1.0),
    )
