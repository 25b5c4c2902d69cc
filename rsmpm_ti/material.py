"""The material side of a step, one particle at a time: elastic stress, the failure check, and its record."""

import taichi as ti

from rsmpm_ti.laws import pressure_energy
from rsmpm_ti.tensors import extreme_principals, isotropic


@ti.func
def record_failure(sim: ti.template(), p, mode, extremes, released, time):
    particles, events = sim.particles, sim.events
    e = ti.atomic_add(events.count[None], 1)
    events.by_mode[mode] += 1
    events.time[e] = time
    events.x[e] = particles.reference[p] + particles.u[p]
    events.sigma_1[e], events.sigma_3[e] = extremes[0], extremes[1]
    events.released[e] = released
    events.mode[e] = mode
    events.id[e] = particles.id[p]


@ti.func
def update_stress(sim: ti.template(), p, L, dt, time, slot):
    """Elastic step, then the failure check of the paper: every particle, every step, tension first.

    A failed particle keeps s = 0 and a pressure from total J; it has no artificial viscosity (paper sec. 3.2).
    Returns the energy that viscosity took [J].
    """
    particles, ledger, rock = sim.particles, sim.ledger, sim.rock
    bulk = ti.static(rock.elasticity.bulk)
    J = particles.J[p] * (ti.Matrix.identity(float, sim.dim) + dt * L).determinant()
    particles.J[p] = J
    failed = False
    if ti.static(particles.breaks):
        failed = particles.mode[p] != 0
    q, lost = 0.0, 0.0
    if not failed:
        sigma = rock.elasticity.stress(particles.sigma[p], dt * L)
        if ti.static(particles.breaks):
            extremes = extreme_principals(sigma)
            mode = rock.criterion.mode(extremes[0], extremes[1])
            if mode != 0:
                failed = True
                particles.mode[p] = mode
                kept = pressure_energy(rock.after_failure.pressure(bulk, J), bulk, J)
                released = particles.volume[p] * (J * rock.elasticity.energy(sigma) - kept)
                ledger.released[slot] += ti.cast(released, ti.f64)
                record_failure(sim, p, mode, extremes, released, time)
        if ti.static(particles.viscous):
            if not failed:
                q = rock.viscosity.pressure(L.trace(), sim.density, sim.grid.dx, sim.wave_speed)
                lost = -dt * q * L.trace() * particles.volume[p] * J
        particles.sigma[p] = sigma
    if ti.static(particles.breaks):
        if failed:
            pressure = rock.after_failure.pressure(bulk, J)
            particles.sigma[p] = isotropic(-pressure, particles.sigma.n)
    if ti.static(particles.viscous):
        particles.q[p] = q
    return lost
