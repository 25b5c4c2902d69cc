"""Particles that leave the domain: taken out of the run, and what went with them.

A dropped particle has no volume and lies at rest and without stress in the middle of the domain, behind all others in
memory (see `sort_particles`), where no pass comes: it adds nothing to nodes and nothing is done to it.
"""

from dataclasses import dataclass, replace

import numpy as np
import taichi as ti

from rsmpm_ti.failure.of_rock import J_at_start
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.fields.stencil import coordinates
from rsmpm_ti.solver.survey import Survey, left_domain, survey


@dataclass(frozen=True, kw_only=True)
class Dropped:
    """What has left so far: particles, mass [kg], momentum [kg m/s], [dim], energy [J]; per metre of thickness in 2D.

    Mass is the rock's own. Momentum and energy, kinetic and elastic, are those of the run, mass scaling included.
    """

    count: int
    mass: float
    momentum: np.ndarray
    energy: float

    def numbers(self) -> dict:
        """The part of summary.json that tells of them."""
        return {
            "dropped": self.count,
            "dropped_mass_kg": self.mass,
            "dropped_momentum_kg_m_s": self.momentum.tolist(),
            "dropped_energy_J": self.energy,
        }


@ti.func
def lay_aside(sim: ti.template(), p, frame):
    """Take a particle out of the run."""
    particles = sim.particles
    particles.volume[p] = 0.0
    particles.J[p] = J_at_start(sim, p)
    for d in ti.static(range(sim.dim)):
        middle = frame[d, 0] + 0.5 * (sim.grid.nodes[d] - 1) * frame[d, 2]
        particles.u[p][d] = middle - particles.reference[p][d]
    for component in ti.static(particles.resting_components):
        component[p] = 0
    for mode in ti.static(particles.modes):
        mode[p] = ti.max(mode[p], 1)  # nothing looks for cracks in it any more


@ti.kernel
def park(sim: ti.template()):
    """Take every particle outside the domain out of the run."""
    for p in sim.particles.key:
        frame = sim.grid.frame()
        if left_domain(sim, coordinates(sim, p, frame)):
            lay_aside(sim, p, frame)


def drop(sim: Simulation, before: Survey, dropped: Dropped) -> tuple[Survey, Dropped]:
    """Take out what `before`, a survey of the particles as they are, found outside; the survey afterwards, and the sum.

    Its energy counts as dissipated, so that kinetic + elastic + dissipated - work goes on as if it had stayed. Where
    nothing is left the sums are whole too.
    """
    volume = sim.particles.volume.to_numpy()
    park(sim)
    gone = (sim.particles.volume.to_numpy() == 0.0) & (volume != 0.0)
    rock = sim.particles.rock.to_numpy() if sim.several else np.zeros(len(volume), dtype=int)
    masses = (
        view.rock.density * view.J_start * float(volume[gone & (rock == view.index)].sum(dtype=np.float64))
        for view in sim.views
    )
    dropped = replace(
        dropped,
        count=dropped.count + int(gone.sum()),
        mass=dropped.mass + sum(masses),
    )
    if sim.particles.volume.to_numpy().any():
        sort_particles(sim)
    after = survey(sim)
    # the confining pressure's work is a sum over particles too
    energy = before.kinetic + before.elastic - before.work - (after.kinetic + after.elastic - after.work)
    sim.ledger.released[0] += energy
    return replace(after, dissipated=after.dissipated + energy), replace(
        dropped, momentum=dropped.momentum + before.momentum - after.momentum, energy=dropped.energy + energy
    )
