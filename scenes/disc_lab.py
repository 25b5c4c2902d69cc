"""A Brazilian disc with an inclined central flaw in rock of the laboratory: wing cracks leave its tips for the load."""

import math

from rsmpm_ti import (
    Angle,
    Body,
    Difference,
    Disc,
    Domain,
    Jittered,
    Length,
    Loading,
    MPa,
    Output,
    Platen,
    Ramp,
    Scene,
    Schedule,
    Slit,
    lab_rock,
    mm,
    ms,
)

QUICK = {"dx": 1.0 * mm}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 30.0 * mm,
    flaw_width: Length = 3.0 * mm,
    arc: Angle = 90.0,  # half-angle of the loaded arc [degrees]; 90: every node in touch with the platen row
    dx: Length = 0.5 * mm,
    seed: int = 1,
    strain_end: float = 3.0e-4,
    time_scale: float = 16.0,
) -> Scene:
    radius, centre = 50.0 * mm, (50.0 * mm, 50.0 * mm)
    flaw = Slit(centre=centre, length=flaw_length, width=flaw_width, angle=flaw_angle, rounded=True)
    region = Difference(whole=Disc(centre=centre, radius=radius), removed=(flaw,))
    half = radius * math.sin(math.radians(arc))
    span = (centre[0] - half, centre[0] + half)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.0e-3, span=span),
        Platen(axis=1, side="upper", position=2.0 * radius, speed=-2.0e-3, span=span),
    )
    start = Ramp(time=0.3 * ms * time_scale)
    return Scene(
        title="Brazilian disc with an inclined flaw: directional cracks and fracture energy",
        domain=Domain(lower=(-5.0 * mm, 0.0), upper=(105.0 * mm, 2.0 * radius), dx=dx),
        bodies=(Body(region=region, seeding=Jittered(seed=seed, fitted=True)),),
        rock=lab_rock(),
        loading=Loading(boundaries=platens, start=start, time_scale=time_scale, width=math.pi * radius),
        schedule=Schedule(strain_end=strain_end),
        output=Output(stress_limit=4.0 * MPa),
    )
