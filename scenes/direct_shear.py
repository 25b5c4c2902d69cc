"""Direct shear of intact rock in a box, under a lid that presses with a constant normal stress.

The upper half is pushed to the right. Inclined cracks open along the plane between the halves and join; what is left is
friction. Shear strength and residual: ASTM D5607; Muralha et al. (2014), Rock Mech. Rock Eng. 47:291.
"""

from rsmpm_ti import Angle, FractureEnergy, Jittered, Length, MPa, Pressure, Scene, lab_rock, mm, shear_test

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 2.0 * mm, "length": 4.0 * mm}


def scene(
    *,
    normal_stress: Pressure = 2.5 * MPa,
    displacement_end: Length = 0.15 * mm,
    G_f_II: FractureEnergy = 240.0,
    residual_friction_angle: Angle = 30.0,
    length: Length = 2.0 * mm,
    dx: Length = 1.0 * mm,
    seed: int = 1,
    time_scale: float | None = None,  # by default as slow as the block's own swing asks
) -> Scene:
    return shear_test(
        title="Direct shear of intact rock under constant normal stress",
        rock=lab_rock(G_f_II=G_f_II, residual_friction_angle=residual_friction_angle, length=length),
        dx=dx,
        normal_stress=normal_stress,
        displacement_end=displacement_end,
        seeding=Jittered(amount=0.1, seed=seed),
        time_scale=time_scale,
    )
