"""Bad input, made from the annotations of the classes a scene is built of, and what must be true of a scene that runs.

Nothing here lists fields: a class that a recorded scene may name, and a field it gets, is attacked by being there.
"""

import contextlib
import dataclasses
import decimal
import functools
import itertools
import json
import math
import re
import signal
import time
import typing
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from rsmpm_ti.checks import KNOWN
from rsmpm_ti.errors import SceneError
from rsmpm_ti.fields.state import initial_velocity
from rsmpm_ti.output.pictures import load_limits, stress_limit
from rsmpm_ti.rock.curved.fairhurst import Fairhurst
from rsmpm_ti.rock.curved.hoek_brown import HoekBrown
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.ground.gravity import Gravity
from rsmpm_ti.spec.ground.in_situ import InSitu
from rsmpm_ti.spec.holes.excavation import Excavation
from rsmpm_ti.spec.holes.pressure import HolePressure
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loader import load_scene
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.quasi_static.servo import Servo
from rsmpm_ti.spec.regions import Box, Difference
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.scene_json import from_plain, to_plain
from rsmpm_ti.units import Unit, quantity

NAN, INF = math.nan, math.inf
NUMBERS = (
    NAN, INF, -INF, 0.0, -0.0, 1e-200, 1e-30, 1e-13, -1.0, -1e-9, 0.5, 1.0, 89.99999999,
    90.0, 1e6, 1e13, 1e30, 1e154, 1e200, 1e308, -1e308, 3, -1, 0, 2**31, 2**63, 10**400, 10**5000,
)  # fmt: skip
SUBNORMAL = (5e-324, -5e-324, 1e-308)
"""Numbers that a thread in which a kernel of Taichi has run reads from a text as 0: there no record can hold them."""

WORDS = (
    "", "1", "nan", "x" * 100_000, "none", "a\nb", "\x00", "\x1b[2J", "\ud800", "\u202edx", "__import__('os')._exit(7)",
    "$\\frac{", "../../x", "Lower", "{0}", "%s",
)  # fmt: skip
THINGS = (
    None, True, False, (), (NAN, 0.0), (0.0, INF), (1e308, -1e308), (0.0,), (0.0,) * 7, (True, False), ("a", "b"),
    (None,), ((0.0, 1.0), (0.0, 1.0)), (0.3, 0.2), [0.0, 1.0], {}, {"type": "Box"}, 1j, b"1", decimal.Decimal(1),
    np.float32(1.0), np.int64(3), np.array([0.0, 1.0]), object(), SimpleNamespace(), float, Hooke, math.sin, range(3),
)  # fmt: skip

DRAWINGS = Path(__file__).parent / "spec" / "drawings"

GIVEN = {
    "angle": 30.0, "axis": 1, "centre": (0.025, 0.05), "dx": 2e-3, "length": 0.02, "lower": (0.01, 0.02), "nu": 0.2,
    "position": 0.1, "radius": 0.01, "side": "upper", "speed": -2.5e-3, "time": 2e-3, "title": "a", "width": 6e-3,
    "upper": (0.04, 0.08), "E": 17e9, "density": 2600.0, "cohesion": 6e6, "friction_angle": 40.0, "shape": 6.0,
    "tensile_strength": 2e6, "reference_volume": 1e-5, "G_f_I": 5.0, "G_f_II": 24.0, "tension_limit": 1.0,
    "compression_limit": 1e9, "times": (1e-3, 2e-3), "factors": (1.0, 0.5), "pressures": (1e6, 0.0),
    "parts": (Box(lower=(0.01, 0.02), upper=(0.04, 0.08)),), "region": Box(lower=(0.015, 0.03), upper=(0.035, 0.07)),
    "points": ((0.01, 0.02), (0.04, 0.02), (0.025, 0.08)), "traces": ((0.02, 0.04, 0.03, 0.06, 6e-3),),
    "image": str(DRAWINGS / "section.png"), "mm_per_pixel": 1.0, "greys": (0, 100),
    "file": str(DRAWINGS / "plate.msh"),
}  # fmt: skip
"""A good value for every field without a default, by its name."""


CORNER = Box(lower=(0.0,) * 3, upper=(0.004,) * 3)


