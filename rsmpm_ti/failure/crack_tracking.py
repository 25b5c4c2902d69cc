"""Cracks that grow where the mean stress is highest: judge, let the most overloaded fail, shade what lies beside."""

import taichi as ti

from rsmpm_ti.failure.nonlocal_fields import mark_hot, mean_stress, near_hot, read_openings, smooth_stress
from rsmpm_ti.failure.smeared_crack_stress import start_crack, strengths
from rsmpm_ti.failure.stress_update import shaded
from rsmpm_ti.fields.nonlocal_sums import MAX_NEW_CRACKS
from rsmpm_ti.fields.stencil import coordinates
from rsmpm_ti.rock.tensors import extreme_principals, principal_angle


@ti.kernel
def judge(sim: ti.template()):
    """Overload of each intact particle by the mean stress, where it exceeds its strength; its nodes learn the most."""
    particles = sim.particles
    for p in particles.mode:
        particles.overload[p] = 0.0
        if sim.means.any_hot[None] == 1 and particles.mode[p] == 0 and near_hot(sim, p):
            mean = mean_stress(sim, p)
            load = extreme_principals(mean)[0] / strengths(sim, p)[0]
            angle = principal_angle(mean)
            if load >= 1.0 and not shaded(sim, p, angle):
                particles.overload[p] = load
                particles.crack_angle[p] = angle
                base = sim.grid.base(coordinates(sim, p), sim.shape)
                for offset in ti.static(sim.stencil):
                    ti.atomic_max(sim.means.peak[base + ti.Vector(offset)], load)


@ti.kernel
def crack_most_overloaded(sim: ti.template(), time: ti.f64):
    """Start a crack in every particle that none of its neighbours exceeds."""
    particles = sim.particles
    ti.loop_config(serialize=sim.traversal.ordered)  # the last of several new cracks beside a particle shades it
    for p in range(particles.count):
        load = particles.overload[p]
        if load > 0.0:
            base = sim.grid.base(coordinates(sim, p), sim.shape)
            most = load
            for offset in ti.static(sim.stencil):
                most = ti.max(most, sim.means.peak[base + ti.Vector(offset)])
            if load >= most:
                k = ti.atomic_add(sim.means.fresh[None], 1)
                if k < MAX_NEW_CRACKS:
                    sim.means.x[k] = particles.reference[p] + particles.u[p]
                    sim.means.angle[k] = particles.crack_angle[p]
                    start_crack(sim, p, 1, particles.crack_angle[p], time)
                    if ti.static(particles.viscous):
                        particles.q[p] = 0.0


@ti.kernel
def shade(sim: ti.template()):
    """Mark what lies beside the cracks that have just begun."""
    particles, fresh = sim.particles, sim.means
    radius, slope = ti.static(sim.rock.averaging.radius, sim.rock.averaging.slope)
    count = ti.min(fresh.fresh[None], MAX_NEW_CRACKS)
    for p in particles.mode:
        if particles.mode[p] == 0:
            x = particles.reference[p] + particles.u[p]
            for k in range(count):
                d = x - fresh.x[k]
                if d.norm() < radius:
                    n = ti.Vector([ti.cos(fresh.angle[k]), ti.sin(fresh.angle[k])])
                    if ti.abs(d.dot(n)) > slope * ti.abs(d[0] * n[1] - d[1] * n[0]):
                        particles.shade_angle[p] = fresh.angle[k]


def track_cracks(sim, time: float) -> None:
    """The tensile check by the mean stress, after a step, and the openings by which cracks lose strength."""
    smooth_stress(sim)
    read_openings(sim)
    mark_hot(sim, sim.means.weakest)
    judge(sim)
    crack_most_overloaded(sim, time)
    shade(sim)
