"""The specimen of `cube_lab.py` under confining pressure, which also fills its open flaw: no wings, a shear fault.

Pressure keeps tension cracks shut, and splitting gives way to faulting: Horii & Nemat-Nasser (1986), Phil. Trans. R.
Soc. A 319:337.
"""

from rsmpm_ti import Angle, Jittered, Length, MPa, Pressure, Scene, Slit, lab_rock, mm, uniaxial_test

QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm}  # a coarser rock: its mean is over two cells at least


def scene(
    *,
    confinement: Pressure = 2.0 * MPa,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 3.0 * mm,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 1.5e-3,
    time_scale: float | str = 16.0,
) -> Scene:
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True)
    return uniaxial_test(
        title="Compression of a specimen with an inclined flaw under confining pressure",
        rock=lab_rock(length=length),
        flaws=(flaw,),
        seeding=Jittered(seed=seed, fitted=True),
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
        confinement=confinement,
    )
