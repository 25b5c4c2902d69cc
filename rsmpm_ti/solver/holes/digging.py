"""Excavations: when they are due, and how rock is taken out and its support put in its place."""

import math

import numpy as np
import taichi as ti

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.holes.press import press
from rsmpm_ti.mpm.nodes import clear_nodes
from rsmpm_ti.mpm.stepper import LOAD, scatter_all
from rsmpm_ti.solver.outflow import lay_aside
from rsmpm_ti.solver.survey import Survey, survey
from rsmpm_ti.spec.holes.excavation import Excavation, excavations_of, marks


@ti.kernel
def _take_out(sim: ti.template(), gone: ti.types.ndarray()):
    for p in sim.particles.key:
        frame = sim.grid.frame()
        if gone[p] != 0:
            lay_aside(sim, p, frame)


@ti.kernel
def _support(sim: ti.template(), first: int, last: int):
    """Against what the rock that is left and other holes put on the nodes of one hole, the rock's weight included; on
    the grid as it was at the start, as `_press` of mpm/holes takes it."""
    for k in range(first, last):
        i = sim.walls.node[k]
        frame = sim.grid.frame()
        volume = ti.cast(sim.grid.dx, ti.f64)
        for d in ti.static(range(sim.dim)):
            volume *= frame[d, 2] / sim.grid.dx
        force = -ti.cast(sim.nodes.f[i] + sim.nodes.mass[i] * ti.Vector(sim.acceleration), ti.f64)
        for d in ti.static(range(sim.dim)):
            sim.walls.q[k][d] = force[d] / (volume * frame[d, 1])


class Digging:
    """The excavations of a run that are still to come. taken: how many particles were taken out."""

    def __init__(self, sim: Simulation):
        self._sim, self.taken, self.rests = sim, 0, False  # rests: while bodies settle
        self._marks = marks(sim.scene) if excavations_of(sim.scene) else np.zeros(0, dtype=int)
        self.look()

    def look(self) -> None:
        """Find what is still to come by the particles that are still there."""
        sim = self._sim
        self._coming: list[tuple[int, Excavation]] = []
        if not len(self._marks):
            return
        mark, there = self._marks[sim.particles.id.to_numpy()], sim.particles.volume.to_numpy() != 0.0
        self._coming = [(k, hole) for k, hole in excavations_of(sim.scene) if np.any(there & (mark == k))]
        self._coming.sort(key=lambda entry: entry[1].time)
        coming = {k for k, _ in self._coming}
        self.taken = sum(int(np.sum(self._marks == k)) for k, _ in excavations_of(sim.scene) if k not in coming)

    def steps(self, time: float, dt: float) -> int:
        """Steps of dt from a time [s] until the next is due; at least one, and many where none is."""
        if self.rests or not self._coming:
            return 2**31
        return max(1, math.ceil((self._coming[0][1].time - time) / dt - 1e-6))

    def due(self, time: float, dt: float) -> bool:
        return not self.rests and bool(self._coming) and self._coming[0][1].time <= time + 1e-6 * dt

    def dig(self, time: float) -> Survey:
        """Take out what is due at a time [s]; a survey of what is left.

        The energy that goes with the rock counts as dissipated, as that of rock which leaves the domain.
        """
        sim, (k, hole) = self._sim, self._coming.pop(0)
        first, last = sim.walls.first[k], sim.walls.first[k + 1]
        sim.walls.dt[None] = 0.0  # velocity gradients are of particles in another order afterwards
        before = survey(sim)
        gone = (self._marks[sim.particles.id.to_numpy()] == k) & (sim.particles.volume.to_numpy() != 0.0)
        _take_out(sim, gone.astype(np.int32))
        sort_particles(sim)
        if hole.relaxation > 0.0:
            clear_nodes(sim)
            scatter_all(sim, LOAD, time)
            press(sim, time)
            _support(sim, first, last)
        self.taken += int(gone.sum())
        after = survey(sim)
        sim.ledger.released[0] += before.kinetic + before.elastic - before.work
        sim.ledger.released[0] -= after.kinetic + after.elastic - after.work
        return survey(sim)
