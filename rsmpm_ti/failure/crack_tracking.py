"""Cracks that grow where the mean stress is highest: the most overloaded fail, and exclude what lies beside them."""

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
from rsmpm_ti.rock.tensors import extreme_principals, principal_normal


@ti.kernel
def evaluate_overload(sim: ti.template()):
    """Overload of each intact particle by the mean stress, where it exceeds its strength; its nodes learn the most."""
    particles = sim.particles
    for p in particles.mode:
        particles.overload[p] = 0.0
        asked = belongs(sim, p) and sim.nonlocal_sums.any_overloaded[None] == 1 and particles.mode[p] == 0
        if asked and near_overloaded(sim, p):
            mean = mean_stress(sim, p)
            load = extreme_principals(mean)[0] / tensile_strength(sim, p)
            normal = principal_normal(mean)
            if load >= 1.0 and sim.rock.nonlocal_mean.own_decides(sim, p, normal) == 0:
                particles.overload[p] = load
                particles.history.crack_normal[p] = normal
                base = sim.grid.base(coordinates(sim, p, sim.grid.frame()), sim.shape)
                for offset in ti.static(sim.stencil):
                    ti.atomic_max(sim.nonlocal_sums.peak[base + ti.Vector(offset)], load)


@ti.kernel
def crack_most_overloaded(sim: ti.template(), time: ti.f64):
    """Start a crack in every particle that none of its neighbours exceeds."""
    particles = sim.particles
    ti.loop_config(serialize=sim.traversal.ordered)  # the last of several new cracks beside a particle excludes it
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
def exclude(sim: ti.template()):
    """Mark what lies beside the cracks that have just begun."""
    particles, new_cracks = sim.particles, sim.nonlocal_sums
    radius, slope = ti.static(sim.rock.nonlocal_mean.radius, sim.rock.nonlocal_mean.slope)
    count = ti.min(new_cracks.count[None], MAX_NEW_CRACKS)
    for p in particles.mode:
        if particles.mode[p] == 0 and belongs(sim, p):
            x = particles.reference[p] + particles.u[p]
            for k in range(count):
                d = x - new_cracks.x[k]
                if d.norm() < radius:
                    n = new_cracks.normal[k]
                    if ti.abs(d.dot(n)) > slope * ti.abs(d[0] * n[1] - d[1] * n[0]):
                        particles.excluding_normal[p] = n


def track_cracks(sim, time: float) -> None:
    """The tensile check by the mean stress, after a step, and the openings by which cracks lose strength.

    Of each rock for itself: means are over its own particles, and a crack excludes no other rock beside it.
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
    exclude(sim)
