"""The paper's second example: a Brazilian disc of 100 mm with a central flaw along the load line (sec. 4.2)."""

from rsmpm_ti import (
    Angle,
    Gimp,
    GPa,
    Hooke,
    Lattice,
    Length,
    MohrCoulomb,
    MPa,
    PicFlip,
    Rock,
    Scene,
    Slit,
    brazilian_test,
    mm,
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
    time_scale: float | str = 8.0,
) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    flaws, what = (), "without a flaw"
    if flaw_length > 0.0:
        what = "with a central flaw"
        flaws = (Slit(centre=(50.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle),)
    return brazilian_test(
        title=f"Brazilian disc {what}",
        rock=rock,
        flaws=flaws,
        seeding=Lattice(),  # jitter breaks single particles along the flaw
        arc=arc,
        dx=dx,
        strain_end=strain_end,
        time_scale=time_scale,
        cfl=1.0,
        transfer=PicFlip(flip=0.99),
        shape=Gimp(),  # wide B-splines reach past the curved contact and tear rock beside the platens
    )
