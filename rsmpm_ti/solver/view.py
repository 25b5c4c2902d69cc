"""One look at a run between two steps: what history columns are made of and what observers see."""

import math
from functools import cached_property
from pathlib import Path

import numpy as np

from rsmpm_ti.fields.records import NEVER
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import Pattern, Snapshot
from rsmpm_ti.solver.readout import Readout, read_events, read_out, read_pattern
from rsmpm_ti.solver.survey import Survey
from rsmpm_ti.spec.load_cell import Load
from rsmpm_ti.spec.scene import Scene


class View:
    """What there is to see of a run now. Particles are copied out when they are first asked for, once per look.

    time [s], strain (of the platens, compression positive), step, dt [s], fraction (of the run that is done, 0 to 1),
    survey (sums and extremes over particles), out (the run's folder, None where nothing is written), scene.
    """

    def __init__(self, sim: Simulation, clock: Clock, survey: Survey, history, out: Path | None = None):
        self.sim, self.survey, self.out, self._history, self._clock = sim, survey, out, history, clock
        self.time, self.strain, self.step, self.dt, self.fraction = (
            clock.time, clock.strain, clock.step, clock.dt, clock.fraction
        )  # fmt: skip

    @property
    def true_time(self) -> float:
        """Time without mass scaling [s]: that of waves and running cracks; see docs/conventions.md."""
        return self.time / self.scene.time_scale

    @cached_property
    def lateral_strains(self) -> tuple[float, ...]:
        """Across the load, one for each axis, compression positive; NaN where nothing is measured."""
        return self._history.extensometer.read()

    @property
    def lateral_strain(self) -> float:
        """The mean of them [1]."""
        return float(np.mean(self.lateral_strains))

    @property
    def volumetric_strain(self) -> float:
        """Axial and lateral strains, added [1], compression positive; NaN in plane stress, where one is not known."""
        return math.nan if self.scene.rock.elasticity.plane_stress else self.strain + sum(self.lateral_strains)

    @property
    def scene(self) -> Scene:
        return self.sim.scene

    @property
    def load(self) -> Load:
        """What the load cell reads, as a mean over the steps of the latest history row; NaN before the first."""
        return self._history.load

    @property
    def history(self) -> np.ndarray:
        """Rows so far, this look's included once it has been recorded; a structured array."""
        return self._history.table()

    @cached_property
    def readout(self) -> Readout:
        """Raises RuntimeError once the run has gone on: a view that was kept knows no particles any more."""
        if self._clock.step != self.step:
            raise RuntimeError(f"this view is of step {self.step}, and the run has gone on: take the snapshot in see()")
        return read_out(self.sim, self.time)

    @cached_property
    def snapshot(self) -> Snapshot:
        """All particles, as NumPy arrays in the order of their ids."""
        return self.readout.snapshot()

    @cached_property
    def pattern(self) -> Pattern:
        """What of the snapshot a picture of cracks needs; much cheaper."""
        return read_pattern(self.sim, self.time)

    @property
    def begun(self) -> bool:
        """Whether a particle has begun to lose strength."""
        return self.survey.failed_tension + self.survey.failed_shear > 0 or self.sim.events.onset[None] < NEVER

    @cached_property
    def events(self) -> EventTable:
        """Failures so far."""
        return read_events(self.sim)
