"""Diametral compression of a disc: the Brazilian test."""

import math

from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.regions import Difference, Disc, Slit
from rsmpm_ti.spec.scene import Body, Domain, Loading, Output, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice


def brazilian_test(
    *,
    title: str,
    rock: Rock,
    dx: float,
    strain_end: float,
    flaws: tuple[Slit, ...] = (),
    seeding: Lattice | Jittered | None = None,
    radius: float = 50e-3,
    arc: float = 90.0,
    room: float = 5e-3,
    speed: float = 2e-3,
    ramp: float = 0.3e-3,
    time_scale: float = 1.0,
    cfl: float = 0.5,
    shape: Linear | Gimp | QuadraticBSpline | None = None,
    cell: LoadCell | None = None,
    output: Output | None = None,
) -> Scene:
    """A disc that touches both axes of coordinates, pressed along y by two platens that begin at rest.

    flaws: slits cut into it; seeding: Lattice() by default; arc: half-angle of the loaded arc [degrees], 90: every node
    in touch with the platen row; speed: of each platen [m/s]; ramp: time in which they reach it [s], at the true
    density. The nominal stress is the load over pi R, the tension that Hertz's solution has in the middle of a disc of
    unit thickness: sigma = 2 P / (pi D).
    """
    half = radius * math.sin(math.radians(arc))
    span = (radius - half, radius + half)
    disc = Disc(centre=(radius, radius), radius=radius)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=speed, span=span),
        Platen(axis=1, side="upper", position=2.0 * radius, speed=-speed, span=span),
    )
    return Scene(
        title=title,
        domain=Domain(lower=(-room, 0.0), upper=(round(2.0 * radius + room, 12), 2.0 * radius), dx=dx),
        bodies=(Body(region=Difference(whole=disc, removed=flaws) if flaws else disc, seeding=seeding or Lattice()),),
        rock=rock,
        loading=Loading(
            boundaries=platens, start=Ramp(time=ramp * time_scale), time_scale=time_scale, width=math.pi * radius,
            cell=cell or LoadCell(),
        ),
        schedule=Schedule(strain_end=strain_end, cfl=cfl),
        shape=shape or QuadraticBSpline(),
        output=output or Output(),
    )  # fmt: skip
