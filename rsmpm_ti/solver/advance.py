"""A scene in motion: steps in chunks that are safe for the slabs, with a look at the particles after each."""

import math

import numpy as np

from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.fields.cell_order import first_rows, sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.time_step import adapted
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.mpm.nodes import clear_nodes
from rsmpm_ti.mpm.stepper import LOAD, scatter_all
from rsmpm_ti.solver.control import Control
from rsmpm_ti.solver.guard import guard
from rsmpm_ti.solver.holes.digging import Digging
from rsmpm_ti.solver.outflow import Dropped, drop
from rsmpm_ti.solver.survey import survey
from rsmpm_ti.spec.scene import Scene

STRAY_FRACTION = 0.02
"""Fraction of particles outside the cell they were sorted into above which they are sorted again."""

SAFE_CELLS = 0.4
"""Between two looks at the particles none may move further than this many cells, or slabs could meet."""


class Drive:
    """Particles, clock and the latest survey of one scene. Taichi must have been started."""

    def __init__(self, scene: Scene, seeds, real, gpu: bool = False, deterministic: bool = False):
        """seeds: `scene.particles()`; real: ti.f64 or ti.f32; deterministic: same bits with any number of threads."""
        self.sim = Simulation(scene, seeds, real, gpu, deterministic)
        sort_particles(self.sim)
        if self.sim.contacts.planes:
            clear_nodes(self.sim)
            scatter_all(self.sim, LOAD, 0.0)
            self.sim.contacts.sit()
        self.clock = Clock(self.sim)
        self.control = None if scene.servo is None else Control(self.sim, self.clock)
        self.survey = survey(self.sim)
        self.digging = Digging(self.sim)
        self.dropped = Dropped(count=0, mass=0.0, momentum=np.zeros(scene.dim), energy=0.0)

    def look(self) -> None:
        """Look at particles whose state, with the cells of their last sort, was put in from outside."""
        self.sim.traversal.refresh(first_rows(self.sim))
        self.sim.nodes.forget_empty()
        self.survey = survey(self.sim)
        self.digging.look()

    def advance(self, steps: int) -> None:
        """Take steps, fewer if the scene ends before; if they adapt, as many as the time of so many scene.dt needs.

        Raises UnstableRun when a particle is no longer rock.
        """
        if self.sim.scene.schedule.adaptive:
            self._advance_to(min(self.clock.time + steps * self.sim.scene.dt, self.clock.end))
            return
        if self.control is not None:
            self._load_until(min(self.clock.loaded + steps * self.sim.scene.dt, self.clock.end))
            return
        remaining = min(steps, self.clock.total - self.clock.step)
        while remaining > 0:
            remaining -= self.take(remaining)

    def _advance_to(self, time: float) -> None:
        """Equal steps to a time [s], as many as the latest look asks for, and after each look again."""
        scene, clock = self.sim.scene, self.clock
        remaining = 1
        while remaining > 0:
            limit = adapted(scene.dt, scene.wave_speed, self.survey.J_intact, self.survey.speed)
            remaining = math.ceil((time - clock.time) / limit - 1e-9)
            if remaining > 0:
                clock.retime((time - clock.time) / remaining)
                remaining -= self.take(remaining)

    def _load_until(self, loaded: float) -> None:
        """Steps until the platens have come as far as in that time [s] at full speed, at the pace of the servo."""
        while self.clock.loaded < loaded * (1.0 - 1e-12):
            taken = self.take(self.control.chunk(loaded))
            self.control.see(self.survey, taken)

    def take(self, most: int) -> int:
        """Take steps, at most so many, look at the particles, and sort them if they need it; how many were taken."""
        while self.digging.due(self.clock.time, self.clock.dt):
            self.survey = self.digging.dig(self.clock.time)
        # particles against nodes, which go at most as fast as the platens
        speed, way = max(self.survey.speed + self.sim.grid.fastest, 1e-30), SAFE_CELLS * self.sim.grid.dx
        # way = speed t + quickest t^2/2, solved so that no difference of near numbers is taken
        time = 2.0 * way / (speed + math.sqrt(speed**2 + 2.0 * self.sim.grid.quickest * way))
        chunk = min(most, max(1, math.floor(time / self.clock.dt)), self.digging.steps(self.clock.time, self.clock.dt))
        self.clock.advance(chunk)
        self.survey = survey(self.sim)
        if self.survey.outside and not self.survey.sick:
            self.survey, self.dropped = drop(self.sim, self.survey, self.dropped)
            if self.dropped.count + self.digging.taken >= self.sim.particles.count:
                raise UnstableRun("every particle has left the domain; enlarge it, or end the run earlier")
        guard(self.sim, self.clock, self.survey)
        # slabs bear a stray of one row: half a cell beyond it and SAFE_CELLS more is still less than that
        if self.survey.far_strays or self.survey.strays > STRAY_FRACTION * self.sim.particles.count:
            sort_particles(self.sim)
        return chunk
