"""What the rock of a particle answers, in scenes of one rock and of several: nothing else asks how many there are.

A question is asked of a view of the run (`Simulation.views`), which is of one rock. With one rock it is asked of that,
and nothing is compiled beside it. With several, numbers are asked of all and the particle's own is chosen, which goes
without branches; what changes a particle is left to its own rock.
"""

import taichi as ti

from rsmpm_ti.failure.stress_update import check_failure, must_check, update_stress


@ti.func
def belongs(view: ti.template(), p):
    """Whether a particle is of the rock of a view."""
    found = True
    if ti.static(view.several):
        found = view.particles.rock[p] == view.index
    return found


@ti.func
def density_at(sim: ti.template(), p):
    """Of a particle's stress-free rock [kg/m^dim], with mass scaling."""
    density = ti.cast(sim.views[0].density, float)
    for view in ti.static(sim.views[1:]):
        density = ti.select(sim.particles.rock[p] == view.index, view.density, density)
    return density


@ti.func
def J_at_start(sim: ti.template(), p):
    """Volume over the stress-free one with which the rock started."""
    J = ti.cast(sim.views[0].J_start, float)
    for view in ti.static(sim.views[1:]):
        J = ti.select(sim.particles.rock[p] == view.index, view.J_start, J)
    return J


@ti.func
def _carried_stress(view: ti.template(), p):
    sigma = view.rock.viscosity.added_to(view, p, view.particles.sigma[p])
    ratio = view.particles.J[p]
    if ti.static(view.rock.criterion.breaks):
        ratio = view.rock.after_failure.carrying_ratio(view, p)
    return view.particles.volume[p] * ratio * sigma


@ti.func
def carried_stress(sim: ti.template(), p):
    """V_p (sigma_p - q), packed; V_p is the volume that carries stress."""
    carried = _carried_stress(sim.views[0], p)
    for view in ti.static(sim.views[1:]):
        carried = ti.select(sim.particles.rock[p] == view.index, _carried_stress(view, p), carried)
    return carried


@ti.func
def strain_step(sim: ti.template(), p, L, dt):
    """Elastic stress and J after one step; returns the energy that artificial viscosity took [J]."""
    taken = ti.cast(0.0, float)
    for view in ti.static(sim.views):
        if ti.static(not sim.several):
            taken = update_stress(view, p, L, dt)
        elif belongs(view, p):
            taken = update_stress(view, p, L, dt)
    return taken


@ti.func
def needs_check(sim: ti.template(), p):
    """1 for a particle that has failed or whose own stress has reached the criterion, else 0."""
    found = must_check(sim.views[0], p)
    for view in ti.static(sim.views[1:]):
        found = ti.select(sim.particles.rock[p] == view.index, must_check(view, p), found)
    return found


@ti.func
def check(sim: ti.template(), p, dt, time, slot):
    """The failure check, and the stress of failed rock."""
    for view in ti.static(sim.views):
        if ti.static(view.rock.criterion.breaks):
            if ti.static(not sim.several):
                check_failure(view, p, dt, time, slot)
            elif belongs(view, p):
                check_failure(view, p, dt, time, slot)


@ti.func
def energy_and_gap(sim: ti.template(), p):
    """Energy stored per stress-free volume [J/m^3], and whether pieces on both sides may part: 1 or 0."""
    stored, gap = ti.cast(0.0, float), 0
    for view in ti.static(sim.views):
        if ti.static(not sim.several):
            stored, gap = _energy_and_gap(view, p)
        elif belongs(view, p):
            stored, gap = _energy_and_gap(view, p)
    return stored, gap


@ti.func
def _energy_and_gap(view: ti.template(), p):
    particles, rock = view.particles, view.rock
    stored, gap = particles.J[p] * rock.elasticity.energy(particles.sigma[p]), 0
    if ti.static(rock.criterion.breaks):
        if particles.mode[p] != 0:
            stored, gap = rock.after_failure.stored(view, p), rock.after_failure.is_open(view, p)
    return stored, gap
