"""What a scene is: frozen data, checked once, here. Kernels trust it. SI units; angles in degrees.

(`rsmpm_ti.scene` is the command line: it runs as `__main__`, and a dataclass defined there would exist twice.)
"""

import contextlib
import math
from contextvars import ContextVar
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Annotated, Literal

import numpy as np
from annotated_types import Interval, Len

from rsmpm_ti.checks import MAX_SIZE, ByType, Finite, NotNegative, Positive, Remedy, checked
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.time_step import MAX_COUNT, MIN_CFL, check_step
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.heterogeneity import check_scale
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Fixed, Platen, Wall
from rsmpm_ti.spec.confinement import check_confined_rock
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.loading_start import Affine, AtRest, Press, Ramp
from rsmpm_ti.spec.mass_scaling import MAX_TIME_SCALE, estimate
from rsmpm_ti.spec.regions import MAX_COORDINATE, Position, Region, slits_of
from rsmpm_ti.spec.scene_checks import check_bodies, check_cracks, check_loading, check_memory, check_motion
from rsmpm_ti.spec.seeding import Jittered, Lattice, Seeds
from rsmpm_ti.spec.slit_check import check_slit
from rsmpm_ti.units import Acceleration, Length, LengthOrArea, Pressure, Spin, Time, Velocity

MAX_BOUNDARIES, MAX_BODIES = 32, 5000

MIN_DX = 1e-9
"""Smallest cell [m]: below it rock is no continuum."""

MIN_DX_FRACTION = 1e-9
"""Smallest cell over the largest coordinate: round-off of a particle's place is then 1e-7 of a cell."""

TimeScale = Annotated[float, Interval(ge=1.0, le=MAX_TIME_SCALE)] | Literal["auto"]

MARGIN = 3
"""Cells of empty grid around the domain, so that no stencil leaves the arrays."""

GROWTH = 4
"""Lengths of a domain's longest edge by which it may grow on every side: each asks for pointers to empty blocks."""


@checked("domain")
@dataclass(frozen=True, kw_only=True)
class Domain:
    """The background grid: a box of cells of edge dx [m]; `grid` is 'dense', 'sparse' or 'auto' (by occupancy).

    A particle that flies more than two cells beyond it ends the run; with outside = 'drop' it is taken out of it; with
    'grow' the grid, which must then be sparse, grows to where particles are, up to GROWTH domain lengths on every side.
    """

    lower: Position
    upper: Position
    dx: Annotated[Length, Interval(ge=MIN_DX, le=MAX_COORDINATE)]
    grid: Literal["dense", "sparse", "auto"] = "dense"
    outside: Literal["stop", "drop", "grow"] = "stop"

    def __post_init__(self):
        if len(self.lower) != len(self.upper):
            raise refuse("domain.upper", self.upper, "as many coordinates as domain.lower")
        edges = [float(b) - float(a) for a, b in zip(self.lower, self.upper, strict=True)]
        if not all(edge >= self.dx for edge in edges):
            allowed = f"at least one cell, dx = {self.dx}, above domain.lower = {self.lower}"
            raise refuse("domain.upper", self.upper, allowed)
        if self.outside == "grow" and self.grid == "dense":
            allowed, remedy = "'stop' or 'drop' with a dense grid", "set domain.grid = 'sparse' to let it grow"
            raise refuse("domain.outside", self.outside, allowed, remedy)
        far = self.farthest
        if not self.dx >= MIN_DX_FRACTION * far:
            allowed = f"at least {MIN_DX_FRACTION * far:.4g} m, {MIN_DX_FRACTION:g} of the largest coordinate"
            raise refuse("domain.dx", self.dx, allowed, "move the domain to the origin: places are lost to round-off")
        nodes = math.prod(edge / float(self.dx) + 1.0 for edge in edges)
        if nodes > MAX_COUNT:
            raise refuse("domain.dx", self.dx, f"such that the grid has at most {MAX_COUNT:.3g} nodes, not {nodes:.3g}")

    @property
    def dim(self) -> int:
        return len(self.lower)

    @property
    def room(self) -> int:
        """Cells beyond the domain, on every side, into which the grid may grow: as many as 32-bit numbers count."""
        if self.outside != "grow":
            return 0
        edges = [(b - a) / self.dx for a, b in zip(self.lower, self.upper, strict=True)]
        room = math.ceil(GROWTH * max(edges))
        while room and math.prod(edge + 2.0 * room + 10.0 for edge in edges) > MAX_COUNT:
            room //= 2
        return room

    @property
    def node_counts(self) -> tuple[int, ...]:
        """Nodes of the background grid along each axis, those around the domain included."""
        edges = ((b - a) / self.dx for a, b in zip(self.lower, self.upper, strict=True))
        return tuple(math.ceil(edge - 1e-6) + 2 * (MARGIN + self.room) + 1 for edge in edges)

    @property
    def farthest(self) -> float:
        """Largest coordinate that a particle may have [m]."""
        return max(map(abs, (*self.lower, *self.upper))) + self.room * self.dx


