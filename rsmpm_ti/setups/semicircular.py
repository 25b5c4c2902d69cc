"""Bending of half a disc with a notch: the ISRM's test for the toughness of cores."""

import math

import numpy as np

from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.bending import NOTCH, ROLLER, plane_modulus
from rsmpm_ti.setups.slow import slow_time_scale
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.drawings.polygon import Polygon
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING, Servo
from rsmpm_ti.spec.regions import Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice

SPAN, NOTCH_RATIO = 0.8, 0.5
"""Distance of the supports over the diameter, and depth of the notch over the radius: Kuruppu et al. (2014), Rock Mech.
Rock Eng. 47:267, table 1: 0.5 to 0.8, and 0.4 to 0.6."""

CORNERS = 721
"""Of the arc: its chords lie within 1e-6 radii of it."""

STIFFNESS = 0.098
"""Load per thickness over plane modulus and deflection of half a disc with a notch of half its radius, supports at 0.8
diameters, by finite elements with rollers a twentieth of the radius wide: `python -m
rsmpm_ti.verify.reference.half_disc`. Only the pace of the test follows from it.

The same elements give K_I 3.8 % below `stress_intensity`, and 2.4 % with rollers half as wide: these take a little of
the bending."""

REACH = 8.0
"""Deflection at the end over that at which the toughness is expected to be reached."""


def semicircular_test(
    *,
    title: str,
    rock: Rock,
    dx: float,
    radius: float = 38e-3,
    notch: float | None = None,
    span: float | None = None,
    deflection_end: float | None = None,
    seeding: Lattice | Jittered | None = None,
    speed: float = 2e-3,
    time_scale: float | None = None,
    cfl: float = 1.0,
    output: Output | None = None,
) -> Scene:
    """Half a disc on two rollers, pressed in the middle of its arc; x = 0 is the middle, y = 0 the flat side.

    radius [m]; notch: its depth from the flat side [m], radius/2 by default, 3 dx wide with a round end; span: between
    the supports [m], 0.8 diameters by default; deflection_end: of the upper roller [m]. The nominal stress is the load
    over the diameter. Gauge `mouth`: crack mouth opening [m]. Raises SceneError.
    """
    notch = NOTCH_RATIO * radius if notch is None else notch
    span = 2.0 * SPAN * radius if span is None else span
    if not 0.0 < notch < 0.9 * radius:
        raise refuse("notch", notch, f"a depth in (0, 0.9 radius), radius = {radius} m")
    width, pad, room = NOTCH * dx, 0.5 * ROLLER * dx, 4.0 * dx
    arc = np.linspace(0.0, math.pi, CORNERS)
    half = Polygon(points=radius * np.stack([np.cos(arc), np.abs(np.sin(arc))], axis=1))
    below = 0.5 * width  # its lower end, which is rounded too, is no part of the half disc
    slit = Slit(centre=(0.0, 0.5 * (notch - below)), length=notch + below, width=width, angle=90.0, rounded=True)
    foot = 0.5 * width + dx
    expected = peak_load(rock, radius=radius, notch=notch, span=span) / (STIFFNESS * plane_modulus(rock))
    end, duration = REACH * expected if deflection_end is None else deflection_end, expected / speed
    mass = 0.5 * math.pi * radius**2 * rock.density
    period = 2.0 * math.pi * math.sqrt(0.5 * mass / (STIFFNESS * plane_modulus(rock)))
    rollers = (
        *(Platen(axis=1, side="lower", position=0.0, span=(x - pad, x + pad)) for x in (-0.5 * span, 0.5 * span)),
        Platen(axis=1, side="upper", position=radius, speed=-speed, span=(-pad, pad)),
    )
    return Scene(
        title=title,
        domain=Domain(lower=(-radius - room, -room), upper=(radius + room, radius + room), dx=dx),
        bodies=(Body(region=Difference(whole=half, removed=(slit,)), seeding=seeding or Lattice()),),
        rock=rock,
        loading=Loading(
            boundaries=rollers, start=Ramp(time=duration / 3.0),
            time_scale=time_scale or slow_time_scale(duration, period), servo=Servo(), local_damping=AUTO_DAMPING,
            cell=LoadCell(gauges=(Gauge(name="mouth", a=(-foot, 0.0), b=(foot, 0.0), reads="opening"),)),
            width=2.0 * radius,
        ),
        schedule=Schedule(strain_end=end / radius, cfl=cfl, stop_after_drop=0.97),
        output=output or Output(),
    )  # fmt: skip


def stress_intensity(load: float, *, radius: float, notch: float, span: float) -> float:
    """K_I [Pa m^0.5] of half a disc under a load [N/m]: Kuruppu et al. (2014), Rock Mech. Rock Eng. 47:267, eq. 7."""
    wide, depth = span / (2.0 * radius), notch / radius
    factor = -1.297 + 9.516 * wide - (0.47 + 16.457 * wide) * depth + (1.071 + 34.401 * wide) * depth**2
    return load * math.sqrt(math.pi * notch) / (2.0 * radius) * factor


def peak_load(rock: Rock, *, radius: float, notch: float, span: float) -> float:
    """Load [N/m] at which K_I reaches the toughness; of rock without a fracture energy that of a material length of a
    tenth of the radius."""
    softening = getattr(rock.after_failure, "softening", None)
    energy = softening.G_f_I if softening is not None else 0.0
    strength = rock.criterion.tensile_strength
    toughness = math.sqrt(energy * plane_modulus(rock)) if energy else strength * math.sqrt(0.1 * radius)
    return toughness / stress_intensity(1.0, radius=radius, notch=notch, span=span)
