"""A block in 3D between two platens: a scene file for tests."""

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    Domain,
    GPa,
    Hooke,
    Length,
    Loading,
    MohrCoulomb,
    MPa,
    Output,
    Platen,
    Rock,
    Scene,
    Schedule,
    mm,
)  # fmt: skip


def scene(*, dx: Length = 1.25 * mm, strain_end: float = 1e-4) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=40.0 * mm, speed=-2.5e-3),
    )
    room = 5.0 * mm
    return Scene(
        title="A block in 3D",
        domain=Domain(lower=(-room, 0.0, -room), upper=(25.0 * mm, 40.0 * mm, 25.0 * mm), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0, 0.0), upper=(20.0 * mm, 40.0 * mm, 20.0 * mm))),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), width=(20.0 * mm) ** 2),
        schedule=Schedule(strain_end=strain_end),
        output=Output(frames=2, movie=False, vtu=1),
    )
