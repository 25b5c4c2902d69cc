"""Orders of convergence on manufactured solutions, with the true law at finite strain: refine h, read the slope.

Both motions start stress-free, have a period of 1.5 transits of the P-wave over a metre, and are looked at after 3/4 of
it, when displacement and stress are largest. Particles per cell and CFL number stay the same from grid to grid.
Published orders: Steffen, Kirby & Berzins (2008), Int. J. Numer. Meth. Eng. 76:922; Wallstedt & Guilkey (2008).
"""

import math
import time
from dataclasses import dataclass

import numpy as np
import taichi as ti

from rsmpm_ti.cases.case import Case, Outcome, Row, at_least, at_most
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box, Difference, Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice
from rsmpm_ti.verify.elastic.exact_motion import AxisAligned, Vortex

ROCK = Rock(density=1000.0, elasticity=Hooke(E=1e6, nu=0.3), criterion=Unbreakable(), viscosity=NoViscosity())
PERIOD = 1.5 / ROCK.wave_speed()
T_END = 0.75 * PERIOD
CFL = 0.5
FLIP = PicFlip()
GRIDS = (16, 32, 64)
"""Cells per metre. The unit square has as many across; the annulus half as many, so that 8 would be too few there."""

SMALL, MODERATE, LARGE = 1e-3, 0.02, 0.05
"""Amplitudes [m]; strains of the square reach 3 of them, of the annulus 7. SMALL: no particle leaves its cell."""


def _scene(motion, region, lower, upper, walls, *, cells, shape, transfer=FLIP, order="musl", per_axis=2) -> Scene:
    """A body of ROCK that a motion's force field drives from t = 0 to T_END in whole steps."""
    dt = T_END / math.ceil(T_END * ROCK.wave_speed() * cells / CFL - 1e-9)
    return Scene(
        title="manufactured solution",
        domain=Domain(lower=lower, upper=upper, dx=1.0 / cells),
        # without fitting, the stairs of the annulus cost half an order: 1.5 in place of 2.0 with linear functions
        bodies=(Body(region=region, seeding=Lattice(particles_per_axis=per_axis, fitted=True)),),
        rock=ROCK,
        loading=Loading(boundaries=walls, force_field=motion),
        schedule=Schedule(t_end=T_END, dt=dt),
        shape=shape,
        transfer=transfer,
        order=order,
    )


def square(amplitude: float, **choices) -> Scene:
    """The axis-aligned motion, between four frictionless walls; choices as in `_scene`."""
    sides = (("lower", 0.0), ("upper", 1.0))
    walls = tuple(Wall(axis=axis, side=side, position=position) for axis in (0, 1) for side, position in sides)
    box = Box(lower=(0.0, 0.0), upper=(1.0, 1.0))
    return _scene(_motion(AxisAligned, amplitude), box, box.lower, box.upper, walls, **choices)


def annulus(amplitude: float, **choices) -> Scene:
    """The vortex, with free edges; choices as in `_scene`."""
    outer, inner = (Disc(centre=(0.0, 0.0), radius=radius) for radius in (1.25, 0.75))
    ring = Difference(whole=outer, removed=(inner,))
    return _scene(_motion(Vortex, amplitude), ring, (-1.5, -1.5), (1.5, 1.5), (), **choices)


def _motion(kind: type, amplitude: float):
    return kind(
        amplitude=amplitude,
        angular_frequency=2.0 * math.pi / PERIOD,
        elasticity=ROCK.elasticity,
        density=ROCK.density,
    )


@dataclass(frozen=True)
class Errors:
    """Root mean squares over the volume at the end: displacement over the amplitude, stress over the exact one's."""

    displacement: float
    stress: float
    stress_zz: float
    seconds: float  # of stepping, at the speed of the second half, when every kernel is compiled
    particle_steps: int


