"""Three-point bending of a beam, with or without a notch in the middle of its lower side."""

import math

from rsmpm_ti.errors import refuse
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.setups.slow import slow_time_scale
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING, Servo
from rsmpm_ti.spec.regions import Box, Difference, Slit
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered, Lattice

ROLLER = 2
"""Cells on which a roller presses: three nodes. Wider ones take some of the bending."""

NOTCH = 3
"""Cells between the faces of a notch, unless they are told: fewer do not part (`spec/review/slit_check.py`)."""

REACH = 4.0
"""Deflection at the end over that at which the toughness is expected to be reached: a beam of two characteristic
lengths is then broken through."""

SERVO = Servo()
"""It slows the upper roller while the beam breaks."""

OVERHANG = 0.15
"""Length of the beam beyond each support, over its depth."""


def bending_test(
    *,
    title: str,
    rock: Rock,
    dx: float,
    depth: float = 50e-3,
    span: float | None = None,
    notch: float = 0.0,
    notch_width: float | None = None,
    deflection_end: float | None = None,
    deflection_peak: float | None = None,
    gauge_length: float | None = None,
    seeding: Lattice | Jittered | None = None,
    speed: float = 2e-3,
    time_scale: float | None = None,
    servo: Servo | None = SERVO,
    cfl: float = 1.0,
    output: Output | None = None,
) -> Scene:
    """A beam on two rollers, pressed by a third in the middle of its upper side; x = 0 is the middle, y = 0 the lower
    side. Plane strain, unit thickness.

    depth, span: of the beam and between its supports [m], span 4 depth by default; notch: its depth [m], its faces
    notch_width apart, 3 dx by default, its end rounded; deflection_end: of the upper roller [m]; speed: its own [m/s],
    which it reaches in a third of the time to the peak. deflection_peak: its deflection there [m], `peak_deflection` by
    default, which is too little where strength is lost over more than the ligament. time_scale: by default such that
    the load comes slowly (`setups/slow.py`). servo: None where a beam breaks slowly by itself.

    The nominal stress is 3 P S / (2 b^2), that of beam theory at the lower side, with the ligament b over the notch.
    A notched beam has the gauge `mouth`, its crack mouth opening [m], over `gauge_length` [m], by default notch_width
    and two cells. Raises SceneError.
    """
    span = 4.0 * depth if span is None else span
    width = NOTCH * dx if notch_width is None else notch_width
    if not 0.0 <= notch < 0.9 * depth:
        raise refuse("notch", notch, f"a depth in [0, 0.9 depth), depth = {depth} m")
    half, room = 0.5 * span + OVERHANG * depth, 4.0 * dx
    half = dx * math.ceil(half / dx - 1e-9)
    beam, pad, ligament = Box(lower=(-half, 0.0), upper=(half, depth)), 0.5 * ROLLER * dx, depth - notch
    flaws, gauges = (), ()
    if notch:
        below = 0.5 * width  # so that its lower end, which is rounded too, is no part of the beam
        flaws = (
            Slit(centre=(0.0, 0.5 * (notch - below)), length=notch + below, width=width, angle=90.0, rounded=True),
        )
        foot = 0.5 * width + dx if gauge_length is None else 0.5 * gauge_length
        gauges = (Gauge(name="mouth", a=(-foot, 0.0), b=(foot, 0.0), reads="opening"),)
    expected = peak_deflection(rock, depth=depth, span=span, notch=notch)
    end = REACH * expected if deflection_end is None else deflection_end
    duration = (expected if deflection_peak is None else deflection_peak) / speed
    scale = time_scale or slow_time_scale(duration, period(rock, depth=depth, span=span, notch=notch))
    rollers = (
        *(
            Platen(axis=1, side="lower", position=0.0, span=(x - pad, x + pad))
            for x in (-0.5 * span, 0.5 * span)
        ),
        Platen(axis=1, side="upper", position=depth, speed=-speed, span=(-pad, pad)),
    )  # fmt: skip
    return Scene(
        title=title,
        domain=Domain(lower=(-half - room, -room), upper=(half + room, depth + room), dx=dx),
        bodies=(Body(region=Difference(whole=beam, removed=flaws) if flaws else beam, seeding=seeding or Lattice()),),
        rock=rock,
        loading=Loading(
            boundaries=rollers, start=Ramp(time=duration / 3.0), time_scale=scale, servo=servo,
            local_damping=AUTO_DAMPING, cell=LoadCell(gauges=gauges), width=2.0 * ligament**2 / (3.0 * span),
        ),
        schedule=Schedule(strain_end=end / depth, cfl=cfl, stop_after_drop=0.97),
        transfer=PicFlip(),
        output=output or Output(),
    )  # fmt: skip


def peak_load(rock: Rock, *, depth: float, span: float, notch: float) -> float:
    """Least of the loads [N/m] at which beam theory reaches the tensile strength and, with a notch and a fracture
    energy, linear fracture mechanics the toughness."""
    strength = rock.criterion.tensile_strength
    loads = [2.0 * strength * (depth - notch) ** 2 / (3.0 * span)]
    softening = getattr(rock.after_failure, "softening", None)
    energy = softening.G_f_I if softening is not None else 0.0
    if notch and energy:
        toughness = math.sqrt(energy * plane_modulus(rock))
        loads.append(toughness * depth**1.5 / (span * shape_factor(notch / depth)))
    return min(loads)


def peak_deflection(rock: Rock, *, depth: float, span: float, notch: float) -> float:
    """Of the upper roller at `peak_load` [m]: bending, shear, and what the notch adds (Tada, Paris & Irwin 2000, The
    Stress Analysis of Cracks Handbook, 3rd ed., 2.16: for span = 4 depth)."""
    load, modulus = peak_load(rock, depth=depth, span=span, notch=notch), plane_modulus(rock)
    slender = span / depth
    shear = 1.0 + 2.4 * (1.0 + rock.elasticity.nu) / slender**2
    ratio = notch / depth
    v_2 = (ratio / (1.0 - ratio)) ** 2 * (5.58 - 19.57 * ratio + 36.82 * ratio**2 - 34.94 * ratio**3 + 12.77 * ratio**4)
    return load / modulus * (0.25 * slender**3 * shear + 1.5 * slender**2 * v_2)


def shape_factor(ratio: float) -> float:
    """f of K_I = P S / W^1.5 f(a/W) for a beam with S = 4 W, within 0.5 % at any depth a of its notch: Srawley (1976),
    Int. J. Fracture 12:475; ASTM E399."""
    x = ratio
    top = 3.0 * math.sqrt(x) * (1.99 - x * (1.0 - x) * (2.15 - 3.93 * x + 2.7 * x * x))
    return top / (2.0 * (1.0 + 2.0 * x) * (1.0 - x) ** 1.5)


def period(rock: Rock, *, depth: float, span: float, notch: float) -> float:
    """Of the beam's first swing [s]: half of its mass moves on the spring that the upper roller feels (Rayleigh)."""
    load = peak_load(rock, depth=depth, span=span, notch=notch)
    stiffness = load / peak_deflection(rock, depth=depth, span=span, notch=notch)
    return 2.0 * math.pi * math.sqrt(17.0 / 35.0 * rock.density * span * depth / stiffness)


def plane_modulus(rock: Rock) -> float:
    elasticity = rock.elasticity
    return elasticity.E / (1.0 if elasticity.plane_stress else 1.0 - elasticity.nu**2)
