"""How near each particle is to failure, and how much of its strength it has lost: looked at, never acted on.

Load factors of the stress that decides on failure, with strengths k sigma_t and k c of the particle's own rock:

    tension = sigma_1/(k sigma_t),    shear = ((sigma_1 - sigma_3)/2 + (sigma_1 + sigma_3)/2 sin(phi))/(k c cos(phi)),

the terms of eq. 11 and 12 of the paper, each 1 at failure; margin = 1 - max(tension, shear, 0). With a nonlocal mean,
shear is of sigma_1 no greater than the tensile strength, as in the check.
"""

import numpy as np
import taichi as ti

from rsmpm_ti.failure.nonlocal_fields import mean_stress, sum_nonlocal
from rsmpm_ti.failure.of_rock import belongs
from rsmpm_ti.failure.stress_update import own_shear_load
from rsmpm_ti.rock.criteria import load_factors, tensile_strength
from rsmpm_ti.rock.tensors import extreme_principals, principal_normal


@ti.func
def tensile_load(sim: ti.template(), p, own):
    """Load factor in tension: `own`, by the particle's own stress, or by what decides instead with a nonlocal mean.

    That is the mean stress, own stress at a crack's tip and in its band, and part of it near a crack.
    """
    load = own
    if ti.static(sim.is_nonlocal):
        rule = sim.rock.nonlocal_mean
        load = rule.own_part(sim, p, principal_normal(sim.particles.sigma[p])) * own
        mean = mean_stress(sim, p)
        if rule.own_part(sim, p, principal_normal(mean)) < 1.0:
            deciding = mean
            if rule.at_tip(sim, p):
                deciding = sim.particles.sigma[p]
            load = ti.max(load, rule.tension_across(sim, p, deciding) / tensile_strength(sim, p))
    return load


@ti.kernel
def evaluate_damage(
    sim: ti.template(),
    governs: ti.types.ndarray(dtype=ti.i32, ndim=1),
    damage: ti.types.ndarray(dtype=ti.f64, ndim=1),
    failed: ti.types.ndarray(dtype=ti.i32, ndim=1),
):
    particles, law = sim.particles, sim.rock.after_failure
    for p in particles.mode:
        if particles.mode[p] != 0 and belongs(sim, p):
            governs[p], damage[p], failed[p] = particles.mode[p], law.damage(sim, p), law.failed_mode(sim, p)


@ti.kernel
def evaluate_margins(
    sim: ti.template(),
    margin: ti.types.ndarray(dtype=ti.f64, ndim=1),
    governs: ti.types.ndarray(dtype=ti.i32, ndim=1),
):
    particles, criterion = sim.particles, sim.rock.criterion
    for p in particles.mode:
        if not belongs(sim, p):
            continue
        if particles.mode[p] == 0:
            load = load_factors(sim, p, extreme_principals(particles.sigma[p]))
            tension = tensile_load(sim, p, load[0] / criterion.tensile_strength)
            shear = own_shear_load(sim, load)
            margin[p] = 1.0 - ti.max(tension, shear, 0.0)
            if ti.max(tension, shear) > 0.0:
                governs[p] = ti.select(tension >= shear, 1, 2)  # tension is checked first
        else:
            margin[p] = 0.0


def _that_break(sim) -> list:
    """Views of the rocks that may break."""
    return [view for view in sim.views if view.rock.criterion.breaks]


def damages(sim) -> dict[str, np.ndarray]:
    """`damage`, `failure_mode` and what `governs` it of particles that have begun to crack, [n] each, 0 in others."""
    n = sim.particles.count
    governs, damage, failed = np.zeros(n, dtype=np.int32), np.zeros(n), np.zeros(n, dtype=np.int32)
    for view in _that_break(sim):
        evaluate_damage(view, governs, damage, failed)
    return {"governs": governs, "damage": damage, "failure_mode": failed}


def margins(sim) -> dict[str, np.ndarray]:
    """`margin` to failure, what `governs` it (0 nothing, 1 tension, 2 shear), `damage` and `failure_mode`, [n] each, as
    particles lie.

    NaN, 0, 0 and 0 everywhere in rock that does not break. See `Snapshot` for what they mean in rock that has failed.
    """
    margin, found = np.full(sim.particles.count, np.nan), damages(sim)
    for view in _that_break(sim):
        if view.is_nonlocal:
            sum_nonlocal(view)
        evaluate_margins(view, margin, found["governs"])
    return {"margin": margin, **found}
