"""A notched beam in three-point bending: a crack leaves the notch for the roller above, at the rock's toughness.

The shape of ASTM E399 and RILEM (1985), Mater. Struct. 18:285: span four depths, notch half the depth. The beam is two
lengths E' G_f/sigma_t^2 of `lab_rock` deep. The peak gives K_Ic, with `--quick` 6 % too high: its notch is as wide as
three cells.
"""

from rsmpm_ti import FractureEnergy, Jittered, Length, Scene, bending_test, lab_rock, mm

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.5 * mm, "length": 3.0 * mm, "time_scale": 4.0, "deflection_end": 0.03 * mm}


def scene(
    *,
    depth: Length = 42.0 * mm,
    notch: Length = 21.0 * mm,
    deflection_end: Length = 0.043 * mm,
    G_f_I: FractureEnergy = 5.0,
    length: Length = 2.0 * mm,
    dx: Length = 1.0 * mm,
    seed: int = 1,
    time_scale: float | None = None,  # by default as slow as the beam's own swing asks
) -> Scene:
    return bending_test(
        title="Three-point bending of a notched beam" if notch else "Three-point bending of a beam",
        rock=lab_rock(G_f_I=G_f_I, length=length),
        dx=dx,
        depth=depth,
        notch=notch,
        deflection_end=deflection_end,
        seeding=Jittered(amount=0.1, seed=seed),
        time_scale=time_scale,
    )
