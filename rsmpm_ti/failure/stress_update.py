"""The material side of a step, one particle at a time: elastic stress, the failure check, and its record."""

import taichi as ti

from rsmpm_ti.failure.smeared_crack_stress import has_failed, load_factors, release, start_crack
from rsmpm_ti.fields.state import NO_SHADE
from rsmpm_ti.rock.after_failure import pressure_energy
from rsmpm_ti.rock.tensors import extreme_principals, isotropic, principal_angle


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
    if ti.static(events.directional):
        events.crack_angle[e] = particles.crack_angle[p]


@ti.func
def update_stress(sim: ti.template(), p, L, dt):
    """Elastic stress and J after one step; returns the energy that artificial viscosity took [J].

    Done for failed particles too, which `check_failure` sets right: a step without branches runs faster.
    """
    particles, rock = sim.particles, sim.rock
    J = particles.J[p] * rock.elasticity.volume_ratio(dt * L)
    particles.J[p] = J
    particles.sigma[p] = rock.elasticity.stress(particles.sigma[p], dt * L)
    lost = 0.0
    if ti.static(particles.viscous):
        rate = L.trace()
        q = rock.viscosity.pressure(rate, sim.density / J, sim.grid.dx, sim.wave_speed)
        if ti.static(particles.breaks):
            q = ti.select(particles.mode[p] == 0, q, 0.0)  # none in failed rock (paper sec. 3.2)
        particles.q[p] = q
        lost = -dt * q * rate * particles.volume[p] * J
    return lost


@ti.func
def shaded(sim: ti.template(), p, angle):
    """Whether a crack with a normal near `angle` runs beside the particle."""
    return ti.cos(2.0 * (angle - sim.particles.shade_angle[p])) > 0.0 and sim.particles.shade_angle[p] < NO_SHADE


@ti.func
def own_shear_load(sim: ti.template(), load):
    """Load factor in shear, of load factors of a particle's own stress.

    With averaging, tension beyond the cut-off counts as the cut-off: what it does is for the mean stress to judge. It
    would reach Mohr-Coulomb by itself, and rock on a flaw's face would slip where it ought to open.
    """
    most = load[0]
    if ti.static(sim.averaging):
        most = ti.min(load[0], sim.rock.criterion.tensile_strength)
    return sim.rock.criterion.shear_load(most, load[1])


@ti.func
def failure_by_own_stress(sim: ti.template(), p, extremes):
    """Mode by a particle's own stress: 0, 1 or 2. With averaging, tension is for the mean stress unless shaded."""
    load = load_factors(sim, p, extremes)
    mode = sim.rock.criterion.mode(load[0], load[1])
    if ti.static(sim.averaging):
        if mode == 1 and not shaded(sim, p, principal_angle(sim.particles.sigma[p])):
            mode = ti.select(own_shear_load(sim, load) >= 1.0, 2, 0)
    return mode


@ti.func
def must_check(sim: ti.template(), p):
    """1 for a particle that has failed or whose own stress has reached the criterion, else 0; without branches."""
    load = load_factors(sim, p, extreme_principals(sim.particles.sigma[p]))
    return ti.select(sim.particles.mode[p] != 0, 1, sim.rock.criterion.reached(load[0], load[1]))


@ti.func
def check_and_release(sim: ti.template(), p, dt, time, slot):
    """The failure check for rock that cracks with a direction, and the stress of what has cracked.

    The event is when a particle has opened or slipped by what costs half of the strength: at once without fracture
    energy.
    """
    particles = sim.particles
    extremes = extreme_principals(particles.sigma[p])
    if particles.mode[p] == 0:
        mode = failure_by_own_stress(sim, p, extremes)
        if mode != 0:
            start_crack(sim, p, mode, principal_angle(particles.sigma[p]), time)
            if ti.static(particles.viscous):
                particles.q[p] = 0.0
    if particles.mode[p] != 0:
        sigma, lost = release(sim, p, dt * particles.L[p], time)
        lost *= particles.volume[p] * particles.J[p]
        particles.sigma[p] = sigma
        particles.lost[p] = particles.lost[p] + lost
        sim.ledger.released[slot] += ti.cast(lost, ti.f64)
        mode = particles.mode[p]
        if mode != particles.failed[p] and has_failed(sim, p, mode):
            particles.failed[p] = mode
            record_failure(sim, p, mode, extremes, particles.lost[p], time)


@ti.func
def check_failure(sim: ti.template(), p, time, slot):
    """The failure check of the paper: tension first, then Mohr-Coulomb; irreversible.

    A failed particle keeps s = 0 and a pressure from total J.
    """
    particles, rock = sim.particles, sim.rock
    bulk = ti.static(rock.elasticity.bulk)
    sigma, mode = particles.sigma[p], particles.mode[p]
    if mode == 0:
        extremes = extreme_principals(sigma)
        load = load_factors(sim, p, extremes)
        mode = rock.criterion.mode(load[0], load[1])
        if mode != 0:
            J = particles.J[p]
            particles.mode[p] = mode
            if ti.static(particles.viscous):
                particles.q[p] = 0.0
            kept = pressure_energy(rock.after_failure.pressure(bulk, J), bulk, J)
            released = particles.volume[p] * (J * rock.elasticity.energy(sigma) - kept)
            sim.ledger.released[slot] += ti.cast(released, ti.f64)
            record_failure(sim, p, mode, extremes, released, time)
    if mode != 0:
        particles.sigma[p] = isotropic(-rock.after_failure.pressure(bulk, particles.J[p]), sigma.n)