@checked("body")
@dataclass(frozen=True, kw_only=True)
class Body:
    """Material that fills a region. Initial velocity [m/s] and, in the x-y plane, spin [rad/s] about its centre."""

    region: Region
    seeding: Annotated[Lattice | Jittered, ByType] = Lattice()
    velocity: tuple[Annotated[Velocity, Finite], ...] | None = None
    spin: Annotated[Spin, Finite] = 0.0


@checked("loading")
@dataclass(frozen=True, kw_only=True)
class Loading:
    """What drives the scene.

    time_scale k multiplies the density by k^2 (mass scaling), so a quasi-static run takes 1/k of the steps. 'auto' is
    the largest k at which inertia is expected to make up at most `quasi_static` of the load at first failure: see
    `mass_scaling.py`, and `Scene.time_scale` for the number.
    `width` is the loaded length [m] (area [m^2] in 3D) by which platen forces become nominal stress.
    body_force is an acceleration [m/s^2]; mass scaling leaves the force it makes unchanged. `force_field` is one that
    depends on place and time: an object with a ti.func `acceleration(X, t)` of a particle's initial position [m] and
    the time [s]. A scene file brings its own, so a scene with one cannot be run again from its record.
    confinement is a pressure [Pa] on every free surface, in which bodies start at rest (see `confinement.py`).
    cell: what is measured, and gauges; what it leaves open comes from the platens (see `load_cell.py`).
    """

    boundaries: Annotated[
        tuple[Annotated[Platen | Wall | Fixed, ByType], ...],
        Len(0, MAX_BOUNDARIES),
        Remedy("every kernel holds code for each"),
    ] = ()
    start: Annotated[Affine | Ramp | Press | AtRest, ByType] = AtRest()
    time_scale: TimeScale = 1.0
    quasi_static: Annotated[float, Interval(ge=1e-6, le=1.0), Remedy("it is a fraction of the load")] = 0.01
    body_force: tuple[Annotated[Acceleration, Finite], ...] | None = None
    force_field: object | None = None
    width: Annotated[LengthOrArea, Positive] | None = None
    confinement: Annotated[Pressure, NotNegative, Remedy("it is compression positive")] = 0.0
    cell: LoadCell = LoadCell()

    def __post_init__(self):
        if self.force_field is not None and not callable(getattr(self.force_field, "acceleration", None)):
            raise refuse("loading.force_field", self.force_field, "an object with a ti.func acceleration(X, t)")

    @property
    def platens(self) -> tuple[Platen, Platen] | None:
        """(lower, upper) platen of the loading axis, the first two that face each other; they give the strain."""
        for lower in self.boundaries:
            for upper in self.boundaries:
                if isinstance(lower, Platen) and isinstance(upper, Platen) and lower.axis == upper.axis:
                    if (lower.side, upper.side) == ("lower", "upper"):
                        return lower, upper
        return None

    @property
    def load_cell(self) -> LoadCell | None:
        """What is measured, complete; None where there is no axis along which to measure."""
        return self.cell.filled(self)

    @property
    def height(self) -> float:
        """Distance between the platens [m]."""
        assert self.platens is not None
        lower, upper = self.platens
        return upper.position - lower.position

    @property
    def strain_rate(self) -> float:
        """Nominal axial strain rate [1/s], compression positive."""
        assert self.platens is not None
        lower, upper = self.platens
        return (lower.speed - upper.speed) / self.height


