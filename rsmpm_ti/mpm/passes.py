"""The kernels that see particles and nodes together. They know no dimension, law or scheme by name.

Every pass goes over spans of particles in cell order (see parallel.py), and a span in blocks that stay in the
processor's nearest memory, a loop for each thing done to a block: over particles of a run where node values are needed
(see stencil.py), else over all of the block. Such a loop without branches, whose node values are locals, is what LLVM
turns into vector instructions; a branch or an atomic in it is what stops that, and so is a loop that is the first in
its scope to touch a field.
"""

from dataclasses import dataclass

import taichi as ti

from rsmpm_ti.fields.parallel import over_particles
from rsmpm_ti.fields.stencil import coordinates
from rsmpm_ti.mpm.g2p import new_stress, nodes_to_particles
from rsmpm_ti.mpm.holes.press import book_remap
from rsmpm_ti.mpm.nodes import new_velocity, update_node_and_clear
from rsmpm_ti.mpm.p2g import particles_to_nodes
from rsmpm_ti.mpm.remap import remap_span, velocity_after_remap

BLOCK = 256
"""Particles of a block: some 40 kB."""


@ti.func
def find_bases(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    """Keys of the base nodes of particles [start, stop), where they are now."""
    frame = sim.grid.frame()
    for p in range(start, stop):
        sim.particles.base[p] = sim.grid.key(sim.grid.base(coordinates(sim, p, frame), sim.shape))


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Pass:
    """What one pass over the particles does: nodes to particles, then back to nodes while they are at hand.

    Momentum, with mass, goes to the nodes around the particles' new positions. Force alone goes to the nodes of the
    step's start, to which it belongs.
    """

    velocity: bool = False  # v_p, and its affine matrix
    position: bool = False  # u_p
    stress: bool = False  # L, sigma, J and the failure check
    momentum: bool = False  # mass and momentum to nodes
    force: bool = False  # force to nodes

    @property
    def stages(self) -> tuple:
        """Functions of (sim, start, stop, slot, what, dt, time), done to each block of particles in turn."""
        asked = {
            nodes_to_particles: self.velocity or self.position or self.stress,
            new_stress: self.stress,
            find_bases: self.momentum,
            particles_to_nodes: self.momentum or self.force,
        }
        return tuple(stage for stage, wanted in asked.items() if wanted)

    @property
    def force_lag(self) -> float:
        """Steps from the time at which the force field is taken to the time of the pass, a step's end."""
        return 0.0 if self.momentum else 1.0


@ti.func
def block_by_block(sim: ti.template(), start, stop, slot, what: ti.template(), dt, time):
    first = start
    while first < stop:
        last = ti.min(first + BLOCK, stop)
        for stage in ti.static(what.stages):
            stage(sim, first, last, slot, what, dt, time)
        first = last


@ti.kernel
def p2g(sim: ti.template(), what: ti.template(), time: ti.f64, ticket: int):
    """Particles to nodes, where the particles are now."""
    over_particles(sim, block_by_block, what, 0.0, time, ticket)


@ti.kernel
def g2p(sim: ti.template(), what: ti.template(), dt: float, time: ti.f64, ticket: int):
    """Nodes to particles, and back to nodes if asked; `time` at the step's end."""
    over_particles(sim, block_by_block, what, dt, time, ticket)


@ti.kernel
def musl_step(sim: ti.template(), what: ti.template(), dt: float, factor: float, time: ti.f64, ticket: int):
    """A whole step: one launch instead of four, each of which costs 0.1 ms. Takes two tickets."""
    for _ in range(1):
        sim.grid.push(sim.ledger.impulse, dt, factor)
        sim.grid.move(dt, factor)
    new_velocity(sim, update_node_and_clear, sim.nodes.momentum_columns, dt, factor)
    over_particles(sim, remap_span, what, dt, time, ticket)
    velocity_after_remap(sim, dt, factor)
    book_remap(sim, dt)
    over_particles(sim, block_by_block, what, dt, time, ticket + 1)
