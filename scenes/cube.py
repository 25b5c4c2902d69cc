"""The paper's first example: a 50 x 100 mm specimen with an inclined flaw under uniaxial compression (sec. 4.1)."""

from rsmpm_ti import Angle, GPa, Hooke, Lattice, Length, MohrCoulomb, MPa, PicFlip, Rock, Scene, Slit, mm, uniaxial_test

QUICK = {"dx": 1.0 * mm, "flaw_width": 3.0 * mm, "time_scale": 16.0}


def scene(
    *,
    flaw_angle: Angle = 45.0,
    flaw_length: Length = 15.0 * mm,
    flaw_width: Length = 1.5 * mm,
    dx: Length = 0.5 * mm,
    turn: Angle = -26.565,  # of the grid; arctan(1/2): neither along the specimen nor along its flaw
    strain_end: float = 2.5e-4,
    time_scale: float | str = 5.0,
) -> Scene:
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17.0 * GPa, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95 * MPa, friction_angle=40.0, tensile_strength=2.0 * MPa),
    )
    flaw = Slit(centre=(25.0 * mm, 50.0 * mm), length=flaw_length, width=flaw_width, angle=flaw_angle)
    return uniaxial_test(
        title="Uniaxial compression of a specimen with an inclined flaw",
        rock=rock,
        flaws=(flaw,),
        seeding=Lattice(),
        dx=dx,
        turn=turn,
        transfer=PicFlip(flip=0.99),  # what the grid does not see of velocities would show in the stress
        strain_end=strain_end,
        time_scale=time_scale,
        cfl=1.0,
    )
