"""Particles at rest now, between two steps of a scheme whose velocities are half a step beside the positions.

Velocity 0 is no rest of such a scheme: the next step gives a body a whole kick dt a, where one that starts from rest at
this time gets half of it. Of a mode of frequency w, v <- v - dt w^2 x, x <- x + dt v keep v^2 + w^2 x^2 - dt w^2 x v,
which for given x is least at v = dt w^2 x/2 = -dt a/2. So only this stop takes energy whatever the mode and its phase;
with v = 0 fast modes may gain up to (w dt)^2/4 of their energy at each. Barnes (1999), Int. J. Space Struct. 14:89, has
it for starts after a peak. In usf, where stress moves first, the sign is the other.
"""

import taichi as ti

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.fields.stencil import coordinates, gather, weights_and_gradients
from rsmpm_ti.mpm.g2p import velocity_to_particle
from rsmpm_ti.mpm.holes.press import press
from rsmpm_ti.mpm.local_damping import UNDAMPED
from rsmpm_ti.mpm.nodes import clear_nodes, update_nodes
from rsmpm_ti.mpm.stepper import LOAD, scatter_all


@ti.kernel
def _kick(sim: ti.template(), share: float):
    """v_p, and C_p, from the change of the nodes' velocities in a step that starts from rest, times `share`."""
    particles = sim.particles
    for p in range(particles.count):
        frame = sim.grid.frame()
        xi = coordinates(sim, p, frame)
        base = sim.grid.base(xi, sim.shape)
        w, _ = weights_and_gradients(sim, xi, base, frame)
        dv_i = gather(sim, sim.nodes.f, base)
        velocity_to_particle(sim, p, w, xi, base, frame, dv_i, dv_i, UNDAMPED)
        particles.v[p] = share * particles.v[p]
        if ti.static(particles.affine):
            particles.C[p] = share * particles.C[p]


def bring_to_rest(sim: Simulation, dt: float, factor: float) -> None:
    """Of particles, and of platens that a force moves. dt [s], factor: those of the steps."""
    particles, ledger = sim.particles, sim.ledger
    particles.v.fill(0.0)
    if particles.affine:
        particles.C.fill(0.0)
    sim.grid.velocity.fill(0.0)
    impulse = ledger.impulse.to_numpy()  # the step that follows is not taken
    clear_nodes(sim)
    scatter_all(sim, LOAD, 0.0)
    press(sim, 0.0)
    update_nodes(sim, dt, factor)
    ledger.impulse.from_numpy(impulse)
    _kick(sim, 0.5 if sim.scene.order == "usf" else -0.5)
