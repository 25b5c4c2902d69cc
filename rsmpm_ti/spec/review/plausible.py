"""Input that no rock and no quasi-static test has: said in sentences, one a line, and not refused. No side effects.

Ranges are those of intact rock from chalk to quartzite. A value beyond them that another unit would bring back is said
to look like that unit; `blamed` adds such a cause to a refusal that comes of it.
"""

import dataclasses
import math
from dataclasses import dataclass, replace

from rsmpm_ti.checks import KNOWN, is_pressure, pressure_said, too_small
from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.bodies.rocks import named_rocks
from rsmpm_ti.spec.holes.excavation import excavations_of
from rsmpm_ti.spec.mass_scaling import estimate
from rsmpm_ti.spec.regions import Slit, removals_of


@dataclass(frozen=True)
class Range:
    """What rock has, in SI: from, to, a unit to show it in with its size, the source, and units it is mistaken for."""

    low: float
    high: float
    unit: str
    size: float
    source: str
    mistaken: tuple[tuple[str, float], ...] = ()

    def text(self) -> str:
        return f"{self.low / self.size:g} to {self.high / self.size:g} {self.unit}"


STRESS_UNITS = (("GPa", 1e9), ("MPa", 1e6), ("kPa", 1e3))
DEERE = "Deere & Miller (1966), AFWL-TR-65-116"
STRENGTH = "ISRM (1978), Int. J. Rock Mech. Min. Sci. 15:319, grades R0 to R6"
TOUGHNESS = "K_Ic^2/E with the K_Ic of Zhang (2002), Int. J. Rock Mech. Min. Sci. 39:401"
HANDBOOK = "Jaeger, Cook & Zimmerman (2007), Fundamentals of Rock Mechanics"

RANGES = {
    "E": Range(0.1e9, 150e9, "GPa", 1e9, DEERE, STRESS_UNITS[:2]),
    "nu": Range(0.0, 0.45, "", 1.0, "Gercek (2007), Int. J. Rock Mech. Min. Sci. 44:1"),
    "density": Range(1000.0, 5000.0, "kg/m^3", 1.0, "Schoen (2015), Physical Properties of Rocks", (("g/cm^3", 1e3),)),
    "cohesion": Range(0.05e6, 150e6, "MPa", 1e6, STRENGTH, STRESS_UNITS[1:]),
    "intact_strength": Range(0.25e6, 500e6, "MPa", 1e6, STRENGTH, STRESS_UNITS[1:]),
    "compressive_strength": Range(0.25e6, 500e6, "MPa", 1e6, STRENGTH, STRESS_UNITS[1:]),
    "tensile_strength": Range(0.02e6, 40e6, "MPa", 1e6, STRENGTH, STRESS_UNITS[1:]),
    "friction_angle": Range(10.0, 70.0, "degrees", 1.0, HANDBOOK, (("radians", 180.0 / math.pi),)),
    "residual_friction_angle": Range(10.0, 60.0, "degrees", 1.0, HANDBOOK, (("radians", 180.0 / math.pi),)),
    "G_f_I": Range(0.5, 1000.0, "J/m^2", 1.0, TOUGHNESS, (("N/mm", 1e3),)),
    "G_f_II": Range(0.5, 20000.0, "J/m^2", 1.0, TOUGHNESS, (("N/mm", 1e3),)),
}
"""By the name of the field, in whichever law of the rock it stands."""

UCS_RANGE = (0.25e6, 500e6)
"""Uniaxial compressive strength [Pa]: from the weakest of ISRM (1978) to the strongest quartzites and basalts."""

MODULUS_RATIO = (30.0, 3000.0)
"""E over uniaxial compressive strength: Deere & Miller (1966) call below 200 low and above 500 high."""

BRITTLENESS = (2.0, 100.0)
"""Uniaxial compressive over tensile strength: mostly 4 to 40 (Cai 2010, Rock Mech. Rock Eng. 43:167)."""

MOST_INERTIA = 0.2
"""Fraction of the load at first failure that inertia may be expected to add: see `mass_scaling.py`. Scenes that ship
have up to 0.11."""

DYNAMIC_RATE = 10.0
"""Strain rate, times time_scale, from which on tests are dynamic [1/s]: Zhang & Zhao (2014), Rock Mech. Rock Eng.
47:1411. A wave crosses a specimen of 10 cm once while it strains by 3e-4. It is for scenes without an estimate."""

FAR = 100.0
"""Times the end of a run, within which the failure that it misses is looked for."""

LEAST_ROWS = 10
"""Rows of the history up to the first failure that is expected: each then holds a tenth of the load, and the modulus is
a line through seven of them."""

WHOLE_ANGLE, NEAR = 5.0, 0.15
"""An angle that in degrees would be a multiple of 5, to as many digits as people type, may be in radians."""