@functools.cache
def bases() -> list[Scene]:
    """Small scenes in which together every class can stand."""
    plain = load_scene("cube", turn=0.0, dx=2e-3, flaw_width=6e-3)  # walls and clamps need planes of nodes
    lab = load_scene("cube_lab", dx=1e-3, length=2e-3)
    little = Box(lower=(0.0, 0.04), upper=(0.01, 0.06))
    lab = replace(lab, bodies=(replace(lab.bodies[0], region=little),))
    gauged = LoadCell(gauges=(Gauge(name="mouth", a=(0.02, 0.02), b=(0.02, 0.08)),))
    timed = replace(plain, schedule=Schedule(t_end=1e-2), loading=replace(plain.loading, start=AtRest(), cell=gauged))
    block = Body(region=Box(lower=(0.0,) * 3, upper=(0.01,) * 3))
    solid = Scene(
        title="solid", domain=Domain(lower=(0.0,) * 3, upper=(0.012,) * 3, dx=2e-3), bodies=(block,), rock=plain.rock,
        loading=Loading(), schedule=Schedule(t_end=1e-5),
    )  # fmt: skip
    stress, weight = InSitu(axis=2, surface=0.02, K0=0.5), Gravity(b=(0.0, 0.0, -1.0), ramp=1e-4)
    ground = replace(solid, loading=Loading(initial_stress=stress, force_field=weight, body_force=(0.0, 0.0, -9.81)))
    steered = replace(lab, schedule=Schedule(t_end=1e-2), loading=replace(lab.loading, servo=Servo()))
    above = Body(
        region=Box(lower=(0.0, 0.0, 0.01), upper=(0.01, 0.01, 0.012)), rock=replace(plain.rock, density=2700.0)
    )
    mixed = replace(solid, bodies=(block, above))
    hole = Box(lower=(0.02, 0.02), upper=(0.03, 0.04))
    drilled = replace(plain.bodies[0], region=Difference(whole=plain.bodies[0].region, removed=(hole,)))
    pressed = HolePressure(region=hole, times=(1e-3, 2e-3), pressures=(1e6, 0.0))
    blasted = replace(timed, bodies=(drilled,), loading=replace(timed.loading, holes=(pressed,)))
    dug = replace(ground, loading=replace(ground.loading, holes=(Excavation(region=CORNER, time=1e-6),)))
    curved = replace(plain.rock, criterion=HoekBrown(intact_strength=25e6, m=10.0, tensile_strength=2e6))
    hybrid = replace(plain.rock, criterion=Fairhurst(compressive_strength=25e6, tensile_strength=2e6))
    bent = [replace(plain, rock=rock) for rock in (curved, hybrid)]
    return [plain, timed, lab, steered, solid, ground, mixed, blasted, dug, *bent]


def at(thing, path: list):
    """The value at a path of field names and indices."""
    for step in path:
        thing = thing[step] if isinstance(step, int) else getattr(thing, step)
    return thing


def put(thing, path: list, value):
    """A copy with the value at a path replaced: every owner on the way is built, and so checked, again."""
    if not path:
        return value
    step, *rest = path
    if isinstance(step, int):
        return (*thing[:step], put(thing[step], rest, value), *thing[step + 1 :])
    return replace(thing, **{step: put(getattr(thing, step), rest, value)})


def positions(thing, path: tuple = ()):
    """Every path below a value of a scene, with the annotation of what stands there."""
    for field in dataclasses.fields(thing):
        wanted = typing.get_type_hints(type(thing))[field.name]
        here, value = (*path, field.name), getattr(thing, field.name)
        yield here, wanted
        if isinstance(value, tuple):
            for k, entry in enumerate(value):
                yield (*here, k), wanted
                if dataclasses.is_dataclass(entry):
                    yield from positions(entry, (*here, k))
        elif dataclasses.is_dataclass(value):
            yield from positions(value, here)


def mentioned(wanted) -> set:
    """Every class in an annotation, however deep."""
    inner = typing.get_args(wanted)
    return set().union(*map(mentioned, inner)) if inner else {wanted}


@functools.cache
def home(kind: type) -> tuple[Scene, list]:
    """A scene that runs with an object of a class in it, and the path to that object. Fails where there is none."""
    for scene in bases():
        if kind is Scene:
            return scene, []
        for path, _ in positions(scene):
            if type(at(scene, path)) is kind:
                return scene, list(path)
    required = [f.name for f in dataclasses.fields(kind) if f.default is f.default_factory is dataclasses.MISSING]
    sample = kind(**{name: GIVEN[name] for name in required})
    for scene in bases():
        for path, wanted in positions(scene):
            if kind in mentioned(wanted) and dataclasses.is_dataclass(at(scene, path)):
                with contextlib.suppress(SceneError):
                    changed = put(scene, list(path), sample)
                    changed.particles()
                    return changed, list(path)
    raise LookupError(f"no scene of tests/hostile.py can hold a {kind.__name__}; give it one")


