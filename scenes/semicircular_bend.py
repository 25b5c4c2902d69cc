"""Half a disc with a notch on two rollers: the toughness test of rock cores. A crack splits it from the notch up.

Shape of the ISRM's method: Kuruppu et al. (2014), Rock Mech. Rock Eng. 47:267; supports at 0.8 diameters, notch half
the radius. The peak gives K_Ic, with `--quick` 8 % too high: its notch is as wide as three cells.
"""

from rsmpm_ti import FractureEnergy, Jittered, Length, Scene, lab_rock, mm, semicircular_test

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.5 * mm, "length": 3.0 * mm}


def scene(
    *,
    radius: Length = 42.0 * mm,
    notch: Length = 21.0 * mm,
    deflection_end: Length = 0.04 * mm,
    G_f_I: FractureEnergy = 5.0,
    length: Length = 2.0 * mm,
    dx: Length = 1.0 * mm,
    seed: int = 1,
    time_scale: float | None = None,  # by default as slow as the half disc's own swing asks
) -> Scene:
    return semicircular_test(
        title="Three-point bending of a notched half disc",
        rock=lab_rock(G_f_I=G_f_I, length=length),
        dx=dx,
        radius=radius,
        notch=notch,
        deflection_end=deflection_end,
        seeding=Jittered(amount=0.1, seed=seed),
        time_scale=time_scale,
    )
