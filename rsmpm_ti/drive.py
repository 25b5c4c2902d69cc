"""A scene in motion: steps in chunks that are safe for the slabs, with a look at the particles after each."""

import math

from rsmpm_ti.measure import survey
from rsmpm_ti.observe import guard
from rsmpm_ti.sorting import first_rows, sort_particles
from rsmpm_ti.spec import Scene
from rsmpm_ti.state import Simulation
from rsmpm_ti.stepper import Clock

STRAY_SHARE = 0.02
"""Share of particles outside the cell they were sorted into above which they are sorted again."""

SAFE_CELLS = 0.4
"""Between two looks at the particles none may move further than this many cells, or slabs could meet."""


class Drive:
    """Particles, clock and the latest survey of one scene. Taichi must have been started."""

    def __init__(self, scene: Scene, seeds, real, gpu: bool = False, deterministic: bool = False):
        """seeds: `scene.particles()`; real: ti.f64 or ti.f32; deterministic: same bits with any number of threads."""
        self.sim = Simulation(scene, seeds, real, gpu, deterministic)
        sort_particles(self.sim)
        self.clock = Clock(self.sim)
        self.survey = survey(self.sim)

    def look(self) -> None:
        """Look at particles whose state, with the cells of their last sort, was put in from outside."""
        self.sim.traversal.refresh(first_rows(self.sim))
        self.sim.nodes.forget_empty()
        self.survey = survey(self.sim)

    def advance(self, steps: int) -> None:
        """Take steps, fewer if the scene ends before. Raises UnstableRun when a particle is no longer rock."""
        remaining = min(steps, self.clock.total - self.clock.step)
        while remaining > 0:
            travel = max(self.survey.speed * self.clock.dt, 1e-30)
            chunk = min(remaining, max(1, math.floor(SAFE_CELLS * self.sim.grid.dx / travel)))
            self.clock.advance(chunk)
            remaining -= chunk
            self.survey = survey(self.sim)
            guard(self.sim, self.clock, self.survey)
            # slabs bear a stray of one row: half a cell beyond it and SAFE_CELLS more is still less than that
            if self.survey.far_strays or self.survey.strays > STRAY_SHARE * self.sim.particles.count:
                sort_particles(self.sim)
