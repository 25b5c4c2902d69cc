"""Stress of one particle of rock with smeared cracks: how they open, slip and close, and what that costs.

Functions of `sim` and a particle p, for the law in smeared_crack.py, whose history they read and write. Stresses in the
frame of the crack are packed as (nn, tt, zz, nt): n across it, t along it.
"""

import math

import taichi as ti

from rsmpm_ti.rock.broken.crushed_rock import crushed_stress
from rsmpm_ti.rock.criteria import load_factors, strengths
from rsmpm_ti.rock.tensors import (
    double_contraction,
    extreme_principals,
    in_frame,
    material_normal,
    midpoint_gradient,
    out_of_frame,
    principal_angle,
    rotated_vector,
    symmetric,
)

MIN_CRACK_STRAIN = 1e-12
"""Crack strain that marks a direction as cracked: with it a brittle law has no strength left, others have all."""

MIN_DIRECTION = 1e-5
"""Radius of in-plane stress over tensile strength below which a rotating crack stays: round-off has no direction."""

SWEEPS = 4
"""Sweeps over the two crack strains; each leaves (lam/M)^2 of the error, 3 % for nu = 0.14 and 11 % for nu = 0.25."""


@ti.func
def strength_left(sim: ti.template(), p):
    """What is left of the tensile strength across the crack and across the one at right angles, and of cohesion [Pa].

    Slip costs tensile strength along with cohesion: that of the crack it is on, of all planes if crushed.
    """
    h, soft = sim.particles.history, sim.rock.after_failure.softening
    full = strengths(sim, p)
    n = soft.ratio(sim.rock.nonlocal_mean.softening_strain(sim, p), full[0], soft.G_f_I, sim.band)
    t = soft.ratio(h.crack_strain_max[p][1], full[0], soft.G_f_I, sim.band)
    shear = soft.ratio(sim.rock.nonlocal_mean.softening_slip(sim, p), full[1], soft.G_f_II, sim.band)
    if sim.particles.mode[p] == 2:
        t = ti.min(t, shear)
    return ti.Vector([ti.min(n, shear) * full[0], t * full[0], shear * full[1]])


@ti.func
def has_failed(sim: ti.template(), p, mode):
    """Whether a particle cracked by `mode` (1 tension, 2 shear) has itself opened or slipped by what costs half of the
    strength: what is only torn along by a crack beside it has lost its strength, but is no crack."""
    h, soft = sim.particles.history, sim.rock.after_failure.softening
    full = strengths(sim, p)
    left = soft.ratio(h.slip[p], full[1], soft.G_f_II, sim.band)
    if mode == 1:
        left = ti.min(left, soft.ratio(h.crack_strain_max[p][0], full[0], soft.G_f_I, sim.band))
    return left < 0.5


@ti.func
def spring_energy(sim: ti.template(), p):
    """Energy per volume that partly opened cracks give back on closing: half of secant stiffness times strain^2.

    Pores of crushed rock give none back.
    """
    h, tension = sim.particles.history, strength_left(sim, p)
    strain, largest = h.crack_strain[p], h.crack_strain_max[p]
    energy = 0.0
    for d in ti.static(range(2)):
        energy += 0.5 * tension[d] * strain[d] * strain[d] / ti.max(largest[d], MIN_CRACK_STRAIN)
    return ti.select(sim.particles.mode[p] == 1, energy, 0.0)


@ti.func
def stress_lost(sim: ti.template(), strain):
    """Stress that crack strains (e_n, e_t) take from the closed crack's, in its frame."""
    M, lam, lam_z = ti.static(sim.rock.elasticity.crack_stiffness)
    return ti.Vector(
        [M * strain[0] + lam * strain[1], lam * strain[0] + M * strain[1], lam_z * (strain[0] + strain[1]), 0.0]
    )


@ti.func
def turn_crack(sim: ti.template(), p, closed):
    """A rotating crack follows the nearer principal direction, so that each crack keeps its own history.

    Returns the stress in the turned frame.
    """
    h = sim.particles.history
    turn = principal_angle(closed)
    turn -= 0.5 * math.pi * ti.round(turn / (0.5 * math.pi))
    half = 0.5 * (closed[0] - closed[1])
    if ti.sqrt(half * half + closed[3] * closed[3]) < MIN_DIRECTION * sim.rock.criterion.tensile_strength:
        turn = 0.0
    n, cos, sin = h.crack_normal[p], ti.cos(turn), ti.sin(turn)
    h.crack_normal[p] = ti.Vector([cos * n[0] - sin * n[1], sin * n[0] + cos * n[1]])
    return in_frame(closed, ti.Vector([cos, sin]))