@checked("schedule")
@dataclass(frozen=True, kw_only=True)
class Schedule:
    """How long, and in what steps. Give `strain_end` (platen strain, compression positive) or `t_end` [s].

    dt = cfl dx/c_p unless `dt` [s] is given. `rows` is about how many rows the history gets. adaptive: steps shrink as
    particles move and swell, dt c_p/(c + |v|), for impacts; the number of steps is then not known beforehand.
    """

    strain_end: float | None = None
    t_end: Annotated[Time, Interval(ge=1e-30, le=MAX_SIZE)] | None = None
    cfl: Annotated[float, Interval(ge=MIN_CFL, le=1e3)] = 0.5
    dt: Annotated[Time, Interval(ge=1e-30, le=MAX_SIZE)] | None = None
    rows: Annotated[int, Interval(ge=1, le=1_000_000)] = 1000
    adaptive: bool = False

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


_UNCHECKED = ContextVar("_UNCHECKED", default=False)


@contextlib.contextmanager
def unchecked():
    """Within it the parts of a scene are not held to each other: whoever changes more of them builds it again after."""
    token = _UNCHECKED.set(True)
    try:
        yield
    finally:
        _UNCHECKED.reset(token)


@checked("scene")
@dataclass(frozen=True, kw_only=True)
class Scene:
    """One numerical experiment, complete. One rock per scene; 2D is plane strain unless its rock says otherwise."""

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
        if _UNCHECKED.get():
            return
        if len(self.title) > 200 or not self.title.isprintable():
            raise refuse("scene.title", self.title, "at most 200 printable characters in one line")
        if self.order == "usl" and isinstance(self.shape, Linear):
            raise SceneError(
                "scene.order = 'usl' with Linear shape functions is refused: its critical step tends to 0 when a "
                "particle has just entered an empty cell; use 'musl' or 'usf', or another shape function"
            )
        if self.dim == 3 and self.rock.elasticity.plane_stress:
            raise refuse("rock.elasticity.plane_stress", True, "False in 3D", "a plate is a 2D scene")
        if self.domain.outside == "grow" and self.rock.nonlocal_mean.acts:
            remedy = "enlarge the domain: averages lie on a dense grid"
            raise refuse("domain.outside", "grow", "'stop' or 'drop' in rock with rock.nonlocal_mean", remedy)
        check_confined_rock(self.loading.confinement, self.rock.elasticity)
        check_bodies(self)
        check_loading(self)
        check_cracks(self.rock, self.shape, self.dim, self.domain.dx)
        for body in self.bodies:
            volume = (self.domain.dx / body.seeding.particles_per_axis) ** self.dim
            check_scale(self.rock.heterogeneity, volume, self.dim)
        check_step(self)
        check_motion(self)

    @property
    def dim(self) -> int:
        return self.domain.dim

    @cached_property
    def time_scale(self) -> float:
        """The number: `loading.time_scale`, or what 'auto' comes to. Raises SceneError where 'auto' has no meaning."""
        if isinstance(self.loading.time_scale, str):
            return estimate(self).largest(self.loading.quasi_static)
        return self.loading.time_scale

    @property
    def wave_speed(self) -> float:
        """P-wave speed with mass scaling [m/s]."""
        return self.rock.wave_speed(self.time_scale)

    @property
    def density(self) -> float:
        """Density with mass scaling [kg/m^3]."""
        return self.rock.density * self.time_scale**2

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

    def particles(self) -> list[Seeds]:
        """Initial positions and volumes of each body's particles; refuses empty bodies and glued slits."""
        check_memory(self)
        origin = np.array(self.domain.lower, dtype=float)
        seeds = []
        for k, body in enumerate(self.bodies):
            for slit in slits_of(body.region):
                check_slit(body.region, slit, body.seeding, self.shape, self.domain.dx, origin)
            seeds.append(body.seeding.fill(body.region, origin, self.domain.dx))
            if len(seeds[-1].x) == 0:
                raise SceneError(f"bodies[{k}].region holds no particle: it is smaller than dx = {self.domain.dx} m")
        return seeds

    def elastic(self) -> "Scene":
        """The same scene without failure."""
        return replace(self, rock=replace(self.rock, criterion=Unbreakable()))
