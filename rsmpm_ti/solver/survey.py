"""One look at all particles between steps: energies, speeds, health. The only reduction kernel."""

from dataclasses import dataclass

import numpy as np
import taichi as ti

from rsmpm_ti.failure.of_rock import J_at_start, density_at, energy_and_gap
from rsmpm_ti.fields.records import SCALARS
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.fields.stencil import coordinates
from rsmpm_ti.mpm.holes.press import latest_internal_work

FIXED = len(SCALARS) + 2
"""Places in the report before the momentum: the scalars and the two failure counts."""


@dataclass(frozen=True)
class Survey:
    """Sums and extremes over particles, and the ledger so far. Energies [J] (per metre of thickness in 2D)."""

    kinetic: float
    elastic: float
    speed: float  # largest [m/s]
    J_min: float
    J_max: float
    J_intact: float  # largest of rock that has not failed, 0 where all has
    J_intact_min: float  # and smallest, 1e30 where all has
    sick: int  # particles with a non-finite value or outside the domain
    not_finite: int  # those of them that have a non-finite value
    sick_id: int  # one of them, -1 if none
    outside: int  # particles outside the domain where those are to be dropped, which then are not sick
    strays: int  # particles that left the cell they were sorted into
    far_strays: int  # those among them that are more than half a cell beyond its row
    momentum: np.ndarray  # [kg m/s], [dim]
    impulse: np.ndarray  # of each boundary on the body since the start [N s], [boundaries, dim]
    work: float  # of boundaries, body force, pressure in holes and confinement since the start [J]
    dissipated: float  # by failure and viscosity, and absorbed by boundaries, since the start [J]
    failed_tension: int
    failed_shear: int


@ti.func
def left_domain(sim: ti.template(), xi):
    """Whether a particle at grid coordinates xi is more than two cells beyond the domain: there stencils may end."""
    left = False
    if ti.static(sim.grid.turned):
        way = sim.grid.space_vector(xi - ti.Vector(sim.grid.middle))
        for d in ti.static(range(sim.dim)):
            left = left or ti.abs(way[d]) > sim.grid.reach[d]
    else:
        for d in ti.static(range(sim.dim)):
            left = left or xi[d] < 1.0 or xi[d] > sim.grid.nodes[d] - 2.0
    return left