def strangers(wanted) -> tuple:
    """One object of every class that an annotation does not name."""
    return tuple(at(*home(kind)) for kind in KNOWN.values() if kind not in mentioned(wanted))


def attacks(kind: type):
    """(field name, bad or extreme value) for every field of a class."""
    for field in dataclasses.fields(kind):
        wanted = typing.get_type_hints(kind)[field.name]
        foreign = itertools.islice(strangers(wanted), 0, None, 7)
        small = SUBNORMAL if float("5e-324") else ()
        yield from ((field.name, value) for value in itertools.chain(NUMBERS, small, WORDS, THINGS, foreign))


LIMIT_S, HANG_S = 1.0, 30.0
"""What one refusal may cost of a processor, which a busy machine does not lengthen; and when a test is ended."""


@contextlib.contextmanager
def quickly():
    """Fails what takes more than LIMIT_S of processor time, and ends what hangs."""

    def stop(*_):
        raise TimeoutError(f"hung for {HANG_S} s")

    old = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, HANG_S)
    start = time.thread_time()
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, old)
    took = time.thread_time() - start
    assert took < LIMIT_S, f"took {took:.2f} s"


def clear(message: str) -> bool:
    """Whether a refusal is one line of bounded length that says what it is about."""
    return 10 < len(message) < 1500 and message.isprintable()


def numbers_of(thing):
    """(place, number) of every number in data and every number that its classes derive from it."""
    if dataclasses.is_dataclass(thing):
        kind = type(thing)
        derived = [n for n in dir(kind) if isinstance(getattr(kind, n), property)]
        for name in (*(f.name for f in dataclasses.fields(thing)), *derived):
            if isinstance(thing, Loading) and name in ("height", "strain_rate") and thing.platens is None:
                continue
            for position, number in numbers_of(getattr(thing, name)):
                yield f"{kind.__name__}.{name}{position}", number
    elif isinstance(thing, (tuple, list)):
        for k, entry in enumerate(thing):
            yield from ((f"[{k}]{position}", number) for position, number in numbers_of(entry))
    elif isinstance(thing, (int, float)) and not isinstance(thing, bool):
        yield "", thing


SEEDED = 200_000
"""Particles above which an accepted scene is believed to hold them: a fine grid is a fair request that takes long."""


def check_runnable(scene: Scene) -> None:
    """Independent of the code's own checks: an accepted scene is one whose every number means something."""
    for position, number in numbers_of(scene):
        free = position.endswith("MohrCoulomb.apex")  # the cone of a frictionless rock has none
        assert math.isfinite(number) or free, f"{position} = {number}"
    rock = scene.rock
    E, nu = rock.elasticity.E, rock.elasticity.nu
    stiffness = E / (1 - nu**2) if rock.elasticity.plane_stress else E * (1 - nu) / ((1 + nu) * (1 - 2 * nu))
    speed = math.sqrt(stiffness / rock.density) / scene.loading.time_scale
    assert speed > 0.0 and math.isclose(scene.wave_speed, speed, rel_tol=1e-6)
    assert rock.density > 0.0 and scene.density > 0.0
    assert 0.0 < scene.dt * speed / scene.domain.dx < 2.0
    assert 1 <= scene.steps <= 2**31 and abs(scene.steps * scene.dt - scene.t_end) <= scene.dt * 1.001
    edges = [b - a for a, b in zip(scene.domain.lower, scene.domain.upper, strict=True)]
    nodes = math.prod(edge / scene.domain.dx + 7 for edge in edges)
    assert nodes < 2**33
    far = max(map(abs, (*scene.domain.lower, *scene.domain.upper)))
    assert far + 0.01 * scene.domain.dx > far  # a hundredth of a cell is not lost in the coordinates
    for boundary in scene.loading.boundaries:
        assert abs(boundary.speed) * scene.dt < 0.5 * scene.domain.dx
    volume = 0.0
    for body in scene.bodies:
        low, high = body.region.bounds()
        volume += math.prod(high - low)
    per_axis = max(body.seeding.particles_per_axis for body in scene.bodies)
    assert stress_limit(scene, None) > 0.0 and all(v is None or 0.0 < v < INF for v in load_limits(scene, volume))
    assert from_plain(json.loads(json.dumps(to_plain(scene), allow_nan=False))) == scene
    assert len(scene.title.encode("utf-8")) <= 1000 and scene.title.isprintable()
    if volume * (per_axis / scene.domain.dx) ** scene.dim < SEEDED:
        check_seeds(scene)


