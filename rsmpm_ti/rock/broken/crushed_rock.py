"""Stress of rock that has failed in shear: grains with pores, which flow, carry no tension and slide with friction.

The strain of a crushed particle is elastic strain, plastic strain, and a volume of pores g >= 0 that is open (the
logarithm of its volume ratio). See docs/laws.md for why every step of it loses energy. A step goes from the elastic
trial stress

1. to pores: while any are open there is no pressure, and a loss of volume closes them first; a mean stress beyond the
   tensile strength that is left opens them;
2. to Mohr-Coulomb: all three principal stresses, at constant volume, or with dilation where pores are closed;
3. to the tension cut-off: the deviator shrinks until no principal stress exceeds the tensile strength that is left.

In a plate (plane stress) the third stress is 0, and mean stress and volume are those of the plane.
"""

import taichi as ti

from rsmpm_ti.rock.broken.principal_return import mohr_coulomb_return
from rsmpm_ti.rock.criteria import strengths


@ti.func
def fill_pores(sim: ti.template(), p, mean, most):
    """Mean stress after pores have opened or closed: at most `most`, and no pressure while any are open."""
    h, stiffness = sim.particles.history, sim.rock.elasticity.pore_stiffness
    pores, kept = h.crack_strain[p], mean
    if mean < 0.0:
        closed = ti.min(pores[0], -mean / stiffness)
        pores[0] -= closed
        # exactly 0 where pores stay open, so that what is left of them is no pressure
        kept = ti.select(pores[0] > 0.0, 0.0, mean + stiffness * closed)
    elif mean > most:
        pores[0] += (mean - most) / stiffness
        kept = most
    h.crack_strain[p] = pores
    h.crack_strain_max[p] = ti.max(h.crack_strain_max[p], pores)
    return kept


@ti.func
def friction(sim: ti.template(), p, cohesion):
    """(sin(phi), c cos(phi)) of what is left of `cohesion`: phi goes from that of whole rock to the residual one."""
    law, criterion = sim.rock.after_failure, sim.rock.criterion
    ratio = cohesion / strengths(sim, p)[1]
    sin_phi = law.sin_residual + (criterion.sin_phi - law.sin_residual) * ratio
    return sin_phi, cohesion * ti.sqrt(1.0 - sin_phi * sin_phi)


@ti.func
def flow_in_space(sim: ti.template(), p, a, b, z, sin_phi, sin_psi, c_cos_phi):
    """Principal stresses a >= b in the plane and z after Mohr-Coulomb in all three."""
    elasticity = sim.rock.elasticity
    first, second = ti.max(a, z), ti.min(a, z)
    middle, last = ti.max(second, b), ti.min(second, b)
    out, slip = mohr_coulomb_return(
        ti.Vector([first, middle, last]), sin_phi, sin_psi, c_cos_phi, elasticity.lam, elasticity.mu
    )
    h = sim.particles.history
    h.slip[p] = h.slip[p] + slip
    found = ti.Vector([out[0], out[2], out[1]])  # z between the two
    if z > a:
        found = ti.Vector([out[1], out[2], out[0]])
    elif z < b:
        found = ti.Vector([out[0], out[1], out[2]])
    return found


@ti.func
def flow_in_plate(sim: ti.template(), p, a, b, sin_phi, c_cos_phi):
    """Principal stresses a >= b of a plate after Mohr-Coulomb: between them at constant area, and beside the 0 of the
    third, where the plate bulges and both shrink."""
    h, mu = sim.particles.history, sim.rock.elasticity.mu
    centre, radius = 0.5 * (a + b), 0.5 * (a - b)
    most = ti.max(c_cos_phi - centre * sin_phi, 0.0)
    if radius > most:
        h.slip[p] = h.slip[p] + (radius - most) / mu
        radius = most
    uniaxial = 2.0 * c_cos_phi / (1.0 - sin_phi)
    scale = 1.0
    if radius - centre > uniaxial:
        scale = uniaxial / (radius - centre)
        h.slip[p] = h.slip[p] + 0.5 * (1.0 - scale) * (radius - centre) / mu
    return ti.Vector([scale * (centre + radius), scale * (centre - radius), 0.0])


@ti.func
def crushed_stress(sim: ti.template(), p, s, left):
    """Packed stress of a crushed particle from the packed trial stress s; moves its pores and its slip.

    `left`: what is left of tensile strength across two directions and of cohesion [Pa]: `strength_left`.
    """
    law, h, elasticity = sim.rock.after_failure, sim.particles.history, sim.rock.elasticity
    sin_phi, c_cos_phi = friction(sim, p, left[2])
    tensile = ti.min(left[0], left[1], c_cos_phi / ti.max(sin_phi, 1e-30))
    centre, half = 0.5 * (s[0] + s[1]), 0.5 * (s[0] - s[1])
    radius = ti.sqrt(half * half + s[3] * s[3])
    mean = centre
    if ti.static(not elasticity.plane_stress):
        mean = (2.0 * centre + s[2]) / 3.0
    kept = fill_pores(sim, p, mean, tensile)
    a, b, z = centre + radius + kept - mean, centre - radius + kept - mean, s[2] + kept - mean
    principal = ti.Vector([a, b, 0.0])
    if ti.static(elasticity.plane_stress):
        principal = flow_in_plate(sim, p, a, b, sin_phi, c_cos_phi)
        kept = 0.5 * (principal[0] + principal[1])
    else:
        sin_psi = ti.select(h.crack_strain[p][0] > 0.0, 0.0, ti.min(law.sin_dilation(h.slip[p], sim.band), sin_phi))
        principal = flow_in_space(sim, p, a, b, z, sin_phi, sin_psi, c_cos_phi)
        kept = (principal[0] + principal[1] + principal[2]) / 3.0
    largest = ti.max(principal[0], principal[2])
    if largest > tensile:
        shrink = ti.max(tensile - kept, 0.0) / ti.max(largest - kept, 1e-30)
        principal = kept + shrink * (principal - kept)
        if ti.static(elasticity.plane_stress):
            principal[2] = 0.0
    centre = 0.5 * (principal[0] + principal[1])
    scale = 0.5 * (principal[0] - principal[1]) / ti.max(radius, 1e-30)
    return ti.Vector([centre + half * scale, centre - half * scale, principal[2], s[3] * scale])
