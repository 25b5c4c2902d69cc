"""Stress of one particle of rock that cracks with a direction: where it fails, how it opens, slips and closes."""

import math

import taichi as ti

from rsmpm_ti.rock.smeared_crack import FRESH, NO_DIRECTION, SWEEPS
from rsmpm_ti.rock.tensors import (
    double_contraction,
    extreme_principals,
    principal_angle,
    rotation_angle,
    symmetric,
    turned,
)


@ti.func
def strengths(sim: ti.template(), p):
    """Tensile strength and cohesion of a particle's rock before it cracked [Pa]."""
    f_t, c = sim.rock.criterion.tensile_strength, sim.rock.criterion.cohesion
    if ti.static(sim.particles.varied):
        f_t *= sim.particles.strength[p]
        c *= sim.particles.strength[p]
    return ti.Vector([f_t, c])


@ti.func
def load_factors(sim: ti.template(), p, extremes):
    """Extreme principal stresses as the criterion sees them: dividing by k is multiplying both strengths by it."""
    load = extremes
    if ti.static(sim.particles.varied):
        load = extremes / sim.particles.strength[p]
    return load


@ti.func
def softening_strain(sim: ti.template(), p):
    """Crack strain by which a particle's crack has lost tensile strength: its own, or that of the rock around."""
    strain = sim.particles.widest[p][0]
    if ti.static(sim.averaging):
        strain = sim.particles.worn[p]
    return strain


@ti.func
def strength_left(sim: ti.template(), p):
    """What is left of the tensile strength across the crack and across the one at right angles, and of cohesion [Pa].

    Slip wears the tensile strength away with the cohesion: that of the crack it is on, of all planes if crushed.
    """
    particles, soft = sim.particles, sim.rock.after_failure.softening
    full, widest = strengths(sim, p), particles.widest[p]
    n = soft.share(softening_strain(sim, p), full[0], soft.G_f_I, sim.band)
    t = soft.share(widest[1], full[0], soft.G_f_I, sim.band)
    shear = soft.share(particles.slip[p], full[1], soft.G_f_II, sim.band)
    if particles.mode[p] == 2:
        t = ti.min(t, shear)
    return ti.Vector([ti.min(n, shear) * full[0], t * full[0], shear * full[1]])


@ti.func
def has_failed(sim: ti.template(), p, mode):
    """Whether a particle cracked by `mode` (1 tension, 2 shear) has itself opened or slipped by what costs half of the
    strength: what is only torn along by a crack beside it has lost its strength, but is no crack."""
    soft, full = sim.rock.after_failure.softening, strengths(sim, p)
    share = soft.share(sim.particles.slip[p], full[1], soft.G_f_II, sim.band)
    if mode == 1:
        share = ti.min(share, soft.share(sim.particles.widest[p][0], full[0], soft.G_f_I, sim.band))
    return share < 0.5


@ti.func
def start_crack(sim: ti.template(), p, mode, angle, time):
    """From now on a particle loses strength in tension (1) or shear (2); its crack's normal lies at `angle` [rad]."""
    particles = sim.particles
    ti.atomic_min(sim.events.onset[None], time)
    particles.mode[p] = mode
    particles.crack_angle[p] = angle
    if mode == 1:
        particles.widest[p] = ti.Vector([FRESH, 0.0])
        if ti.static(sim.averaging):
            particles.worn[p] = FRESH
    else:
        particles.slip[p] = ti.max(particles.slip[p], FRESH)


@ti.func
def spring_energy(sim: ti.template(), p):
    """Energy per volume that partly opened cracks give back on closing: half of secant stiffness times opening^2."""
    particles = sim.particles
    tension = strength_left(sim, p)
    opening, widest = particles.opening[p], particles.widest[p]
    energy = 0.0
    for d in ti.static(range(2)):
        energy += 0.5 * tension[d] * opening[d] * opening[d] / ti.max(widest[d], FRESH)
    return energy


@ti.func
def open_cracks(sim: ti.template(), p, s, left):
    """Stress in the crack's frame after both cracks have opened or closed; moves openings, and the frame if it turns.

    `s`: elastic trial stress in that frame; `left`: see `strength_left`.
    """
    particles, law = sim.particles, sim.rock.after_failure
    M, lam, lam_z = ti.static(sim.rock.elasticity.crack_stiffness)
    opening, widest = particles.opening[p], particles.widest[p]
    shut = s + ti.Vector(
        [
            M * opening[0] + lam * opening[1],
            lam * opening[0] + M * opening[1],
            lam_z * (opening[0] + opening[1]),
            0.0,
        ]
    )
    if ti.static(law.rotating):
        # to the nearer principal direction, so that each crack keeps its own history
        turn = principal_angle(shut)
        turn -= 0.5 * math.pi * ti.round(turn / (0.5 * math.pi))
        half = 0.5 * (shut[0] - shut[1])
        if ti.sqrt(half * half + shut[3] * shut[3]) < NO_DIRECTION * sim.rock.criterion.tensile_strength:
            turn = 0.0
        shut = turned(shut, turn)
        particles.crack_angle[p] = particles.crack_angle[p] + turn
    for _ in ti.static(range(SWEEPS)):
        opening[0] = law.opening(shut[0] - lam * opening[1], left[0], widest[0], M)
        opening[1] = law.opening(shut[1] - lam * opening[0], left[1], widest[1], M)
    particles.opening[p] = opening
    particles.widest[p] = ti.max(widest, opening)
    return shut - ti.Vector(
        [
            M * opening[0] + lam * opening[1],
            lam * opening[0] + M * opening[1],
            lam_z * (opening[0] + opening[1]),
            0.0,
        ]
    )


