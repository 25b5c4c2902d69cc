"""A tunnel in ground under stress: a round hole that is there when the clock starts, and a load that then grows.

Block and hole first come to rest under the vertical stress and K0 times that from the sides; then the block's roof
and floor close in between smooth walls. The hole's sides are pressed most, 3 sigma_v - sigma_h (Kirsch 1898), and
fail. With `strain_end=8e-4` they cave into the block as slots, as do those of boreholes in porous sandstone: Haimson
(2007), Int. J. Rock Mech. Min. Sci. 44:157.
"""

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    InSitu,
    Jittered,
    Length,
    Loading,
    MPa,
    Platen,
    Pressure,
    Scene,
    Schedule,
    Wall,
    lab_rock,
    mm,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 2.0 * mm, "length": 4.0 * mm}

BRITTLE = 24.0
"""G_f_II [J/m^2], a tenth of the lab's rock's: what counts is mu G_f_II/c^2 over the radius, and this hole is small."""


def scene(
    *,
    radius: Length = 12.0 * mm,
    width: Length = 120.0 * mm,  # of the block, as high as wide
    vertical_stress: Pressure = 6.0 * MPa,
    K0: float = 0.5,
    length: Length = 2.0 * mm,
    dx: Length = 1.0 * mm,
    seed: int = 1,
    strain_end: float = 4.5e-4,
    time_scale: float = 16.0,
) -> Scene:
    half = 0.5 * width
    block = Box(lower=(-half, -half), upper=(half, half))
    hole = Disc(centre=(0.0, 0.0), radius=radius)
    boundaries = (
        Platen(axis=1, side="lower", position=-half, speed=2.5e-3),
        Platen(axis=1, side="upper", position=half, speed=-2.5e-3),
        Wall(axis=0, side="lower", position=-half),
        Wall(axis=0, side="upper", position=half),
    )
    return Scene(
        title="Tunnel in ground under stress",
        domain=Domain(lower=(-half, -half), upper=(half, half), dx=dx),
        bodies=(Body(region=Difference(whole=block, removed=(hole,)), seeding=Jittered(seed=seed, fitted=True)),),
        rock=lab_rock(length=length, G_f_II=BRITTLE),
        loading=Loading(
            boundaries=boundaries,
            start=Affine(),
            initial_stress=InSitu(axis=1, overburden=vertical_stress, K0=K0),
            settle=True,
            time_scale=time_scale,
            width=width,
        ),
        schedule=Schedule(strain_end=strain_end),
    )
