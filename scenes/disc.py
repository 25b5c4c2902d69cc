"""The paper's second example: a Brazilian disc of 100 mm with a central flaw along the load line (sec. 4.2)."""

import math

from rsmpm_ti import (
    Angle,
    Body,
    Difference,
    Disc,
    Domain,
    Gimp,
    GPa,
    Hooke,
    Jittered,
    Length,
    Loading,
    MohrCoulomb,
    MPa,
    Platen,
    Ramp,
    Rock,
    Scene,
    Schedule,
    Slit,
    mm,
    ms,
)

QUICK = {"dx": 1.0 * mm, "flaw_width": 2.0 * mm, "time_scale": 16.0}


def scene(
    *,
    flaw_angle: Angle = 90.0,
    flaw_length: Length = 30.0 * mm,
    flaw_width: Length = 1.0 * mm,
    arc: Angle = 90.0,  # half-angle of the loaded arc [degrees]; 90: every node in touch with the platen row
    dx: Length = 0.5 * mm,
    strain_end: float = 1.1e-4,
    time_scale: float = 8.0,
) -> Scene:
    radius, centre = 50.0 * mm, (50.0 * mm, 50.0 * mm)
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    region = Disc(centre=centre, radius=radius)
    if flaw_length > 0.0:
        flaw = Slit(centre=centre, length=flaw_length, width=flaw_width, angle=flaw_angle)
        region = Difference(whole=region, removed=(flaw,))
    half = radius * math.sin(math.radians(arc))
    span = (centre[0] - half, centre[0] + half)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.0e-3, span=span),
        Platen(axis=1, side="upper", position=2.0 * radius, speed=-2.0e-3, span=span),
    )
    return Scene(
        title="Brazilian disc with a central flaw",
        domain=Domain(lower=(-5.0 * mm, 0.0), upper=(105.0 * mm, 2.0 * radius), dx=dx),
        bodies=(Body(region=region, seeding=Jittered(amount=0.1)),),
        rock=rock,
        loading=Loading(
            boundaries=platens, start=Ramp(time=0.3 * ms * time_scale), time_scale=time_scale, width=math.pi * radius
        ),
        schedule=Schedule(strain_end=strain_end, cfl=1.0),
        shape=Gimp(),  # wide B-splines reach past the curved contact and tear rock beside the platens
    )
