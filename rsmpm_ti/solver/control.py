"""The servo's eyes and hands: it looks at the energies of a run and sets the pace of the platens."""

import math

from rsmpm_ti.fields.records import NEVER
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.solver.survey import Survey


class Control:
    """Of one run. `pace` is what the servo asks for; steps up to the end of a row go a little slower, to end there.
    `least` is the slowest so far."""

    def __init__(self, sim: Simulation, clock: Clock):
        scene = sim.scene
        self._sim, self._clock, self._servo = sim, clock, scene.servo
        self._transit = scene.loading.height / scene.wave_speed / clock.dt  # [steps]
        self.pace = self.least = 1.0
        self._most_elastic = self._dissipated = 0.0  # [J]

    def chunk(self, loaded: float) -> int:
        """Steps until the next look, at most to where the platens have come as far as at full speed in `loaded` [s]."""
        clock, left = self._clock, loaded - self._clock.loaded
        remaining = max(1, math.ceil(left / (self.pace * clock.dt) - 1e-9))
        steps = self._servo.look_steps(self._transit)
        clock.keep_pace(left / (remaining * clock.dt) if remaining <= steps else self.pace)
        return min(remaining, steps)

    def see(self, survey: Survey, steps: int) -> None:
        """After so many steps."""
        self._most_elastic = max(self._most_elastic, survey.elastic)
        transits, most = steps / self._transit, max(self._most_elastic, 1e-300)
        begun = self._sim.events.onset[None] < NEVER  # what viscosity takes from the start's waves is no activity
        activity = (survey.dissipated - self._dissipated) / transits / most if begun else 0.0
        self.pace = self._servo.next(self.pace, activity, survey.elastic / most, transits)
        self.least, self._dissipated = min(self.least, self.pace), survey.dissipated

    def state(self) -> dict[str, float]:
        energies = {"most_elastic": self._most_elastic, "dissipated": self._dissipated}
        return {"pace": self.pace, "least": self.least} | energies

    def resume(self, state: dict[str, float]) -> None:
        self.pace, self.least = float(state["pace"]), float(state["least"])
        self._most_elastic, self._dissipated = float(state["most_elastic"]), float(state["dissipated"])