def implausible(scene) -> list[str]:
    """All of it."""
    rock = [said for path, value, known in _known(scene) if (said := _outside(path, value, known))]
    ratios = [said for name, one in named_rocks(scene) for said in _ratios_said(name, one)]
    units = [*_pressures_said(scene, "loading", "output"), *_angles_said(scene)]
    return [*rock, *ratios, *units, *_loading_said(scene), *_overburden_said(scene), *_excavations_said(scene)]


def _excavations_said(scene) -> list[str]:
    """Those that come after the end, of a run that may go on later."""
    return [
        f"loading.holes[{k}].time = {hole.time:g} s comes after the end of the run, {scene.t_end:.4g} s"
        for k, hole in excavations_of(scene)
        if hole.time >= scene.t_end
    ]


def _known(scene) -> list[tuple[str, float, Range]]:
    """(dotted path, value, range) of every number of its rocks that has a range; 0 is a choice."""
    numbers = (number for name, rock in named_rocks(scene) for number in _numbers(name, rock))
    return [(path, value, RANGES[name]) for path, _, name, value in numbers if name in RANGES and value != 0.0]


def _pressures_said(scene, *parts: str) -> list[str]:
    """Pressures of its rocks, and of other parts of a scene, that have no range and look like megapascals."""
    things = [*named_rocks(scene), *((part, getattr(scene, part)) for part in parts)]
    numbers = (number for name, thing in things for number in _numbers(name, thing))
    small = [
        (path, value)
        for path, owner, name, value in numbers
        if name not in RANGES and too_small(value) and _is_pressure(owner, name)
    ]
    return [f"{path} = {pressure_said(value)}" for path, value in small]


def _angles_said(scene) -> list[str]:
    """Angles beside the rock that look like radians."""
    said = []
    for body in scene.bodies:
        for _, part in removals_of(body.region):
            angle = part.angle if isinstance(part, Slit) else 0.0
            degrees = math.degrees(angle)
            rest = abs(degrees - WHOLE_ANGLE * round(degrees / WHOLE_ANGLE))
            if abs(angle) <= 2.0 * math.pi and angle != round(angle) and rest < NEAR:
                said.append(f"slit.angle = {angle:g} degrees looks like radians: write {degrees:.3g}")
    return said


def blamed(error: SceneError, scene) -> SceneError:
    """A refusal, with what looks like another unit as its likely cause."""
    causes = [said for path, value, known in _known(scene) if (said := _mistaken(path, value, known))]
    causes += [*_pressures_said(scene, "loading"), *_angles_said(scene)]
    new = [said for said in causes if said not in str(error)]
    return SceneError(f"{error}; likely cause: {'; '.join(new)}") if new else error


def _numbers(path: str, thing):
    """(dotted path, class, field, value) of every number of a dataclass, however deep; of a table its largest."""
    for field in dataclasses.fields(thing):
        value, place = getattr(thing, field.name), f"{path}.{field.name}"
        entries = tuple(enumerate(value)) if isinstance(value, tuple) else ()
        for deeper, inner in ((place, value), *((f"{place}.{k}", entry) for k, entry in entries)):
            if dataclasses.is_dataclass(inner):
                yield from _numbers(deeper, inner)
        table = bool(entries) and all(type(entry) in (int, float) for _, entry in entries)
        if type(value) in (int, float) or table:
            yield place, type(thing), field.name, float(max(value, key=abs) if table else value)


def _is_pressure(kind: type, name: str) -> bool:
    """Of laws of a scene's own nothing is known."""
    return KNOWN.get(kind.__name__) is kind and is_pressure(kind, name)


def _mistaken(path: str, value: float, rock: Range) -> str:
    """Which unit it may be in; nothing if it is within the range, or in no unit."""
    if rock.low <= value <= rock.high:
        return ""
    for unit, size in rock.mistaken:
        if rock.low <= value * size <= rock.high:
            return f"{path} = {_si(value, rock)} looks like {unit}: write {_number(value, size)} or '{value:g} {unit}'"
    return ""


def _number(value: float, size: float) -> str:
    """17 in GPa as one would write it in SI: 17e9, and of angles and densities the number itself."""
    power = round(math.log10(size))
    by_power = power >= 6 and value < 1000.0 and math.isclose(size, 10.0**power)
    return f"{value:g}e{power}" if by_power else f"{value * size:.4g}"


def _si(value: float, rock: Range) -> str:
    unit = {"GPa": "Pa", "MPa": "Pa"}.get(rock.unit, rock.unit)
    return f"{value:g} {unit}".strip()


def _outside(path: str, value: float, rock: Range) -> str:
    if rock.low <= value <= rock.high:
        return ""
    return _mistaken(path, value, rock) or f"{path} = {_si(value, rock)} is not rock's, {rock.text()} ({rock.source})"


