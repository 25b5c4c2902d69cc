"""The material side of a step, one particle at a time: elastic stress, the failure check, and its record."""

import taichi as ti

from rsmpm_ti.rock.criteria import load_factors
from rsmpm_ti.rock.tensors import double_contraction, extreme_principals, principal_normal, symmetric


@ti.func
def record_failure(sim: ti.template(), p, mode, extremes, released, time):
    events = sim.events
    e = ti.atomic_add(events.count[None], 1)
    events.by_mode[mode] += 1
    if e < events.capacity:  # a law that makes more than it said is told so at the next survey
        store_event(sim, e, p, mode, extremes, released, time)


@ti.func
def store_event(sim: ti.template(), e, p, mode, extremes, released, time):
    particles, events = sim.particles, sim.events
    events.time[e] = time
    events.x[e] = particles.reference[p] + particles.u[p]
    events.sigma_1[e], events.sigma_3[e] = extremes[0], extremes[1]
    events.released[e] = released
    events.mode[e] = mode
    events.id[e] = particles.id[p]
    for column, variable in ti.static(events.of_history):
        column[e] = variable[p]


@ti.func
def update_stress(sim: ti.template(), p, L, dt):
    """Elastic stress and J after one step; returns the energy that artificial viscosity took [J].

    Done for failed particles too, which `check_failure` sets right: a step without branches runs faster.
    """
    particles, rock = sim.particles, sim.rock
    J = particles.J[p] * rock.elasticity.volume_ratio(dt * L)
    particles.J[p] = J
    particles.sigma[p] = rock.elasticity.stress(particles.sigma[p], dt * L)
    return rock.viscosity.update(sim, p, L.trace(), dt)


@ti.func
def own_shear_load(sim: ti.template(), load):
    """Load factor in shear, of load factors of a particle's own stress."""
    return sim.rock.criterion.shear_load(sim.rock.nonlocal_mean.own_tension(sim, load[0]), load[1])


@ti.func
def failure_by_own_stress(sim: ti.template(), p, extremes):
    """Mode by a particle's own stress: 0, 1 or 2. Tension may be for a mean stress to judge: nonlocal_mean.py."""
    load = load_factors(sim, p, extremes)
    mode = sim.rock.criterion.mode(load[0], load[1])
    if mode == 1:
        part = sim.rock.nonlocal_mean.own_part(sim, p, principal_normal(sim.particles.sigma[p]))
        if sim.rock.criterion.mode(part * load[0], load[1]) != 1:
            mode = ti.select(own_shear_load(sim, load) >= 1.0, 2, 0)
    return mode


@ti.func
def must_check(sim: ti.template(), p):
    """1 for a particle that has failed or whose own stress has reached the criterion, else 0; without branches."""
    load = load_factors(sim, p, extreme_principals(sim.particles.sigma[p]))
    return ti.select(sim.particles.mode[p] != 0, 1, sim.rock.criterion.reached(load[0], load[1]))


@ti.func
def start_failure(sim: ti.template(), p, mode, normal, time):
    """From now on a particle loses strength by tension (1) or shear (2); returns the energy lost at once [J/m^3]."""
    particles = sim.particles
    ti.atomic_min(sim.events.onset[None], time)
    particles.mode[p] = mode
    sim.rock.viscosity.stop(sim, p)
    return sim.rock.after_failure.begin(sim, p, mode, normal)


@ti.func
def check_failure(sim: ti.template(), p, dt, time, slot):
    """The failure check of the paper, tension first, then Mohr-Coulomb; irreversible. And the stress of failed rock.

    What failed rock carries, what that costs and when it is an event is for the law after failure to say.
    """
    particles, law = sim.particles, sim.rock.after_failure
    extremes, failed, dissipated, lost_work = extreme_principals(particles.sigma[p]), 0, 0.0, 0.0
    if particles.mode[p] == 0:
        mode = failure_by_own_stress(sim, p, extremes)
        if mode != 0:
            dissipated += start_failure(sim, p, mode, principal_normal(particles.sigma[p]), time)
            lost_work = 0.5 * particles.J[p]
    else:
        failed = law.failed_mode(sim, p)
    if particles.mode[p] != 0:
        sigma, more = law.respond(sim, p, dt * particles.L[p], dt)
        dissipated += more
        if ti.static(not law.softens):
            # half of the step went by with the stress that is lost: trapezoidal rule, as for platens (records.py)
            lost = particles.sigma[p] - sigma
            dissipated -= lost_work * double_contraction(lost, symmetric(dt * particles.L[p]))
        particles.sigma[p] = sigma
        sim.ledger.released[slot] += ti.cast(particles.volume[p] * dissipated, ti.f64)
        mode = ti.max(0, ti.min(law.failed_mode(sim, p), 2))
        if mode != failed and mode != 0:
            record_failure(sim, p, mode, extremes, particles.volume[p] * law.released(sim, p, dissipated), time)
