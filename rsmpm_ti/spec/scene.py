"""What a scene is: frozen data, checked once, here. Kernels trust it. SI units; angles in degrees.

(`rsmpm_ti.scene` is the command line: it runs as `__main__`, and a dataclass defined there would exist twice.)
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Literal

from annotated_types import Interval, Len

from rsmpm_ti.checks import MAX_SIZE, ByType, Finite, NotNegative, Positive, Remedy, checked
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.time_step import MIN_CFL, check_step
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.heterogeneity import check_scale
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.bodies.rocks import check_each_rock, check_histories, check_rocks, rocks_of
from rsmpm_ti.spec.bodies.seeds import seeds_of
from rsmpm_ti.spec.boundaries import Absorbing, Fixed, Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.ground.gravity import ForceField, Gravity, check_gravity
from rsmpm_ti.spec.ground.in_situ import InSitu, check_initial_stress
from rsmpm_ti.spec.ground.settling import check_settling
from rsmpm_ti.spec.holes.excavation import Excavation
from rsmpm_ti.spec.holes.pressure import HolePressure, check_holes
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Affine, AtRest, Press, Program, Ramp
from rsmpm_ti.spec.mass_scaling import MAX_TIME_SCALE, estimate
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING, Servo, check_quasi_static
from rsmpm_ti.spec.regions import Region
from rsmpm_ti.spec.review.plausible import blamed
from rsmpm_ti.spec.review.unchecked import UNCHECKED
from rsmpm_ti.spec.scene_checks import check_bodies, check_cracks, check_loading, check_motion, check_stop
from rsmpm_ti.spec.seeding import Jittered, Lattice, Seeds
from rsmpm_ti.units import Acceleration, LengthOrArea, Pressure, Spin, Time, Velocity

MAX_BOUNDARIES, MAX_BODIES = 32, 5000

TimeScale = Annotated[float, Interval(ge=1.0, le=MAX_TIME_SCALE)] | Literal["auto"]

DEFAULT_ROWS, LEAST_ROWS = 1000, 200
"""Rows of a history where nobody says how many: of a long run, and of one too short for that many. A peak is then read
to within 1/200 of the strain."""

ROW_STEPS = 20
"""Steps between two rows unless there were too few rows. `python -m rsmpm_ti.bench passes`: with a row each, a step
takes 1.8 (B-splines) to 2.3 (linear) times as long, with one every ten 1.06 to 1.08, every twenty 1.01 to 1.04."""


@checked("body")
@dataclass(frozen=True, kw_only=True)
class Body:
    """Material that fills a region. Initial velocity [m/s] and, in the x-y plane, spin [rad/s] about its centre.

    rock: of this body where it is not the scene's. Bodies that touch are bonded. They must not overlap: an inclusion
    is a body, and so is the rest, a `Difference` of the whole and the inclusion's region.
    """

    region: Region
    rock: Rock | None = None
    seeding: Annotated[Lattice | Jittered, ByType] = Lattice()
    velocity: tuple[Annotated[Velocity, Finite], ...] | None = None
    spin: Annotated[Spin, Finite] = 0.0


Boundary = Platen | Wall | Fixed | Absorbing


@checked("loading")
@dataclass(frozen=True, kw_only=True)
class Loading:
    """What drives the scene.

    time_scale k multiplies the density by k^2 (mass scaling), so a quasi-static run takes 1/k of the steps. 'auto' is
    the largest k at which inertia is expected to make up at most `quasi_static` of the load at first failure: see
    `mass_scaling.py`, and `Scene.time_scale` for the number.
    `width` is the loaded length [m] (area [m^2] in 3D) by which platen forces become nominal stress.
    body_force is an acceleration [m/s^2]; mass scaling leaves the force it makes unchanged. `force_field` is one that
    depends on place and time: `Gravity`, or an object with a ti.func `acceleration(X, t)` of a particle's initial
    position [m] and the time [s]. A scene file brings its own, so a scene with one of these cannot be run again from
    its record.
    confinement is a pressure [Pa] on every free surface, in which bodies start at rest (see `confinement.py`).
    initial_stress is that of rock in the ground (see `ground/in_situ.py`). settle: bodies first come to rest under
    what loads them at time 0, and only then the clock starts (see `ground/settling.py`).
    servo: slows the platens while rock breaks (see `quasi_static/servo.py`). local_damping: force against the motion
    over the force out of balance (see `mpm/local_damping.py`). With time_scale = 'auto', which looks no further than
    the first failure, there are both unless they are given, so that it holds to the end.
    cell: what is measured, and gauges; what it leaves open comes from the platens (see `load_cell.py`).
    holes: pressures on the walls of holes (`holes/pressure.py`), and rock that is excavated (`holes/excavation.py`).
    """

    boundaries: Annotated[
        tuple[Annotated[Boundary, ByType], ...],
        Len(0, MAX_BOUNDARIES),
        Remedy("every kernel holds code for each"),
    ] = ()
    start: Annotated[Affine | Ramp | Press | Program | AtRest, ByType] = AtRest()
    time_scale: TimeScale = 1.0
    quasi_static: Annotated[float, Interval(ge=1e-6, le=1.0), Remedy("it is a fraction of the load")] = 0.01
    body_force: tuple[Annotated[Acceleration, Finite], ...] | None = None
    force_field: Annotated[
        Gravity | object | None, ForceField, Remedy("an object of your own has a ti.func acceleration(X, t)")
    ] = None
    width: Annotated[LengthOrArea, Positive] | None = None
    confinement: Annotated[Pressure, NotNegative, Remedy("it is compression positive")] = 0.0
    cell: LoadCell = LoadCell()
    initial_stress: InSitu | None = None
    settle: bool = False
    servo: Servo | None = None
    local_damping: Annotated[float, Interval(ge=0.0, le=0.8), Remedy("0.8 is what static problems take")] | None = None
    holes: Annotated[tuple[Annotated[HolePressure | Excavation, ByType], ...], Len(0, MAX_BOUNDARIES)] = ()

    @property
    def platens(self) -> tuple[Platen, Platen] | None:
        """(lower, upper) platen of the loading axis, the first two that face each other."""
        return next((pair for pair in self._facing() if all(isinstance(end, Platen) for end in pair)), None)

    @property
    def ends(self) -> tuple[Boundary, Boundary] | None:
        """(lower, upper) of what the load presses between, whose way is the strain: `platens`, or else a platen and the
        boundary at rest that faces it."""
        alone = (pair for pair in self._facing() if any(isinstance(end, Platen) for end in pair))
        return self.platens or next(alone, None)

    def _facing(self):
        """Boundaries that face each other, (lower, upper), in their order."""
        for lower in self.boundaries:
            for upper in self.boundaries:
                if lower.axis == upper.axis and (lower.side, upper.side) == ("lower", "upper"):
                    yield lower, upper

    @property
    def load_cell(self) -> LoadCell | None:
        """What is measured, complete; None where there is no axis along which to measure."""
        return self.cell.filled(self)

    @property
    def height(self) -> float:
        """Distance between the ends [m]."""
        assert self.ends is not None
        lower, upper = self.ends
        return upper.position - lower.position

    @property
    def strain_rate(self) -> float:
        """Nominal axial strain rate [1/s], compression positive."""
        assert self.ends is not None
        lower, upper = self.ends
        return (lower.speed - upper.speed) / self.height


@checked("schedule")
@dataclass(frozen=True, kw_only=True)
class Schedule:
    """How long, and in what steps. Give `strain_end` (platen strain, compression positive) or `t_end` [s].

    dt = cfl dx/c_p unless `dt` [s] is given. `rows` is about how many rows the history gets; by default 1000, fewer if
    there were then less than ROW_STEPS steps between them, but not below 200. adaptive: steps shrink as
    particles move and swell, dt c_p/(c + |v|), for impacts; the number of steps is then not known beforehand.
    stop_after_drop: the run ends where, after a failure, the nominal stress has fallen by this fraction of its largest
    so far, both filtered and without the confining pressure (see `load_curve.py`); 0.5: below half of the peak.
    """

    strain_end: float | None = None
    t_end: Annotated[Time, Interval(ge=1e-30, le=MAX_SIZE)] | None = None
    cfl: Annotated[float, Interval(ge=MIN_CFL, le=1e3)] = 0.5
    dt: Annotated[Time, Interval(ge=1e-30, le=MAX_SIZE)] | None = None
    rows: Annotated[int, Interval(ge=1, le=1_000_000)] | None = None
    adaptive: bool = False
    stop_after_drop: Annotated[float, Interval(gt=0.0, lt=1.0), Remedy("it is a fraction of the peak")] | None = None

    def __post_init__(self):
        if (self.strain_end is None) == (self.t_end is None):
            needed = "give exactly one of strain_end (platen strain) and t_end (seconds); set the other to none"
            raise SceneError(f"schedule: {needed}")
        if self.strain_end is not None and not 0.0 < abs(self.strain_end) < 0.5:
            raise refuse("schedule.strain_end", self.strain_end, "a strain of size in (0, 0.5)")


@checked("output")
@dataclass(frozen=True, kw_only=True)
class Output:
    """What is written. Frames come at equal strain (or time) intervals and when failed particles jump.

    stress_limit: symmetric colour limit [Pa]; by default 1.5 times the tensile strength. margin: also frames of the
    margin to failure.
    """

    frames: Annotated[int, Interval(ge=0, le=10_000)] = 60
    movie: bool = True
    vtu: Annotated[int, Interval(ge=0, le=10_000)] = 10
    painter: Literal["raster", "ggui"] = "raster"
    margin: bool = False
    stress_limit: Annotated[Pressure, Positive] | None = None


@checked("scene")
@dataclass(frozen=True, kw_only=True)
class Scene:
    """One numerical experiment, complete. 2D is plane strain unless its rock says otherwise.

    rock: that of every body which names no other.
    """

    title: str
    domain: Domain
    bodies: Annotated[tuple[Body, ...], Len(1, MAX_BODIES)]
    rock: Rock
    loading: Loading
    schedule: Schedule
    shape: Annotated[Linear | Gimp | QuadraticBSpline, ByType] = QuadraticBSpline()
    transfer: Annotated[PicFlip | Apic, ByType] = PicFlip()
    order: Literal["musl", "usf", "usl"] = "musl"
    output: Output = field(default_factory=Output)

    def __post_init__(self):
        if UNCHECKED.get():
            return
        try:
            self._check()
        except SceneError as error:
            raise blamed(error, self) from None

    def _check(self) -> None:
        if len(self.title) > 200 or not self.title.isprintable():
            raise refuse("scene.title", self.title, "at most 200 printable characters in one line")
        if self.order == "usl" and isinstance(self.shape, Linear):
            raise SceneError(
                "scene.order = 'usl' with Linear shape functions is refused: its critical step tends to 0 when a "
                "particle has just entered an empty cell; use 'musl' or 'usf', or another shape function"
            )
        check_rocks(self)
        check_initial_stress(self)
        check_gravity(self)
        check_settling(self)
        check_holes(self)
        check_quasi_static(self)
        check_bodies(self)
        check_loading(self)
        check_stop(self)
        check_each_rock(self, lambda rock: check_cracks(rock, self.shape, self.dim, self.domain.dx))
        check_histories(self)
        for body in self.bodies:
            volume = (self.domain.dx / body.seeding.particles_per_axis) ** self.dim
            check_scale(self.rock_of(body).heterogeneity, volume, self.dim)
        check_step(self)
        check_motion(self)

    @property
    def dim(self) -> int:
        return self.domain.dim

    @cached_property
    def rocks(self) -> tuple[Rock, ...]:
        """Each once: the scene's, then others in the order of bodies."""
        return rocks_of(self)

    def rock_of(self, body: Body) -> Rock:
        return self.rock if body.rock is None else body.rock

    @property
    def breaks(self) -> bool:
        """Whether any of its rocks may break."""
        return any(rock.criterion.breaks for rock in self.rocks)

    @cached_property
    def time_scale(self) -> float:
        """The number: `loading.time_scale`, or what 'auto' comes to. Raises SceneError where 'auto' has no meaning."""
        if isinstance(self.loading.time_scale, str):
            return estimate(self).largest(self.loading.quasi_static)
        return self.loading.time_scale

    @property
    def servo(self) -> Servo | None:
        """That of the loading; one of its own where time_scale = 'auto' is to hold while rock breaks."""
        return Servo() if self.loading.servo is None and self._auto else self.loading.servo

    @property
    def local_damping(self) -> float:
        """That of the loading, 0 by default; one of its own where time_scale = 'auto' is to hold while rock breaks."""
        if self.loading.local_damping is None:
            return AUTO_DAMPING if self._auto else 0.0
        return self.loading.local_damping

    @property
    def _auto(self) -> bool:
        return self.loading.time_scale == "auto" and self.breaks

    @property
    def wave_speed(self) -> float:
        """P-wave speed with mass scaling [m/s], that of the fastest rock."""
        return max(rock.wave_speed(self.time_scale) for rock in self.rocks)

    @property
    def density(self) -> float:
        """Density with mass scaling [kg/m^3], that of the densest rock."""
        return max(rock.density for rock in self.rocks) * self.time_scale**2

    @property
    def dt(self) -> float:
        return self.schedule.dt or self.schedule.cfl * self.domain.dx / self.wave_speed

    @property
    def t_end(self) -> float:
        if self.schedule.t_end is not None:
            return self.schedule.t_end
        assert self.schedule.strain_end is not None
        at_full_speed = self.schedule.strain_end / self.loading.strain_rate
        start = self.loading.start
        return start.duration(at_full_speed) if isinstance(start, Ramp) else at_full_speed

    @property
    def steps(self) -> int:
        """Of this dt: with an adaptive schedule they become more."""
        return max(1, math.ceil(self.t_end / self.dt - 1e-9))

    @property
    def row_steps(self) -> int:
        """Steps between two rows of the history."""
        if self.schedule.rows is not None:
            return max(1, self.steps // self.schedule.rows)
        return max(1, self.steps // DEFAULT_ROWS, min(ROW_STEPS, self.steps // LEAST_ROWS))

    def particles(self) -> list[Seeds]:
        """Initial positions and volumes of each body's particles, checked: see `bodies/seeds.py`."""
        return seeds_of(self)

    def elastic(self) -> "Scene":
        """The same scene without failure, in any of its rocks."""

        def whole(rock: Rock) -> Rock:
            return replace(rock, criterion=Unbreakable())

        bodies = tuple(body if body.rock is None else replace(body, rock=whole(body.rock)) for body in self.bodies)
        return replace(self, rock=whole(self.rock), bodies=bodies)
