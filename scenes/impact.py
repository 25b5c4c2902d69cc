"""A block of rock is thrown flat onto a rigid wall: a pressure rho c v runs through it, and what comes back breaks it.

The wall reads rho c v (Kolsky 1963, Stress Waves in Solids) until the sides have let go. Where releases from both sides
and from above meet the rock is pulled, and cracks. Waves are those of the true density.
"""

from rsmpm_ti import (
    Body,
    Box,
    Domain,
    Jittered,
    Length,
    LoadCell,
    Loading,
    Platen,
    Scene,
    Schedule,
    Time,
    Velocity,
    lab_rock,
    mm,
    ms,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm}


def scene(
    *,
    speed: Velocity = 3.0,
    width: Length = 60.0 * mm,
    height: Length = 40.0 * mm,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    t_end: Time = 0.12 * ms,
) -> Scene:
    half, room = 0.5 * width, 10.0 * mm
    block = Box(lower=(-half, 0.0), upper=(half, height))
    return Scene(
        title="A block of rock hits a wall",
        domain=Domain(lower=(-half - room, 0.0), upper=(half + room, height + room), dx=dx),
        bodies=(Body(region=block, seeding=Jittered(amount=0.1, seed=seed), velocity=(0.0, -speed)),),
        rock=lab_rock(length=length),
        loading=Loading(
            boundaries=(Platen(axis=1, side="lower", position=0.0),),
            cell=LoadCell(axis=1, lower=(0,)),
            width=width,
        ),
        schedule=Schedule(t_end=t_end, cfl=0.25),  # else energies, half a step apart, beat by 0.8 %
    )