def solve(scene: Scene, real=ti.f64) -> Errors:
    """Run one scene of this module from its exact start. Taichi must have been started in the precision `real`."""
    motion, drive = scene.loading.force_field, set_up(scene, real)
    _start(drive, motion)
    half = drive.clock.total // 2
    drive.advance(half)
    ti.sync()
    begin = time.perf_counter()
    drive.advance(drive.clock.total - half)
    ti.sync()
    seconds = (time.perf_counter() - begin) * drive.clock.total / (drive.clock.total - half)
    end = take_snapshot(drive.sim, drive.clock.time)
    X = end.x - end.displacement
    # usf updates stress before velocity, so that its stress belongs to the step before
    exact = motion.stress(X, end.time - (drive.clock.dt if scene.order == "usf" else 0.0))

    def rms(field: np.ndarray) -> float:
        square = np.sum(field.reshape(len(X), -1) ** 2, axis=1)
        return math.sqrt(np.average(square, weights=end.volume))

    return Errors(
        displacement=rms(end.displacement - motion.displacement(X, end.time)) / motion.amplitude,
        stress=rms(end.sigma - exact) / rms(exact),
        stress_zz=rms((end.sigma - exact)[:, 2, 2]) / rms(exact),
        seconds=seconds,
        particle_steps=len(X) * drive.clock.total,
    )


def _start(drive: Drive, motion) -> None:
    """Velocities of t = -dt/2: the solver's steps are a leapfrog, with velocities half a step before positions.

    Those of t = 0 would err by dt/2 times the acceleration at the start, which happens to be 0 in both motions.
    """
    particles, dt = drive.sim.particles, drive.clock.dt
    kind = np.float64 if drive.sim.real == ti.f64 else np.float32
    X = particles.reference.to_numpy().astype(np.float64)
    particles.v.from_numpy(motion.velocity(X, -0.5 * dt).astype(kind))
    if particles.affine:
        steps = 1e-6 * np.eye(2)
        columns = [motion.velocity(X + step, -0.5 * dt) - motion.velocity(X - step, -0.5 * dt) for step in steps]
        particles.C.from_numpy((np.stack(columns, axis=2) / 2e-6).astype(kind))
    if drive.sim.scene.order == "usf":
        sigma = motion.stress(X, -dt)
        packed = np.stack([sigma[:, a, b] for a, b in ((0, 0), (1, 1), (2, 2), (0, 1))], axis=1)
        particles.sigma.from_numpy(packed.astype(kind))


def vortex_error(
    shape, transfer: PicFlip | Apic, order: str, cells: int, amplitude: float, per_axis: int = 2, real=ti.f64
) -> tuple[float, float, int]:
    """(displacement error over the amplitude, seconds of stepping, particle steps) of the vortex on one grid.

    cells per metre; shape, transfer, order, particles per axis as in a scene. Taichi must have been started in `real`.
    """
    choices = dict(cells=cells, shape=shape, transfer=transfer, order=order, per_axis=per_axis)
    errors = solve(annulus(amplitude, **choices), real)
    return errors.displacement, errors.seconds, errors.particle_steps


@dataclass(frozen=True, kw_only=True)
class Series:
    """One shape function at one amplitude over GRIDS, and what must come of it; quick: in that tier too."""

    name: str
    shape: Linear | Gimp | QuadraticBSpline
    amplitude: float
    order: float  # of the displacement error in h, at least
    stress_order: float
    finest: float  # displacement error on the finest grid, at most
    finest_zz: float | None = None  # error of sigma_zz there, at most; None where it is exactly 0
    reason: str
    quick: bool = False

    @property
    def label(self) -> str:
        return f"{self.name}, A = {self.amplitude:g}"


def _linear(**bounds) -> Series:
    return Series(name="linear", shape=Linear(), **bounds)


def _gimp(**bounds) -> Series:
    return Series(name="GIMP", shape=Gimp(), **bounds)


def _bspline(**bounds) -> Series:
    return Series(name="B-spline", shape=QuadraticBSpline(), **bounds)


SMOOTH = "2 in displacement (published), pass from 1.7; stress one lower, with B-splines alone 2"
CELLS = "2 until an error of about A, at any h and dt: particles moved off their cell's middle still make up its stress"
CROSSING = "<= 1 or negative (published): with linear functions the force jumps when a particle crosses"
SPACING = "from 1; force summed over uneven particles errs as 1/h, so that displacement goes to 1, stress to 0"
KEPT = f"{SPACING}; here volume is kept, and 1.9 is reached"
STRONG = (
    "1 is missed at this strain of 16 %: in 1D the force of exact stresses at exact places already errs by 7, 26, 73 % "
    "of the acceleration with B-splines, 11, 40, 97 % with GIMP; at A = 0.02 the order is there"
)

