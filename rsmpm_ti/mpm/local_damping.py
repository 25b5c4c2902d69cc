"""Local damping: a force against the motion, as large as a fraction of the force out of balance.

    dv <- dv - a |dv| sign(v - v_0)        component by component

Cundall (1987), in Brown (ed.), Analytical and Computational Methods in Engineering Rock Mechanics, ch. 4. Nothing is
damped at rest or in steady motion, where no force is out of balance; what swings loses energy at every frequency alike.
v_0 is the motion of the platens, linear from one to the other, so that a specimen that is strained uniformly or carried
by them feels nothing. Here dv is a particle's, not a node's, so that rock that has failed is known and left alone, and
with it what flies free: without force there is no dv. The damping never turns v - v_0 round.

Energy: from v_old to v' the kinetic energy changes by the impulse times the mean velocity, for stress and damping alike
(leapfrog). What damping takes, (v - v').((v_old + v')/2 - v_0), is dissipated; the rest of its work, (v' - v).v_0, is
that of a force that goes along with the platens.
"""

import taichi as ti

from rsmpm_ti.failure.of_rock import density_at

UNDAMPED = -1
"""In place of a slot of the ledger: a change of velocity that is no part of the motion."""


@ti.func
def platen_motion(sim: ti.template(), p):
    """v_0 of a particle."""
    lower, upper, axis = ti.static(sim.ends)
    below, above = ti.cast(sim.ledger.speed[lower], float), ti.cast(sim.ledger.speed[upper], float)
    x = sim.particles.reference[p][axis] + sim.particles.u[p][axis]
    first = ti.cast(ti.static(sim.boundaries[lower].position) + sim.grid.travel[axis, 0], float)
    last = ti.cast(ti.static(sim.boundaries[upper].position) + sim.grid.travel[axis, 1], float)
    part = ti.math.clamp((x - first) / (last - first), 0.0, 1.0)
    motion = ti.Vector.zero(float, sim.dim)
    motion[axis] = below + (above - below) * part
    return motion


@ti.func
def damped(sim: ti.template(), p, v_old, v, dv, slot):
    """Velocity of a particle, v without damping, whose nodes changed theirs by dv; books what it loses."""
    found = v
    if ti.static(sim.local_damping > 0.0):
        motion = platen_motion(sim, p)
        for d in ti.static(range(sim.dim)):
            relative = v[d] - motion[d]
            change = ti.min(sim.local_damping * ti.abs(dv[d]), ti.abs(relative))
            found[d] -= ti.select(relative > 0.0, change, -change)
        if ti.static(sim.particles.breaks):
            found = ti.select(sim.particles.mode[p] == 0, found, v)
        if slot == UNDAMPED:
            found = v  # and nothing is booked: all that follows is 0
        mass, taken = density_at(sim, p) * sim.particles.volume[p], found - v
        work = ti.cast(mass * taken.dot(motion), ti.f64)
        lost = -ti.cast(mass * taken.dot(0.5 * (found + v_old) - motion), ti.f64)
        booked = ti.max(slot, 0)
        sim.ledger.body_work[booked] = sim.ledger.body_work[booked] + work
        sim.ledger.damped[booked] = sim.ledger.damped[booked] + lost
    return found
