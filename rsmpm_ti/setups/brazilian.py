"""Diametral compression of a disc: the Brazilian test."""

import math
from collections.abc import Callable

from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.mass_scaling import MAX_TIME_SCALE, estimate
from rsmpm_ti.spec.regions import Difference, Disc, Slit
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule
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
    time_scale: float | str = 1.0,
    cfl: float = 0.5,
    shape: Linear | Gimp | QuadraticBSpline | None = None,
    transfer: PicFlip | Apic | None = None,
    cell: LoadCell | None = None,
    output: Output | None = None,
) -> Scene:
    """A disc that touches both axes of coordinates, pressed along y by two platens that begin at rest.

    flaws: slits cut into it; seeding: Lattice() by default; arc: half-angle of the loaded arc [degrees], 90: every node
    in touch with the platen row; speed: of each platen [m/s]; ramp: time in which they reach it [s], at the true
    density; a time scale makes it longer, and 'auto' finds both. The nominal stress is the load over pi R, the tension
    that Hertz's solution has in the middle of a disc of unit thickness: sigma = 2 P / (pi D).
    """
    half = radius * math.sin(math.radians(arc))
    span = (radius - half, radius + half)
    disc = Disc(centre=(radius, radius), radius=radius)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=speed, span=span),
        Platen(axis=1, side="upper", position=2.0 * radius, speed=-speed, span=span),
    )

    def scene_of(scale: float | str, scaled_ramp: float) -> Scene:
        region = Difference(whole=disc, removed=flaws) if flaws else disc
        return Scene(
            title=title,
            domain=Domain(lower=(-room, 0.0), upper=(round(2.0 * radius + room, 12), 2.0 * radius), dx=dx),
            bodies=(Body(region=region, seeding=seeding or Lattice()),),
            rock=rock,
            loading=Loading(
                boundaries=platens, start=Ramp(time=scaled_ramp), time_scale=scale, width=math.pi * radius,
                cell=cell or LoadCell(),
            ),
            schedule=Schedule(strain_end=strain_end, cfl=cfl),
            shape=shape or QuadraticBSpline(),
            transfer=transfer or PicFlip(),
            output=output or Output(),
        )  # fmt: skip

    if not isinstance(time_scale, str):
        return scene_of(time_scale, ramp * time_scale)
    return scene_of(time_scale, ramp * _largest_time_scale(lambda scale: scene_of(scale, ramp * scale)))


def _largest_time_scale(scene_of: Callable[[float], Scene]) -> float:
    """The largest time scale within the tolerance of scenes whose ramp grows with it."""
    from scipy.optimize import brentq  # a third of a second, which a time_scale of one's own need not wait for

    def excess(scale: float) -> float:
        scene = scene_of(scale)
        return estimate(scene).error(scale) - scene.loading.quasi_static

    if excess(1.0) >= 0.0:
        return 1.0
    return MAX_TIME_SCALE if excess(MAX_TIME_SCALE) <= 0.0 else brentq(excess, 1.0, MAX_TIME_SCALE)
