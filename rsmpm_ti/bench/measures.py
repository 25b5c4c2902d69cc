"""Error and cost of one setting: a slit specimen against finite elements, a vibrating bar, a manufactured vortex."""

import math
import time
from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.bench.sweep import TRANSFERS, Setting
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice
from rsmpm_ti.verify.elastic.manufactured import vortex_error
from rsmpm_ti.verify.elastic.slit_field import PLANE_STRAIN_MODULUS, field_error, slit_specimen
from rsmpm_ti.verify.reference.fe_field import load_field

STRAIN = 4.5e-5
"""Where the slit specimen is looked at: just below its first failure, 0.75 MPa."""

PERIODS = 2
BAR, WIDTH_CELLS, SPEED = 0.1, 32, 2.6e-3
"""The bar's length [m], its width in cells, and its speed [m/s]: a strain of 1e-6, so that no particle meets a cell's
edge."""


@dataclass(frozen=True)
class Measure:
    """error: relative, see each case; wall_s: stepping alone, compiling left out."""

    error: float
    wall_s: float
    particle_steps: int


def measure(setting: Setting) -> Measure:
    """Run one setting on one thread."""
    real, _ = start_taichi(setting.precision, "cpu", 1)
    return {"slit": slit, "bar": bar, "vortex": vortex}[setting.case](setting, real)


def timed_run(drive: Drive) -> float:
    """Run to the end; seconds of all steps, estimated from all but the first, which compiles."""
    drive.advance(1)
    ti.sync()
    start = time.perf_counter()
    drive.advance(drive.clock.total)
    ti.sync()
    return (time.perf_counter() - start) * drive.clock.total / (drive.clock.total - 1)


def slit(setting: Setting, real) -> Measure:
    """rms error of sigma_1 over nominal stress against finite elements, as a scene loads it: at the paper's rate, with
    mass scaling. Slit of 2 mm, three cells of the coarsest grid."""
    scene = slit_specimen(0.1 / setting.cells, 2e-3, setting.functions, Lattice(
        particles_per_axis=setting.per_axis, fitted=setting.fitted))  # fmt: skip
    loading = replace(scene.loading, time_scale=setting.time_scale)
    scene = replace(
        scene.elastic(), transfer=TRANSFERS[setting.transfer], order=setting.order, loading=loading,
        schedule=Schedule(strain_end=STRAIN),
    )  # fmt: skip
    drive = set_up(scene, real)
    wall = timed_run(drive)
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    field = load_field("slit_specimen_2mm")
    modulus = PLANE_STRAIN_MODULUS * field.metadata["modulus_ratio"]["square"]
    error = field_error(scene, field, snapshot.x, snapshot.sigma, snapshot.volume, modulus * drive.clock.strain)
    return Measure(error.rms, wall, drive.sim.particles.count * drive.clock.total)


def bar(setting: Setting, real) -> Measure:
    """|z - z_exact| after two periods of the first mode between fixed ends, z = (velocity + i omega displacement) of
    that mode over its first velocity: phase and damping in one number."""
    dx = 2.0 * BAR / setting.cells
    width = WIDTH_CELLS * dx
    rock = Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable(), viscosity=NoViscosity())
    period = 2.0 * BAR / rock.wave_speed()
    walls = [
        Wall(axis=axis, side=side, position=(0.0 if side == "lower" else (BAR, width)[axis]))
        for axis in (0, 1)
        for side in ("lower", "upper")
    ]
    scene = Scene(
        title="bar",
        domain=Domain(lower=(0.0, 0.0), upper=(BAR, width), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(BAR, width)), seeding=Lattice(
            particles_per_axis=setting.per_axis)),),
        rock=rock,
        loading=Loading(boundaries=tuple(walls)),
        schedule=Schedule(t_end=PERIODS * period, cfl=0.4),
        shape=setting.functions,
        transfer=TRANSFERS[setting.transfer],
        order=setting.order,
    )  # fmt: skip
    drive = set_up(scene, real)
    particles = drive.sim.particles
    x = particles.reference.to_numpy()[:, 0]
    mode, omega = np.sin(math.pi * x / BAR), 2.0 * math.pi / period
    v = np.zeros((len(x), 2), dtype=np.float64 if real == ti.f64 else np.float32)
    v[:, 0] = SPEED * mode
    particles.v.from_numpy(v)
    wall = timed_run(drive)
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    mode = np.sin(math.pi * (snapshot.x - snapshot.displacement)[:, 0] / BAR)
    norm = SPEED * np.sum(mode**2)
    velocity, displacement = (mode @ f[:, 0] / norm for f in (snapshot.velocity, snapshot.displacement))
    # v is half a step behind x in every order: at the turning points chosen here that costs (omega dt)^2/8, no more
    error = abs(velocity + 1j * omega * displacement - np.exp(1j * omega * drive.clock.time))
    return Measure(float(error), wall, particles.count * drive.clock.total)


def vortex(setting: Setting, real) -> Measure:
    """rms displacement error over amplitude of manufactured solution B."""
    return Measure(*vortex_error(
        setting.functions, TRANSFERS[setting.transfer], setting.order, setting.cells, 1e-3, setting.per_axis, real
    ))  # fmt: skip
