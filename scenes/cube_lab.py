"""The slit cube with rock that cracks as rock does: directional cracks, friction, fracture energy, a material length.

Wing cracks in tension come first, then shear cracks from the flaw's ends at the peak. The rock and where its numbers
come from: `rsmpm_ti/rock/presets.py`.
"""

from rsmpm_ti import (
    Angle,
    FractureEnergy,
    Jittered,
    Length,
    MPa,
    Output,
    Scene,
    Servo,
    Slit,
    lab_rock,
    mm,
    uniaxial_test,
)

# a coarser rock, which breaks later: its mean is over two cells at least; its peak does not depend on the speed
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm, "servo": False, "strain_end": 1.2e-3}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 3.0 * mm,
    G_f_I: FractureEnergy = 5.0,
    G_f_II: FractureEnergy = 240.0,
    residual_friction_angle: Angle = 30.0,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 8.8e-4,
    time_scale: float | str = 16.0,
    servo: bool = True,
) -> Scene:
    rock = lab_rock(G_f_I=G_f_I, G_f_II=G_f_II, residual_friction_angle=residual_friction_angle, length=length)
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True)
    return uniaxial_test(
        title="Uniaxial compression of a flawed specimen: directional cracks and fracture energy",
        rock=rock,
        flaws=(flaw,),
        seeding=Jittered(seed=seed, fitted=True),
        room=15.0 * mm,
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
        servo=Servo() if servo else None,
        output=Output(stress_limit=4.0 * MPa),
    )