@ti.kernel
def _survey(sim: ti.template()):
    """Fill sim.report; its fields first, the vector of all of them last, so that one copy brings them to Python."""
    for k in range(1):
        clear_report(sim, k)
    particles, grid, report = sim.particles, sim.grid, sim.report
    ti.loop_config(serialize=sim.traversal.ordered)
    for p in range(particles.count):
        frame = grid.frame()
        v = particles.v[p]
        m_p = density_at(sim, p) * particles.volume[p]
        sigma, J = particles.sigma[p], particles.J[p]
        stored, gap = energy_and_gap(sim, p)
        J_intact, J_whole, J_open = J, J, ti.select(gap == 1, 1.0, J)  # J_open: of what may not gape
        if ti.static(particles.breaks):
            if particles.mode[p] != 0:
                J_intact, J_whole = 0.0, 1e30
        xi = coordinates(sim, p, frame)
        sick, not_finite = 0, 0
        if left_domain(sim, xi):
            sick = sim.outside_is_sick
            report.outside[None] += 1.0 - sick
        for d in ti.static(range(sim.dim)):
            if ti.math.isnan(v[d]) or ti.math.isinf(v[d]):
                not_finite = 1
            if ti.math.isnan(xi[d]) or ti.math.isinf(xi[d]):
                not_finite = 1
        for k in ti.static(range(sigma.n)):
            if ti.math.isnan(sigma[k]) or ti.math.isinf(sigma[k]):
                not_finite = 1
        sick = ti.max(sick, not_finite)
        if sick == 1:
            report.sick[None] += 1.0
            report.not_finite[None] += not_finite
            report.sick_id[None] = ti.cast(particles.id[p], ti.f64)
        else:
            report.kinetic[None] += ti.cast(0.5 * m_p * v.dot(v), ti.f64)
            report.elastic[None] += ti.cast(particles.volume[p] * stored, ti.f64)
            # the confining pressure's work: p times the volume that the bodies gave way
            report.work[None] += ti.cast(sim.confinement * particles.volume[p] * (J_at_start(sim, p) - J), ti.f64)
            if ti.static(sim.walls.holes > 0):
                report.work[None] += sim.walls.ahead * latest_internal_work(sim, p)
            ti.atomic_max(report.speed[None], ti.cast(v.norm(), ti.f64))
            ti.atomic_min(report.J_min[None], ti.cast(J, ti.f64))
            ti.atomic_max(report.J_max[None], ti.cast(J_open, ti.f64))
            ti.atomic_max(report.J_intact[None], ti.cast(J_intact, ti.f64))
            ti.atomic_min(report.J_intact_min[None], ti.cast(J_whole, ti.f64))
            for d in ti.static(range(sim.dim)):
                report.momentum[d][None] += ti.cast(m_p * v[d], ti.f64)
        base = grid.base(xi, sim.shape)
        if grid.key(base) != particles.key[p]:
            report.strays[None] += 1.0
            depth = xi[0] - sim.shape.shift - grid.base_of(particles.key[p])[0]
            if depth < -0.5 or depth > 1.5:
                report.far_strays[None] += 1.0
    for b in range(sim.report.boundary_count):
        for d in ti.static(range(sim.dim)):
            sim.report.values[FIXED + sim.dim + b * sim.dim + d] = sim.ledger.impulse[b][d]
        sim.report.work[None] += sim.ledger.work[b] + sim.walls.latest * sim.ledger.latest[b]
    for b in ti.static(sim.absorbing):
        given = sim.ledger.work[b] + sim.walls.latest * sim.ledger.latest[b]
        sim.report.work[None] -= given
        sim.report.dissipated[None] -= given
    for k in sim.ledger.stopped:
        sim.report.dissipated[None] += sim.ledger.stopped[k]
    for slot in sim.ledger.viscous:
        sim.report.work[None] += sim.ledger.body_work[slot]
        sim.report.dissipated[None] += sim.ledger.viscous[slot] + sim.ledger.released[slot]
        sim.report.dissipated[None] += sim.ledger.damped[slot] + sim.ledger.mixed[slot]
    for k in range(1):
        collect(sim, k)


@ti.func
def clear_report(sim: ti.template(), k):
    report = sim.report
    for field in ti.static(report.sums):
        field[None] = 0.0
    report.J_min[None], report.J_intact_min[None], report.sick_id[None] = 1e30, 1e30, -1.0


@ti.func
def collect(sim: ti.template(), k):
    report, events = sim.report, sim.events
    for position, field in ti.static(enumerate(report.scalars)):
        report.values[position] = field[None]
    for mode in ti.static(range(2)):
        report.values[FIXED - 2 + mode] = ti.cast(events.by_mode[mode + 1], ti.f64)
    for d in ti.static(range(sim.dim)):
        report.values[FIXED + d] = report.momentum[d][None]


def survey(sim: Simulation) -> Survey:
    """Survey the particles as they are now."""
    _survey(sim)
    values, dim = sim.report.values.to_numpy(), sim.dim
    scalars = dict(zip(SCALARS, values, strict=False))
    whole = {
        name: int(scalars.pop(name)) for name in ("sick", "not_finite", "sick_id", "outside", "strays", "far_strays")
    }
    modes = values[len(SCALARS) : FIXED]
    return Survey(
        **scalars,
        **whole,
        failed_tension=int(modes[0]),
        failed_shear=int(modes[1]),
        momentum=values[FIXED : FIXED + dim],
        impulse=values[FIXED + dim :].reshape(-1, dim),
    )
