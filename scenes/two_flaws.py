"""Two parallel flaws in rock of the laboratory: wing cracks, then cracks that join the flaws across their bridge.

Arranged as in Bobet & Einstein (1998), Int. J. Rock Mech. Min. Sci. 35:863: the ligament is the line between the inner
tips; the bridging angle is that from the line of the lower flaw to the ligament, counter-clockwise. 0: one flaw in the
line of the other; 90: the inner tips face each other; more: the flaws overlap; below 0: stepped to the other side.
"""

import math

from rsmpm_ti import Angle, Jittered, Length, MPa, Output, Scene, Slit, lab_rock, mm, uniaxial_test

# a coarser rock, which breaks later: its mean is over two cells at least
QUICK = {"dx": 1.0 * mm, "length": 2.0 * mm, "strain_end": 1.25e-3}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    bridging_angle: Angle = 90.0,
    ligament: Length = 12.0 * mm,
    flaw_length: Length = 12.0 * mm,
    flaw_width: Length = 3.0 * mm,
    length: Length = 1.0 * mm,
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 1.0e-3,
    time_scale: float | str = 16.0,
) -> Scene:
    along, across = math.radians(flaw_angle), math.radians(flaw_angle + bridging_angle)
    # from the specimen's centre to the centre of the upper flaw: half the ligament, then half the flaw
    offset = [0.5 * (ligament * turn(across) + flaw_length * turn(along)) for turn in (math.cos, math.sin)]
    flaws = tuple(
        Slit(
            centre=(25.0 * mm + side * offset[0], 50.0 * mm + side * offset[1]),
            length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True,
        )
        for side in (-1.0, 1.0)
    )  # fmt: skip
    return uniaxial_test(
        title="Uniaxial compression of a specimen with two flaws",
        rock=lab_rock(length=length),
        flaws=flaws,
        seeding=Jittered(seed=seed, fitted=True),
        room=10.0 * mm,
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
        output=Output(stress_limit=4.0 * MPa),
    )