@ti.func
def open_cracks(sim: ti.template(), p, s, left):
    """Stress in the crack's frame after both cracks have opened or closed; moves crack strains, and a rotating frame.

    `s`: elastic trial stress in that frame; `left`: see `strength_left`.
    """
    h, law = sim.particles.history, sim.rock.after_failure
    M, lam, _lam_z = ti.static(sim.rock.elasticity.crack_stiffness)
    strain, largest = h.crack_strain[p], h.crack_strain_max[p]
    trial_closed = s + stress_lost(sim, strain)
    if ti.static(law.rotating):
        trial_closed = turn_crack(sim, p, trial_closed)
    for _ in ti.static(range(SWEEPS)):
        strain[0] = law.crack_strain(trial_closed[0] - lam * strain[1], left[0], largest[0], M)
        strain[1] = law.crack_strain(trial_closed[1] - lam * strain[0], left[1], largest[1], M)
    h.crack_strain[p] = strain
    h.crack_strain_max[p] = ti.max(largest, strain)
    return trial_closed - stress_lost(sim, strain)


@ti.func
def slip_on_crack(sim: ti.template(), p, s, left):
    """Shear across the crack is at most what its envelope allows; more of it slips.

    tau^2 = (c - s_nn tan(phi_r))^2 - (c - f tan(phi_r))^2 with what is left of cohesion c and tensile strength f:
    the hyperbola of Carol, Prat & Lopez (1997), J. Eng. Mech. 123:765, eq. 3. No shear while the crack opens, where
    s_nn = f, so that no fracture energy is spent twice; friction |s_nn| tan(phi_r) when nothing is left.
    """
    h, law = sim.particles.history, sim.rock.after_failure
    full = strengths(sim, p)
    f = left[0]
    c = full[1] * f / full[0]  # cohesion of the crack is lost with its tensile strength
    reach, vertex = c - s[0] * law.tan_residual, c - f * law.tan_residual
    limit = ti.sqrt(ti.max(reach * reach - vertex * vertex, 0.0))
    limit = ti.select(s[0] < f, limit, 0.0)
    excess = ti.abs(s[3]) - limit
    if excess > 0.0:
        h.slip[p] = h.slip[p] + excess / sim.rock.elasticity.mu
        s[3] = ti.select(s[3] > 0.0, limit, -limit)
    return s


@ti.func
def crush(sim: ti.template(), p):
    """The particle fails in shear: what its cracks are open by is the pores of crushed rock from now on."""
    particles, h = sim.particles, sim.particles.history
    particles.mode[p] = 2
    h.slip[p] = ti.max(h.slip[p], MIN_CRACK_STRAIN)
    sim.rock.nonlocal_mean.begin_slip(sim, p, MIN_CRACK_STRAIN)
    pores = h.crack_strain[p][0] + h.crack_strain[p][1]
    h.crack_strain[p] = ti.Vector([pores, 0.0])
    h.crack_strain_max[p] = ti.max(h.crack_strain_max[p], h.crack_strain[p])


@ti.func
def crack_return(sim: ti.template(), p, G):
    """Stress of a cracked particle from its elastic trial stress in particles.sigma; returns (stress, energy lost).

    Energy lost: per volume of solid, by opening, slip and damage in this step. G: displacement gradient of the step.
    """
    particles, elasticity, h = sim.particles, sim.rock.elasticity, sim.particles.history
    trial, strain = particles.sigma[p], symmetric(midpoint_gradient(G))
    spring = spring_energy(sim, p)
    sim.rock.nonlocal_mean.follow(sim, p)
    before = h.crack_normal[p]
    turned = rotated_vector(before, G)
    if ti.static(sim.rock.after_failure.rotating):
        h.crack_normal[p] = turned
    else:
        h.crack_normal[p] = material_normal(before, G)
    sigma = trial
    if particles.mode[p] == 1:
        # rock beside a crack turns with its faces, not with the mean spin, half of which is slip
        middle = (before + h.crack_normal[p]).normalized()
        load = elasticity.load(strain)
        strain = in_frame(strain, middle)
        s = in_frame(trial - load, turned) + elasticity.load(strain)
        trial = out_of_frame(s, h.crack_normal[p])
        strain = out_of_frame(strain, h.crack_normal[p])
        left = strength_left(sim, p)
        s = open_cracks(sim, p, s, left)
        if ti.static(not sim.rock.after_failure.rotating):
            s = slip_on_crack(sim, p, s, left)
        factors = load_factors(sim, p, extreme_principals(s))
        if sim.rock.criterion.shear_load(factors[0], factors[1]) >= 1.0:
            crush(sim, p)
        sigma = out_of_frame(s, h.crack_normal[p])
    if particles.mode[p] == 2:
        sigma = crushed_stress(sim, p, sigma, strength_left(sim, p))
    # the step's work is done by the mean of old and new stress, that of the trial by more
    too_much = 0.5 * double_contraction(trial - sigma, strain)
    dissipated = elasticity.energy(trial) + spring - elasticity.energy(sigma) - spring_energy(sim, p) - too_much
    return sigma, dissipated
