"""A tunnel is driven into ground under stress: its rock is taken out, its support fades, and its sides spall.

The block starts under the vertical stress and K0 times that from the sides, between walls that stand still. As the
support fades the sides of the tunnel come to bear 3 sigma_v - sigma_h (Kirsch 1898), and fail where that is more than
the rock's strength, 25.5 MPa. With `vertical_stress=8MPa` it stands. In `tunnel` the hole is there before the load.
"""

from rsmpm_ti import (
    Body,
    Box,
    Disc,
    Domain,
    Excavation,
    InSitu,
    Jittered,
    Length,
    Loading,
    MPa,
    Output,
    Pressure,
    Scene,
    Schedule,
    Time,
    Wall,
    lab_rock,
    mm,
    ms,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 2.0 * mm, "length": 4.0 * mm}

BRITTLE = 24.0
"""G_f_II [J/m^2], a tenth of the lab's rock's: what counts is mu G_f_II/c^2 over the radius, and this hole is small."""


def scene(
    *,
    radius: Length = 12.0 * mm,
    width: Length = 120.0 * mm,  # of the block, as high as wide
    vertical_stress: Pressure = 13.0 * MPa,
    K0: float = 0.5,
    relaxation: Time = 0.4 * ms,
    length: Length = 2.0 * mm,
    dx: Length = 1.0 * mm,
    seed: int = 1,
) -> Scene:
    half = 0.5 * width
    return Scene(
        title="Excavation of a tunnel",
        domain=Domain(lower=(-half, -half), upper=(half, half), dx=dx),
        bodies=(Body(region=Box(lower=(-half, -half), upper=(half, half)), seeding=Jittered(seed=seed, fitted=True)),),
        rock=lab_rock(length=length, G_f_II=BRITTLE),
        loading=Loading(
            boundaries=tuple(
                Wall(axis=axis, side=side, position=half if side == "upper" else -half)
                for axis in (0, 1)
                for side in ("lower", "upper")
            ),
            initial_stress=InSitu(axis=1, overburden=vertical_stress, K0=K0),
            settle=True,  # jittered particles first find their balance
            holes=(
                Excavation(
                    region=Disc(centre=(0.0, 0.0), radius=radius), time=0.05 * relaxation, relaxation=relaxation
                ),
            ),
        ),
        schedule=Schedule(t_end=1.3 * relaxation),
        output=Output(stress_limit=vertical_stress),
    )
