"""Direct shear of intact rock under a constant normal stress: two halves of a box that move past each other."""

import math

from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.slow import slow_time_scale
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice

GAP = 1
"""Cells of each half of the box that its walls leave free on both sides of the plane of shear."""

RAMP = 0.3
"""Of the time to failure in which lid and wall come to full stress and speed: 15 % of the shear is then on."""


def shear_test(
    *,
    title: str,
    rock: Rock,
    dx: float,
    normal_stress: float,
    displacement_end: float,
    length: float = 50e-3,
    height: float = 50e-3,
    seeding: Lattice | Jittered | None = None,
    speed: float = 2e-3,
    time_scale: float | None = None,
    cfl: float = 1.0,
    output: Output | None = None,
) -> Scene:
    """A block whose upper half is pushed along x by the left wall of a box, and whose lower half the right wall holds.

    normal_stress: by which the lid presses [Pa]; displacement_end: of the left wall [m]; speed: its own [m/s]. The
    nominal stress is the shear force over the length. Walls and lid do not rub. Raises SceneError.
    """
    middle, room = 0.5 * height, 4.0 * dx
    walls = (
        Platen(axis=0, side="lower", position=0.0, speed=speed, span=(middle + GAP * dx, height + room)),
        Platen(axis=0, side="upper", position=length, span=(-room, middle - GAP * dx)),
        Platen(axis=1, side="lower", position=0.0),
        Platen(axis=1, side="upper", position=height, stress=normal_stress),
    )
    elastic = rock.elasticity
    shear_speed = math.sqrt(elastic.E / (2.0 * (1.0 + elastic.nu) * rock.density))
    criterion = rock.criterion
    if not isinstance(criterion, MohrCoulomb):
        raise refuse("rock.criterion", criterion, "MohrCoulomb", "what this test measures is cohesion and friction")
    strength = criterion.cohesion + normal_stress * math.tan(math.radians(criterion.friction_angle))
    duration = 2.0 * (1.0 + elastic.nu) * strength / elastic.E * height / speed
    scale = time_scale or slow_time_scale(duration, 8.0 * height / shear_speed)
    return Scene(
        title=title,
        domain=Domain(lower=(-room, -room), upper=(length + room, height + room), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(length, height)), seeding=seeding or Lattice()),),
        rock=rock,
        loading=Loading(
            boundaries=walls, start=Ramp(time=RAMP * duration), time_scale=scale, local_damping=AUTO_DAMPING,
            width=length,
        ),
        schedule=Schedule(t_end=displacement_end / speed + 0.5 * RAMP * duration, cfl=cfl),
        output=output or Output(),
    )  # fmt: skip
