"""The slit cube with rock that cracks as rock does: directional cracks, friction, fracture energy, a material length.

Wing cracks in tension come first, then shear cracks from the flaw's ends at the peak. The rock and where its numbers
come from: `rsmpm_ti/rock/presets.py`.
"""

from rsmpm_ti import (
    Affine,
    Angle,
    Body,
    Box,
    Difference,
    Domain,
    FractureEnergy,
    Jittered,
    Length,
    Loading,
    MPa,
    Output,
    Platen,
    Scene,
    Schedule,
    Slit,
    lab_rock,
    mm,
)

QUICK = {"dx": 1.0 * mm}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 3.0 * mm,
    G_f_I: FractureEnergy = 5.0,
    G_f_II: FractureEnergy = 24.0,
    residual_friction_angle: Angle = 30.0,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 8.0e-4,
    time_scale: float | str = 16.0,
) -> Scene:
    rock = lab_rock(G_f_I=G_f_I, G_f_II=G_f_II, residual_friction_angle=residual_friction_angle, length=length)
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True)
    block = Box(lower=(0.0, 0.0), upper=(50.0 * mm, 100.0 * mm))
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=100.0 * mm, speed=-2.5e-3),
    )
    return Scene(
        title="Uniaxial compression of a flawed specimen: directional cracks and fracture energy",
        domain=Domain(lower=(-15.0 * mm, 0.0), upper=(65.0 * mm, 100.0 * mm), dx=dx),
        bodies=(Body(region=Difference(whole=block, removed=(flaw,)), seeding=Jittered(seed=seed, fitted=True)),),
        rock=rock,
        loading=Loading(boundaries=platens, start=Affine(), time_scale=time_scale, width=50.0 * mm),
        schedule=Schedule(strain_end=strain_end),
        output=Output(stress_limit=4.0 * MPa),
    )
