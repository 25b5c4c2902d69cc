"""Cracks that grow where the mean stress is highest: the most overloaded fail, and those around learn where."""

import taichi as ti

from rsmpm_ti.failure.nonlocal_fields import (
    mark_overloaded,
    mean_stress,
    near_overloaded,
    needed_tiles,
    read_crack_strains,
    sum_needed,
)
from rsmpm_ti.failure.of_rock import belongs
from rsmpm_ti.failure.stress_update import start_failure
from rsmpm_ti.fields.nonlocal_sums import MAX_NEW_CRACKS
from rsmpm_ti.fields.stencil import coordinates
from rsmpm_ti.rock.criteria import tensile_strength
from rsmpm_ti.rock.tensors import principal_normal

LEAST_OVERLOAD = 1e-3
"""Of a particle at a tip whose own tension has reached its strength, whatever the mean is."""


@ti.func
def is_overloaded(sim: ti.template(), p):
    """Whether an intact particle may crack at this look: at a tip by its own stress, else by the mean stress."""
    rule, found = sim.rock.nonlocal_mean, False
    if rule.at_tip(sim, p):
        found = rule.tension_across(sim, p, sim.particles.sigma[p]) >= tensile_strength(sim, p)
    elif near_overloaded(sim, p):
        found = rule.tension_across(sim, p, mean_stress(sim, p)) >= tensile_strength(sim, p)
    return found


@ti.kernel
def evaluate_overload(sim: ti.template()):
    """Overload by the mean stress of each intact particle that may crack; its nodes learn the most."""
    particles, rule = sim.particles, sim.rock.nonlocal_mean
    for p in particles.mode:
        particles.overload[p] = 0.0
        if belongs(sim, p) and particles.mode[p] == 0 and is_overloaded(sim, p):
            mean = mean_stress(sim, p)
            normal = principal_normal(mean)
            if rule.own_part(sim, p, normal) < 1.0:
                load = ti.max(rule.tension_across(sim, p, mean) / tensile_strength(sim, p), LEAST_OVERLOAD)
                particles.overload[p] = load
                particles.history.crack_normal[p] = normal
                base = sim.grid.base(coordinates(sim, p, sim.grid.frame()), sim.shape)
                for offset in ti.static(sim.stencil):
                    ti.atomic_max(sim.nonlocal_sums.peak[base + ti.Vector(offset)], load)


@ti.kernel
def crack_most_overloaded(sim: ti.template(), time: ti.f64):
    """Start a crack in every particle that none of its neighbours exceeds."""
    particles = sim.particles
    ti.loop_config(serialize=sim.traversal.ordered)  # of several new cracks as near to a particle the first counts
    for p in range(particles.count):
        load = particles.overload[p]
        if load > 0.0:
            base = sim.grid.base(coordinates(sim, p, sim.grid.frame()), sim.shape)
            most = load
            for offset in ti.static(sim.stencil):
                most = ti.max(most, sim.nonlocal_sums.peak[base + ti.Vector(offset)])
            if load >= most:
                k = ti.atomic_add(sim.nonlocal_sums.count[None], 1)
                if k < MAX_NEW_CRACKS:
                    sim.nonlocal_sums.x[k] = particles.reference[p] + particles.u[p]
                    sim.nonlocal_sums.normal[k] = particles.history.crack_normal[p]
                    dissipated = start_failure(sim, p, 1, particles.history.crack_normal[p], time)
                    sim.ledger.released[0] += ti.cast(particles.volume[p] * dissipated, ti.f64)


@ti.kernel
def show_cracks(sim: ti.template()):
    """What lies near the cracks that have just begun learns where the nearest is."""
    particles, new_cracks = sim.particles, sim.nonlocal_sums
    radius = ti.static(sim.rock.nonlocal_mean.radius)
    count = ti.min(new_cracks.count[None], MAX_NEW_CRACKS)
    for p in particles.mode:
        if particles.mode[p] == 0 and belongs(sim, p):
            x = particles.reference[p] + particles.u[p]
            for k in range(count):
                d, known = new_cracks.x[k] - x, particles.to_crack[p].norm()
                if d.norm() < radius and (known == 0.0 or d.norm() < known):
                    particles.to_crack[p] = d
                    particles.nearest_normal[p] = new_cracks.normal[k]


def track_cracks(sim, time: float) -> None:
    """The tensile check by the mean stress, after a step, and the openings by which cracks lose strength.

    Of each rock for itself: means are over its own particles, and a crack is none of another rock's.
    """
    for view in sim.nonlocal_views:
        _track_cracks(view, time)


def _track_cracks(sim, time: float) -> None:
    if not needed_tiles(sim, sim.nonlocal_sums.weakest):
        return
    sum_needed(sim)
    read_crack_strains(sim)
    mark_overloaded(sim, sim.nonlocal_sums.weakest)
    evaluate_overload(sim)
    crack_most_overloaded(sim, time)
    show_cracks(sim)
