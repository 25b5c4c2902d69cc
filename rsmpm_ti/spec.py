"""What a scene is: frozen data, checked once, here. Kernels trust it. SI units; angles in degrees.

(`rsmpm_ti.scene` is the command line: it runs as `__main__`, and a dataclass defined there would exist twice.)
"""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from rsmpm_ti.boundaries import Fixed, Platen, Wall
from rsmpm_ti.confinement import check_confined_rock, check_confinement
from rsmpm_ti.directional import check_cracks
from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.laws import Rock, Unbreakable
from rsmpm_ti.quasi_static import LARGEST, LEAST_TRANSITS, estimate
from rsmpm_ti.regions import Region, check_coordinates, slits_of
from rsmpm_ti.seeding import Jittered, Lattice, Seeds, check_slit
from rsmpm_ti.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.starts import Affine, AtRest, Press, Ramp
from rsmpm_ti.time_step import MOST, check_step
from rsmpm_ti.transfer import Apic, PicFlip


@dataclass(frozen=True, kw_only=True)
class Domain:
    """The background grid: a box of cells of edge dx [m]; `grid` is 'dense', 'sparse' or 'auto' (by occupancy).

    A particle that flies more than two cells beyond it ends the run, or with outside = 'drop' is taken out of it.
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    dx: float
    grid: str = "dense"
    outside: str = "stop"

    def __post_init__(self):
        if not (math.isfinite(self.dx) and self.dx > 0.0):
            raise refuse("domain.dx", self.dx, "a positive cell size in metres")
        if len(self.lower) not in (2, 3) or len(self.lower) != len(self.upper):
            raise refuse("domain.upper", self.upper, "2 or 3 coordinates, as many as domain.lower")
        check_coordinates("domain.lower", self.lower)
        check_coordinates("domain.upper", self.upper)
        edges = [float(b) - float(a) for a, b in zip(self.lower, self.upper, strict=True)]
        if not all(edge >= self.dx for edge in edges):
            raise refuse("domain.upper", self.upper, f"at least one cell above domain.lower = {self.lower}")
        if self.grid not in ("dense", "sparse", "auto"):
            raise refuse("domain.grid", self.grid, "'dense', 'sparse' or 'auto'")
        if self.outside not in ("stop", "drop"):
            raise refuse("domain.outside", self.outside, "'stop' or 'drop'")
        nodes = math.prod(edge / float(self.dx) + 1.0 for edge in edges)
        if nodes > MOST:
            raise refuse("domain.dx", self.dx, f"such that the grid has at most {MOST:.3g} nodes, not {nodes:.3g}")

    @property
    def dim(self) -> int:
        return len(self.lower)


@dataclass(frozen=True, kw_only=True)
class Body:
    """Material that fills a region. Initial velocity [m/s] and, in the x-y plane, spin [rad/s] about its centre."""

    region: Region
    seeding: Lattice | Jittered = Lattice()
    velocity: tuple[float, ...] | None = None
    spin: float = 0.0

    def __post_init__(self):
        if self.velocity is not None and not all(map(math.isfinite, self.velocity)):
            raise refuse("body.velocity", self.velocity, "finite components in m/s")
        if not math.isfinite(self.spin):
            raise refuse("body.spin", self.spin, "a finite rate in rad/s")


@dataclass(frozen=True, kw_only=True)
class Loading:
    """What drives the scene.

    time_scale k multiplies the density by k^2 (mass scaling), so a quasi-static run takes 1/k of the steps. 'auto' is
    the largest k at which inertia is expected to make up at most `quasi_static` of the load at first failure: see
    `quasi_static.py`, and `Scene.time_scale` for the number.
    `width` is the loaded length [m] (area [m^2] in 3D) by which platen forces become nominal stress.
    body_force is an acceleration [m/s^2]; mass scaling leaves the force it makes unchanged. `force_field` is one that
    depends on place and time: an object with a ti.func `acceleration(X, t)` of a particle's initial position [m] and
    the time [s]. A scene file brings its own, so a scene with one cannot be run again from its record.
    confinement is a pressure [Pa] on every free surface, in which bodies start at rest (see `confinement.py`).
    """

    boundaries: tuple[Platen | Wall | Fixed, ...] = ()
    start: Affine | Ramp | Press | AtRest = AtRest()
    time_scale: float | str = 1.0
    quasi_static: float = 0.01
    body_force: tuple[float, ...] | None = None
    force_field: object | None = None
    width: float | None = None
    confinement: float = 0.0

    def __post_init__(self):
        number = isinstance(self.time_scale, (int, float)) and 1.0 <= self.time_scale <= LARGEST
        if not (number or self.time_scale == "auto"):
            allowed = f"in [1, {LARGEST:g}] or 'auto'"
            raise refuse("loading.time_scale", self.time_scale, allowed, "1 is the true density")
        if not 1e-6 <= self.quasi_static <= 1.0:
            raise refuse("loading.quasi_static", self.quasi_static, "in [1e-6, 1]", "it is a share of the load")
        if self.body_force is not None and not all(map(math.isfinite, self.body_force)):
            raise refuse("loading.body_force", self.body_force, "finite components in m/s^2")
        if self.force_field is not None and not callable(getattr(self.force_field, "acceleration", None)):
            raise refuse("loading.force_field", self.force_field, "an object with a ti.func acceleration(X, t)")
        if self.width is not None and not (math.isfinite(self.width) and self.width > 0.0):
            raise refuse("loading.width", self.width, "a positive length in metres")
        check_confinement(self.confinement)

    @property
    def platens(self) -> tuple[Platen, Platen] | None:
        """(lower, upper) platen of the loading axis, if there are two that face each other."""
        for lower in self.boundaries:
            for upper in self.boundaries:
                same_axis = isinstance(lower, Platen) and isinstance(upper, Platen) and lower.axis == upper.axis
                if same_axis and (lower.side, upper.side) == ("lower", "upper"):
                    return lower, upper
        return None

    @property
    def height(self) -> float:
        """Distance between the platens [m]."""
        lower, upper = self.platens
        return upper.position - lower.position

    @property
    def strain_rate(self) -> float:
        """Nominal axial strain rate [1/s], compression positive."""
        lower, upper = self.platens
        return (lower.speed - upper.speed) / self.height


@dataclass(frozen=True, kw_only=True)
class Schedule:
    """How long, and in what steps. Give `strain_end` (platen strain, compression positive) or `t_end` [s].

    dt = cfl dx/c_p unless `dt` [s] is given. `rows` is about how many rows the history gets. adaptive: steps shrink as
    particles move and swell, dt c_p/(c + |v|), for impacts; the number of steps is then not known beforehand.
    """

    strain_end: float | None = None
    t_end: float | None = None
    cfl: float = 0.5
    dt: float | None = None
    rows: int = 1000
    adaptive: bool = False

    def __post_init__(self):
        if (self.strain_end is None) == (self.t_end is None):
            raise SceneError("schedule: give exactly one of strain_end (platen strain) and t_end (seconds)")
        for name in ("t_end", "dt"):
            value = getattr(self, name)
            if value is not None and not (math.isfinite(value) and value > 0.0):
                raise refuse(f"schedule.{name}", value, "a positive time in seconds")
        if self.strain_end is not None and not (math.isfinite(self.strain_end) and 0.0 < abs(self.strain_end) < 0.5):
            raise refuse("schedule.strain_end", self.strain_end, "a strain of size in (0, 0.5)")
        if not (math.isfinite(self.cfl) and self.cfl > 0.0):
            raise refuse("schedule.cfl", self.cfl, "positive")
        if not (type(self.rows) is int and 1 <= self.rows <= 1_000_000):
            raise refuse("schedule.rows", self.rows, "a whole number from 1 to 1 000 000")


@dataclass(frozen=True, kw_only=True)
class Output:
    """What is written. Frames come at equal strain (or time) intervals and when failed particles jump.

    stress_limit: symmetric colour limit [Pa]; by default 1.5 times the tensile strength. margin: also frames of the
    margin to failure.
    """

    frames: int = 60
    movie: bool = True
    vtu: int = 10
    painter: str = "raster"
    margin: bool = False
    stress_limit: float | None = None

    def __post_init__(self):
        for name in ("frames", "vtu"):
            value = getattr(self, name)
            if not (type(value) is int and 0 <= value <= 10_000):
                raise refuse(f"output.{name}", value, "a whole number from 0 to 10 000")
        if self.painter not in ("raster", "ggui"):
            raise refuse("output.painter", self.painter, "'raster' or 'ggui'")
        if self.stress_limit is not None and not (math.isfinite(self.stress_limit) and self.stress_limit > 0.0):
            raise refuse("output.stress_limit", self.stress_limit, "a positive stress in Pa")


@dataclass(frozen=True, kw_only=True)
class Scene:
    """One numerical experiment, complete. One rock per scene; 2D is plane strain unless its rock says otherwise."""

    title: str
    domain: Domain
    bodies: tuple[Body, ...]
    rock: Rock
    loading: Loading
    schedule: Schedule
    shape: Linear | Gimp | QuadraticBSpline = QuadraticBSpline()
    transfer: PicFlip | Apic = PicFlip()
    order: str = "musl"
    output: Output = field(default_factory=Output)

    def __post_init__(self):
        if not self.bodies:
            raise SceneError("scene.bodies is empty: give at least one Body")
        if self.order not in ("musl", "usf", "usl"):
            raise refuse("scene.order", self.order, "'musl', 'usf' or 'usl'")
        if self.order == "usl" and isinstance(self.shape, Linear):
            raise SceneError(
                "scene.order = 'usl' with Linear shape functions is refused: its critical step tends to 0 when a "
                "particle has just entered an empty cell; use 'musl' or 'usf', or another shape function"
            )
        if self.dim == 3 and self.rock.elasticity.plane_stress:
            raise refuse("rock.elasticity.plane_stress", True, "False in 3D", "a plate is a 2D scene")
        check_confined_rock(self.loading.confinement, self.rock.elasticity)
        self._check_bodies()
        self._check_loading()
        check_cracks(self.rock, self.shape, self.dim, self.domain.dx)
        check_step(self)

    def _check_bodies(self) -> None:
        lower, upper = np.array(self.domain.lower), np.array(self.domain.upper)
        count = 0.0
        for k, body in enumerate(self.bodies):
            low, high = body.region.bounds()
            if len(low) != self.dim:
                raise SceneError(f"bodies[{k}].region has {len(low)} dimensions, domain has {self.dim}")
            slack = 1e-9 * (upper - lower)
            if np.any(low < lower - slack) or np.any(high > upper + slack):
                raise SceneError(
                    f"bodies[{k}].region from {low.tolist()} to {high.tolist()} m lies outside the domain from "
                    f"{list(self.domain.lower)} to {list(self.domain.upper)} m; enlarge the domain or move the body"
                )
            count += math.prod((high - low) / self.domain.dx * body.seeding.particles_per_axis)
            if body.velocity is not None and len(body.velocity) != self.dim:
                raise refuse(f"bodies[{k}].velocity", body.velocity, f"{self.dim} components in m/s")
            if isinstance(self.shape, Gimp) and not math.isclose(
                self.shape.half_width, 0.5 / body.seeding.particles_per_axis
            ):
                fitting = f"{0.5 / body.seeding.particles_per_axis} for this seeding"
                remedy = "particle domains would overlap or leave gaps"
                raise refuse("shape.half_width", self.shape.half_width, fitting, remedy)
        if count > MOST:
            most = f"such that bodies have at most {MOST:.3g} particles, not {count:.3g}"
            raise refuse("domain.dx", self.domain.dx, most)

    def _check_loading(self) -> None:
        loading, domain = self.loading, self.domain
        if loading.body_force is not None and len(loading.body_force) != self.dim:
            raise refuse("loading.body_force", loading.body_force, f"{self.dim} components in m/s^2")
        for k, boundary in enumerate(loading.boundaries):
            if boundary.axis >= self.dim:
                raise refuse(f"boundaries[{k}].axis", boundary.axis, f"below the dimension {self.dim}")
            cells = (boundary.position - domain.lower[boundary.axis]) / domain.dx
            if abs(cells - round(cells)) > 1e-3:
                nearest = f"the nearest is {domain.lower[boundary.axis] + round(cells) * domain.dx:.9g} m"
                raise refuse(f"boundaries[{k}].position", boundary.position, "on a plane of grid nodes", nearest)
        if self.schedule.strain_end is not None or isinstance(loading.start, Affine):
            if loading.platens is None:
                raise SceneError("strain_end and the Affine start need two platens that face each other; give t_end")
            if loading.width is None:
                raise SceneError("loading.width is missing: platen forces need a loaded width to become stress")
        if loading.platens and not loading.height > 0.0:
            upper = loading.boundaries.index(loading.platens[1])
            raise refuse(f"boundaries[{upper}].position", loading.platens[1].position, "above the lower platen's")
        if self.schedule.strain_end is not None and not loading.strain_rate * self.schedule.strain_end > 0.0:
            sign = f"of the sign of the platens' strain rate {loading.strain_rate:.6g} 1/s"
            raise refuse("schedule.strain_end", self.schedule.strain_end, sign)
        if isinstance(loading.start, Press) and self.schedule.strain_end is not None:
            raise SceneError("start = Press stops the platens itself: give t_end, hold included, no strain_end")
        if isinstance(loading.start, (Ramp, Press)) and loading.platens:
            transits = loading.start.time * self.wave_speed / loading.height
            if transits < LEAST_TRANSITS * (1.0 - 1e-9):
                least = f"at least {LEAST_TRANSITS * loading.height / self.wave_speed:.4g} s, 5 wave transits"
                raise refuse("start.time", loading.start.time, least)

    @property
    def dim(self) -> int:
        return self.domain.dim

    @cached_property
    def time_scale(self) -> float:
        """The number: `loading.time_scale`, or what 'auto' comes to. Raises SceneError where 'auto' has no meaning."""
        if self.loading.time_scale == "auto":
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
        ramp = 0.5 * self.loading.start.time if isinstance(self.loading.start, Ramp) else 0.0
        return self.schedule.strain_end / self.loading.strain_rate + ramp

    @property
    def steps(self) -> int:
        """Of this dt: with an adaptive schedule they become more."""
        return max(1, math.ceil(self.t_end / self.dt - 1e-9))

    def particles(self) -> list[Seeds]:
        """Initial positions and volumes of each body's particles; refuses empty bodies and glued slits."""
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
