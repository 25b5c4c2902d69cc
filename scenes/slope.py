"""A steep slope of weak rock under its weight, which comes slowly: a wedge breaks loose behind the crest and slides.

A plane through the toe carries the wedge up to the height 4 c sin(a) cos(phi)/(rho g (1 - cos(a - phi))) of a slope of
angle a: Culmann (1875), in Terzaghi (1943), Theoretical Soil Mechanics. With `cohesion=400kPa` this one stands.
"""

import math

from rsmpm_ti import (
    Angle,
    Body,
    Directional,
    Domain,
    Fixed,
    Gravity,
    Hooke,
    Jittered,
    Length,
    LinearSoftening,
    LoadCell,
    Loading,
    MohrCoulomb,
    MPa,
    Nonlocal,
    PicFlip,
    Polygon,
    Pressure,
    Rock,
    Scene,
    Schedule,
    Time,
    Wall,
    kPa,
)

# a coarser rock: its mean is over two cells at least
QUICK = {"dx": 4.0, "length": 8.0}


def scene(
    *,
    height: Length = 80.0,
    angle: Angle = 70.0,
    cohesion: Pressure = 100.0 * kPa,
    friction_angle: Angle = 35.0,
    length: Length = 4.0,
    dx: Length = 2.0,
    seed: int = 1,
    ramp: Time = 6.0,
    t_end: Time = 12.0,
) -> Scene:
    size = (cohesion / (100.0 * kPa)) ** 2  # of the energies, so that process zones keep their length
    rock = Rock(
        density=2400.0,
        elasticity=Hooke(E=500.0 * MPa, nu=0.3),
        criterion=MohrCoulomb(cohesion=cohesion, friction_angle=friction_angle, tensile_strength=0.5 * cohesion),
        after_failure=Directional(
            residual_friction_angle=friction_angle, softening=LinearSoftening(G_f_I=50.0 * size, G_f_II=1000.0 * size)
        ),
        nonlocal_mean=Nonlocal(length=length),
    )
    below, crest, wide = 0.5 * height, 1.5 * height, 3.5 * height
    toe = crest + height / math.tan(math.radians(angle))
    ground = Polygon(
        points=((0.0, 0.0), (wide, 0.0), (wide, below), (toe, below), (crest, below + height), (0.0, below + height))
    )
    return Scene(
        title="A slope of weak rock under its weight",
        domain=Domain(lower=(0.0, 0.0), upper=(wide, below + 1.2 * height), dx=dx),
        bodies=(Body(region=ground, seeding=Jittered(amount=0.1, seed=seed)),),
        rock=rock,
        loading=Loading(
            boundaries=(
                Fixed(axis=1, side="lower", position=0.0),
                Wall(axis=0, side="lower", position=0.0),
                Wall(axis=0, side="upper", position=wide),
            ),
            force_field=Gravity(b=(0.0, -9.81), ramp=ramp),
            cell=LoadCell(axis=1, lower=(0,)),
            width=wide,
        ),
        schedule=Schedule(t_end=t_end, cfl=0.35),
        transfer=PicFlip(flip=0.998),  # without a little damping what falls shakes what stands
    )