SQUARE = (
    _linear(amplitude=SMALL, order=1.7, stress_order=0.9, finest=2e-3, finest_zz=6e-3, reason=CELLS, quick=True),
    _gimp(amplitude=SMALL, order=1.7, stress_order=0.9, finest=1.3e-3, finest_zz=5e-3, reason=SMOOTH),
    _bspline(amplitude=SMALL, order=1.7, stress_order=1.7, finest=2e-3, finest_zz=1e-3, reason=SMOOTH),
    _gimp(amplitude=MODERATE, order=1.0, stress_order=0.0, finest=2.4e-3, finest_zz=0.011, reason=SPACING),
    _bspline(amplitude=MODERATE, order=1.0, stress_order=0.2, finest=3e-3, finest_zz=0.01, reason=SPACING),
    _linear(amplitude=LARGE, order=-1.3, stress_order=-0.7, finest=1.0, finest_zz=0.35, reason=CROSSING),
    _gimp(amplitude=LARGE, order=-0.5, stress_order=-0.7, finest=0.045, finest_zz=0.05, reason=STRONG),
    _bspline(amplitude=LARGE, order=0.3, stress_order=-0.4, finest=0.021, finest_zz=0.04, reason=STRONG),
)

ANNULUS = (
    _linear(amplitude=SMALL, order=1.7, stress_order=0.9, finest=5e-3, reason=SMOOTH),
    _gimp(amplitude=SMALL, order=1.7, stress_order=0.9, finest=5e-3, reason=SMOOTH),
    _bspline(amplitude=SMALL, order=1.7, stress_order=1.6, finest=0.012, reason=SMOOTH),
    _linear(amplitude=LARGE, order=-0.4, stress_order=-0.4, finest=0.13, reason=CROSSING),
    _gimp(amplitude=LARGE, order=1.7, stress_order=0.8, finest=7.5e-3, reason=KEPT),
    _bspline(amplitude=LARGE, order=1.7, stress_order=1.0, finest=0.011, reason=KEPT, quick=True),
)

COLOURS = {"linear": "C0", "GIMP": "C1", "B-spline": "C2"}
LINES = {SMALL: "-o", MODERATE: "--s", LARGE: ":^"}


def slope(errors: list[float]) -> float:
    """Least-squares order in h of errors on GRIDS."""
    return float(-np.polyfit(np.log(GRIDS), np.log(errors), 1)[0])


def _converge(make, series: tuple[Series, ...], full: bool) -> Outcome:
    """Every series of the tier on every grid; make(amplitude, cells=, shape=): the scene of one."""
    rows: list[Row] = []
    curves: list[tuple[Series, list[float], list[float]]] = []
    for s in (s for s in series if full or s.quick):
        errors = [solve(make(s.amplitude, cells=cells, shape=s.shape)) for cells in GRIDS]
        u, sigma = [e.displacement for e in errors], [e.stress for e in errors]
        curves.append((s, u, sigma))
        rows.append(at_least(f"{s.label}: order of displacement", slope(u), s.order, s.reason))
        rows.append(at_least(f"{s.label}: order of stress", slope(sigma), s.stress_order, s.reason))
        why = "1.2 to 1.4 times what it was when this was written"
        rows.append(at_most(f"{s.label}: displacement error / A", u[-1], s.finest, why))
        if s.finest_zz is not None:
            rows.append(at_most(f"{s.label}: error of sigma_zz", errors[-1].stress_zz, s.finest_zz, why))

    def draw(figure):
        h = 1.0 / np.array(GRIDS)
        panels = ("displacement error / A", "stress error / rms stress")
        for k, (axes, title) in enumerate(zip(figure.subplots(1, 2), panels, strict=True)):
            for s, *errors in curves:
                label = f"{s.label}: {slope(errors[k]):.2f}"
                axes.loglog(h, errors[k], LINES[s.amplitude], color=COLOURS[s.name], markersize=4, label=label)
            axes.set_xticks(h, [f"1/{cells}" for cells in GRIDS])
            axes.minorticks_off()
            axes.set(xlabel="h [m]", title=f"{title}, and its order in h")
            axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=2, fontsize="small")

    return Outcome(tuple(rows), draw)


def manufactured_a(full: bool) -> Outcome:
    """The axis-aligned motion of the unit square."""
    return _converge(square, SQUARE, full)


def manufactured_b(full: bool) -> Outcome:
    """The vortex in the annulus: spin and shear without volume change."""
    return _converge(annulus, ANNULUS, full)


CASES = (
    Case("manufactured_a", "orders of convergence, square stretched along its axes between walls", manufactured_a),
    Case("manufactured_b", "orders of convergence, vortex in an annulus with free edges", manufactured_b),
)
