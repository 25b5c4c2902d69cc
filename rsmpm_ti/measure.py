"""One look at all particles between steps: energies, speeds, health. The only reduction kernel."""

from dataclasses import dataclass

import taichi as ti

from rsmpm_ti.laws import pressure_energy
from rsmpm_ti.sorting import cell_key
from rsmpm_ti.state import Simulation


@dataclass(frozen=True)
class Survey:
    """Sums and extremes over particles. Energies [J] (per metre of thickness in 2D)."""

    kinetic: float
    elastic: float
    speed: float  # largest [m/s]
    J_min: float
    J_max: float
    sick: int  # particles with a non-finite value or outside the domain
    sick_id: int  # one of them, -1 if none
    strays: int  # particles that left the cell they were sorted into
    momentum: tuple[float, ...]  # [kg m/s]


@ti.kernel
def _survey(sim: ti.template()):
    particles, grid, rock, report = sim.particles, sim.grid, sim.rock, sim.report
    for p in particles.key:
        v = particles.v[p]
        m_p = sim.density * particles.volume[p]
        sigma, J = particles.sigma[p], particles.J[p]
        stored = J * rock.elasticity.energy(sigma)
        if ti.static(particles.breaks):
            if particles.mode[p] != 0:
                bulk = ti.static(rock.elasticity.bulk)
                stored = pressure_energy(rock.after_failure.pressure(bulk, J), bulk, J)
        xi = grid.local(particles.reference[p] + particles.u[p])
        sick = 0
        for d in ti.static(range(sim.dim)):
            if ti.math.isnan(v[d]) or ti.math.isinf(v[d]) or xi[d] < 1.0 or xi[d] > grid.nodes[d] - 2.0:
                sick = 1
            if ti.math.isnan(xi[d]):
                sick = 1
        for k in ti.static(range(sigma.n)):
            if ti.math.isnan(sigma[k]) or ti.math.isinf(sigma[k]):
                sick = 1
        if sick == 1:
            report.sick[None] += 1
            report.sick_id[None] = particles.id[p]
        else:
            report.kinetic[None] += ti.cast(0.5 * m_p * v.dot(v), ti.f64)
            report.elastic[None] += ti.cast(particles.volume[p] * stored, ti.f64)
            ti.atomic_max(report.speed[None], ti.cast(v.norm(), ti.f64))
            ti.atomic_min(report.J_min[None], ti.cast(J, ti.f64))
            ti.atomic_max(report.J_max[None], ti.cast(J, ti.f64))
            for d in ti.static(range(sim.dim)):
                report.momentum[d][None] += ti.cast(m_p * v[d], ti.f64)
        if cell_key(sim, grid.base(xi, sim.shape)) != particles.key[p]:
            report.strays[None] += 1


def survey(sim: Simulation) -> Survey:
    """Survey the particles as they are now."""
    report = sim.report
    for field in (
        report.kinetic,
        report.elastic,
        report.speed,
        report.J_max,
        report.sick,
        report.strays,
        *report.momentum,
    ):
        field[None] = 0
    report.J_min[None], report.sick_id[None] = 1e30, -1
    _survey(sim)
    return Survey(
        kinetic=report.kinetic[None],
        elastic=report.elastic[None],
        speed=report.speed[None],
        J_min=report.J_min[None],
        J_max=report.J_max[None],
        sick=report.sick[None],
        sick_id=report.sick_id[None],
        strays=report.strays[None],
        momentum=tuple(component[None] for component in report.momentum),
    )