def check_seeds(scene: Scene) -> None:
    """Particles, their strength and their velocities at the start."""
    for k, seeds in enumerate(scene.particles()):
        assert len(seeds.x) and np.isfinite(seeds.x).all()
        assert (seeds.volume > 0.0).all() and (seeds.volume > 1e-3 * seeds.volume.max()).all()
        factors = scene.rock.heterogeneity.factors(seeds.x, seeds.volume)
        assert np.isfinite(factors).all() and (factors > 0.0).all()
        velocity = initial_velocity(scene, k, seeds.x)
        assert np.abs(velocity).max() * scene.dt < scene.domain.dx


quantity("1 mm", Unit("m"))  # pint takes half a second to load, which no refusal is blamed for


def says(message: str, field: str) -> bool:
    """Whether a refusal names a field."""
    return field in re.findall(r"\w+", message)


def names_below(value, prefix: str = "") -> list[str]:
    """Every dotted name below a value of a scene."""
    if dataclasses.is_dataclass(value):
        children = {f.name: getattr(value, f.name) for f in dataclasses.fields(value)}
    elif isinstance(value, tuple):
        children = {str(k): v for k, v in enumerate(value)}
    else:
        return []
    return [name for k, v in children.items() for name in (prefix + k, *names_below(v, f"{prefix}{k}."))]


def reading(text: str, value) -> bool:
    """Whether a text of the command line means a value, read here without the code's own reader."""
    if isinstance(value, bool) or value is None:
        return text.lower() == str(value).lower()
    if isinstance(value, tuple):
        return [number_of(part) for part in text.strip("()").split(",") if part.strip()] == list(value)
    if dataclasses.is_dataclass(value):
        return text == type(value).__name__
    return text == value if isinstance(value, str) else type(value)(number_of(text)) == value


def number_of(text: str) -> float:
    return IN_SI[text] if text in IN_SI else float(text)


IN_SI = {
    "2mm": 2e-3,
    "1cm": 0.01,
    "15mm": 0.015,
    "1 cm": 0.01,
    "30 deg": 30.0,
    "2 MPa": 2e6,
    "1 ms": 1e-3,
    "2.6 g/cm^3": 2600.0,
    "20 deg/s": math.pi / 9,
    "5 %": 0.05,
}
"""Texts with a unit or a sign, and the number that a field of their dimension holds then: angles stay in degrees."""


LARGE = ("dx", "particles_per_axis")
"""Names whose values decide how many particles are seeded."""

TEXTS = (
    "nan", "inf", "-inf", "0", "-0.0", "5e-324", "1e-308", "1e-30", "-1", "0.5", "1", "2", "89.9999999999", "1e13",
    "1e154", "1e308", "1e999", "-1e308", "9" * 400, "9" * 5000, "0x10", "1e", "1_0", "１", "None", "true", "False",
    "none", "", "1,2", "nan,0", "1,2,3", "()", "(0,0", "1;2", "x" * 10_000, "a\nb", "\x00", "\x1b[2J", "\ud800",
    *IN_SI, "2mm,1cm", "1e", "1 nosuch", "1 m^9^9^9^9", "1e999 m", "1e4000 km", "9" * 400 + "m", "m",
    "1" + "m" * 10_000,
    "__import__('os')", "lambda: 0", "../../etc", "$\\frac{", "{}", "%s", "==", "usl", "sparse", *KNOWN,
)  # fmt: skip

TOKENS = (
    "NaN", "Infinity", "-Infinity", "1e999", "0", "-1", "-0.0", "5e-324", "1e-30", "1e154", "1e308", "1.5", "9" * 400,
    "9" * 5000, "true", "null", '"1"', '""', '"\\ud800"', '"a\\nb"', "[]", "[NaN, 0]", "[[1, 2], [3, 4]]", "[null]",
    "{}",     '{"type": "Box"}', '{"type": "os.system", "command": "x"}', '{"__reduce__": ["os.system", ["x"]]}',
    '{"type": []}',     "\"__import__('os')._exit(7)\"", "[" * 50_000, "[" * 400 + "]" * 400, "", "1 2", "'x'", "nan",
    '"' + "x" * 9999 + '"', '{"type": "Void"}', '{"type": "Schedule"}', '{"type": "Lattice"}', '{"type": "Loading"}',
)  # fmt: skip
