"""Rock against platens that push and do not pull: how near it is, and what the platens do to a node.

A node of the plane pushes while rock touches the plane (its nearest particle has arrived: a shape function alone would
make that 0.75 to 1.5 cells early) and would otherwise go through it. So contact is Signorini's condition in
velocities, v_n <= v_platen with a pressure only where they are equal: Moreau (1988), Unilateral contact and dry
friction in finite freedom dynamics, sec. 10. One impulse decides, so nothing chatters.
"""

import taichi as ti

from rsmpm_ti.fields.contacts import NOTHING_NEAR
from rsmpm_ti.fields.stencil import MAX_RUN, coordinates


@ti.func
def clear_gaps(sim: ti.template()):
    for plane in ti.static(range(len(sim.contacts.planes))):
        ti.loop_config(serialize=sim.nodes.serial)
        for j in ti.grouped(ti.ndrange(*sim.contacts.planes[plane].extent)):
            sim.contacts.gaps[plane][j] = NOTHING_NEAR


@ti.func
def find_gaps(sim: ti.template(), first, last, base, frame):
    """Tell the planes that a run of particles reaches how near it is: its nearest edge, to every node it reaches."""
    for plane in ti.static(range(len(sim.contacts.planes))):
        axis, row, inward = ti.static(sim.contacts.planes[plane][:3])
        near = base[axis] <= row
        if ti.static(inward < 0):
            near = base[axis] + (sim.shape.width - 1) >= row
        if near:
            gap = ti.cast(NOTHING_NEAR, float)
            for k in range((last - first) & MAX_RUN):
                gap = ti.min(
                    gap, inward * (coordinates(sim, first + k, frame)[axis] - row) - half(sim, first + k, frame, axis)
                )
            for offset in ti.static(sim.stencil):
                if ti.static(offset[axis] == 0):
                    ti.atomic_min(sim.contacts.gaps[plane][sim.contacts.across(plane, base + ti.Vector(offset))], gap)


@ti.func
def half(sim: ti.template(), p, frame, axis: ti.template()):
    """Half the length of a particle along an axis [cells], of a square or cube at the start.

    What it has been squeezed by, J, is taken as squeezed along the axis, as beside a platen. Rock that has opened is no
    longer than it was.
    """
    volume = sim.particles.volume[p]
    edge = ti.sqrt(volume)
    if ti.static(sim.dim == 3):
        edge = volume ** (1.0 / 3.0)
    return 0.5 * edge * ti.min(sim.particles.J[p], 1.0) * frame[axis, 1]


@ti.func
def touching(sim: ti.template(), b: ti.template(), i):
    """Whether boundary b may act on a node that lies on its plane or beyond it."""
    found = True
    if ti.static(sim.boundaries[b].unilateral):
        found = sim.contacts.touches(ti.static(sim.contacts.plane_of[b]), i)
    return found


@ti.func
def keep_state(sim: ti.template(), b: ti.template(), i, state):
    """Remember what a node of the plane did: what is mapped back to it later in the step is held the same way."""
    if ti.static(sim.boundaries[b].unilateral):
        plane = ti.static(sim.contacts.plane_of[b])
        if i[ti.static(sim.contacts.planes[plane].axis)] == ti.static(sim.contacts.planes[plane].row):
            sim.contacts.states[plane][sim.contacts.across(plane, i)] = state


@ti.func
def kept_state(sim: ti.template(), b: ti.template(), i):
    """What a node, or for one beyond the plane the node of the plane, did last."""
    state = 0
    if ti.static(sim.boundaries[b].unilateral):
        plane = ti.static(sim.contacts.plane_of[b])
        state = sim.contacts.states[plane][sim.contacts.across(plane, i)]
    return state


@ti.func
def squeeze(sim: ti.template(), dt):
    """Velocity that the confining pressure takes from a node of a plane in a step [m/s]: dt p A / m.

    Platens press with it too, though it does not show in the forces of nodes (see confinement.py). A node of a plane
    holds the mass m = share rho dx A of the rock before it.
    """
    taken = 0.0
    if ti.static(sim.confined):
        taken = dt * sim.confinement / (sim.contacts.share * sim.density * sim.grid.dx)
    return taken