@ti.func
def slip_on_crack(sim: ti.template(), p, s, left):
    """Shear across the crack is at most what its envelope allows; more of it slips.

    tau^2 = (c - s_nn tan(phi_r))^2 - (c - f tan(phi_r))^2 with what is left of cohesion c and tensile strength f:
    the hyperbola of Carol, Prat & Lopez (1997), J. Eng. Mech. 123:765, eq. 3. No shear while the crack opens, where
    s_nn = f, so that no fracture energy is spent twice; friction |s_nn| tan(phi_r) when nothing is left.
    """
    particles, law = sim.particles, sim.rock.after_failure
    full = strengths(sim, p)
    f = left[0]
    c = full[1] * f / full[0]  # cohesion of the crack is lost with its tensile strength
    reach, vertex = c - s[0] * law.tan_residual, c - f * law.tan_residual
    limit = ti.sqrt(ti.max(reach * reach - vertex * vertex, 0.0))
    limit = ti.select(s[0] < f, limit, 0.0)
    excess = ti.abs(s[3]) - limit
    if excess > 0.0:
        particles.slip[p] = particles.slip[p] + excess / sim.rock.elasticity.mu
        s[3] = ti.select(s[3] > 0.0, limit, -limit)
    return s


@ti.func
def slip_everywhere(sim: ti.template(), p, s, cohesion):
    """Mohr-Coulomb of crushed rock on every plane, with what is left of its cohesion, at constant volume.

    In the plane the mean stress stays and the radius shrinks; sigma_zz is then held between what the envelope allows
    beside the two in-plane stresses. A plate has none, and nothing beside it.
    """
    particles, law, criterion = sim.particles, sim.rock.after_failure, sim.rock.criterion
    share = cohesion / strengths(sim, p)[1]
    sin_phi = law.sin_residual + (criterion.sin_phi - law.sin_residual) * share
    c_cos_phi = cohesion * ti.sqrt(1.0 - sin_phi * sin_phi)
    centre, half = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1])
    radius = ti.sqrt(half * half + s[3] * s[3])
    most = ti.max(c_cos_phi - centre * sin_phi, 0.0)
    if radius > most:
        particles.slip[p] = particles.slip[p] + (radius - most) / sim.rock.elasticity.mu
        scale = most / radius
        s[0], s[1], s[3] = centre + half * scale, centre - half * scale, s[3] * scale
        radius = most
    if ti.static(not sim.rock.elasticity.plane_stress):
        flow, strength = (1.0 + sin_phi) / (1.0 - sin_phi), 2.0 * c_cos_phi / (1.0 - sin_phi)
        most_pressed, least_pressed = flow * (centre + radius) - strength, (centre - radius + strength) / flow
        s[2] = ti.max(ti.min(s[2], least_pressed), most_pressed)
    return s


@ti.func
def release(sim: ti.template(), p, G, time):
    """Stress of a cracked particle, from its elastic trial stress in particles.sigma; returns (stress, lost).

    `lost`: energy per volume that went into opening, slip and damage in this step. G: displacement gradient.
    """
    particles, elasticity = sim.particles, sim.rock.elasticity
    trial = particles.sigma[p]
    before = elasticity.energy(trial) + spring_energy(sim, p)
    if ti.static(sim.averaging):
        particles.worn[p] = ti.max(particles.worn[p], particles.mean_opening[p])
    left = strength_left(sim, p)
    particles.crack_angle[p] = particles.crack_angle[p] + rotation_angle(G)
    s = open_cracks(sim, p, turned(trial, particles.crack_angle[p]), left)
    if ti.static(not sim.rock.after_failure.rotating):
        if particles.mode[p] == 1:
            s = slip_on_crack(sim, p, s, left)
    if particles.mode[p] == 1:
        load = load_factors(sim, p, extreme_principals(s))
        if sim.rock.criterion.shear_load(load[0], load[1]) >= 1.0:
            start_crack(sim, p, 2, particles.crack_angle[p], time)
            left = strength_left(sim, p)
    if particles.mode[p] == 2:
        s = slip_everywhere(sim, p, s, left[2])
    sigma = turned(s, -particles.crack_angle[p])
    # the step's work is done by the mean of old and new stress, that of the trial by more
    too_much = 0.5 * double_contraction(trial - sigma, symmetric(G))
    lost = before - elasticity.energy(sigma) - spring_energy(sim, p) - too_much
    return sigma, lost