def _ratios_said(name: str, rock) -> list[str]:
    """Strengths and moduli against each other. Laws of a scene's own may lack some. name: of the rock in messages."""
    ucs, tensile = (getattr(rock.criterion, name, None) for name in ("ucs", "tensile_strength"))
    young = getattr(rock.elasticity, "E", None)
    said = []
    if ucs and not UCS_RANGE[0] <= ucs <= UCS_RANGE[1]:
        allowed = f"{UCS_RANGE[0] / 1e6:g} to {UCS_RANGE[1] / 1e6:g} MPa"
        strength = f"a uniaxial strength of {ucs / 1e6:.4g} MPa"
        said.append(f"{name}.criterion: {strength} is not rock's, {allowed} ({STRENGTH})")
    if ucs and tensile and not BRITTLENESS[0] <= ucs / tensile <= BRITTLENESS[1]:
        said.append(
            f"{name}.criterion: its compressive over its tensile strength is {ucs / tensile:.3g}; rock's is "
            f"{BRITTLENESS[0]:g} to {BRITTLENESS[1]:g} (Cai 2010)"
        )
    if ucs and young and not MODULUS_RATIO[0] <= young / ucs <= MODULUS_RATIO[1]:
        said.append(
            f"{name}: E over its uniaxial strength is {young / ucs:.3g}; rock's is {MODULUS_RATIO[0]:g} to "
            f"{MODULUS_RATIO[1]:g} (Deere & Miller 1966)"
        )
    return said


def _overburden_said(scene) -> list[str]:
    """The rock above that presses at the start, and nothing that goes on pressing."""
    ground = scene.loading.initial_stress
    if ground is None or ground.overburden <= 0.0:
        return []
    held = {boundary.side for boundary in scene.loading.boundaries if boundary.axis == ground.axis}
    if len(held) == 2:
        return []
    return [
        f"loading.initial_stress.overburden = {ground.overburden / 1e6:g} MPa presses at the start and nothing does "
        f"afterwards: the free side springs up; give it a platen of the same stress, or a wall"
    ]


def _ends_before_failure(scene) -> list[str]:
    """A test of rock that may break, too short for it."""
    if scene.schedule.strain_end is None or not getattr(scene.rock.criterion, "breaks", False):
        return []
    try:
        later = estimate(replace(scene, schedule=replace(scene.schedule, strain_end=FAR * scene.schedule.strain_end)))
    except (ValueError, AttributeError, ArithmeticError):
        return []
    end = abs(scene.schedule.strain_end)
    if not end < later.strain < 0.999 * FAR * end:
        return []
    return [
        f"the first failure is expected at a strain of {later.strain:.3g} ({later.stress / 1e6:.4g} MPa), and the run "
        f"ends at {end:.3g}: raise schedule.strain_end"
    ]


def _loading_said(scene) -> list[str]:
    """Tests that are too fast, and histories that are too coarse."""
    loading = scene.loading
    if loading.platens is None or not loading.height > 0.0 or loading.strain_rate == 0.0:
        return []
    try:
        expected = estimate(scene)
        inertia = expected.error(scene.time_scale)
        reached = expected.strain_rate * scene.t_end
        breaks = expected.strain < 0.999 * reached
    # not a test that it knows, or laws of a scene's own that lack what it asks for
    except (ValueError, AttributeError, ArithmeticError):
        breaks = False
    if not breaks:
        rate = abs(loading.strain_rate) * scene.time_scale
        slower = "lower the platens' speed or loading.time_scale"
        fast = f"the strain rate of {rate:.3g} 1/s (with time_scale = {scene.time_scale:g}) is that of a dynamic test"
        said = [f"{fast}, above {DYNAMIC_RATE:g} (Zhang & Zhao 2014); {slower}"] if rate > DYNAMIC_RATE else []
        return [*said, *_ends_before_failure(scene)]
    said = []
    if inertia > MOST_INERTIA:
        said.append(
            f"the strain rate of {expected.strain_rate:.3g} 1/s with time_scale = {scene.time_scale:g} is no "
            f"quasi-static test: inertia is expected to add up to {100.0 * inertia:.3g} % to the load at first failure "
            f"(above {100.0 * MOST_INERTIA:g} %); lower the platens' speed or loading.time_scale"
        )
    row = expected.strain_rate * scene.row_steps * scene.dt
    if row * LEAST_ROWS > expected.strain:
        said.append(
            f"a history row holds a strain of {row:.3g}, and the first failure is expected at {expected.strain:.3g}: "
            f"fewer than {LEAST_ROWS} rows before it show no peak; raise schedule.rows to "
            f"{math.ceil(scene.steps * scene.dt * expected.strain_rate * LEAST_ROWS / expected.strain)} or more"
        )
    return said
