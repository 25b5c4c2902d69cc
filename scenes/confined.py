"""The specimen of `cube_lab.py` under confining pressure, which also fills its open flaw: no wings, a shear fault.

Pressure keeps tension cracks shut, and splitting gives way to faulting: Horii & Nemat-Nasser (1986), Phil. Trans. R.
Soc. A 319:337.
"""

from rsmpm_ti import (
    Affine,
    Angle,
    Body,
    Box,
    Difference,
    Domain,
    Jittered,
    Length,
    Loading,
    MPa,
    Platen,
    Pressure,
    Scene,
    Schedule,
    Slit,
    lab_rock,
    mm,
)

QUICK = {"dx": 1.0 * mm}


def scene(
    *,
    confinement: Pressure = 2.0 * MPa,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 3.0 * mm,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 1.0e-3,
    time_scale: float | str = 16.0,
) -> Scene:
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True)
    block = Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm))
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3),
    )
    return Scene(
        title="Compression of a specimen with an inclined flaw under confining pressure",
        domain=Domain(lower=(-5.0 * mm, 0.0), upper=(55.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Difference(whole=block, removed=(flaw,)), seeding=Jittered(seed=seed, fitted=True)),),
        rock=lab_rock(length=length),
        loading=Loading(
            boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm, confinement=confinement
        ),
        schedule=Schedule(strain_end=strain_end),
    )
