"""The clock of a run: steps, time, platen strain."""

import math

from rsmpm_ti.failure.crack_tracking import track_cracks
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.stepper import ORDERS


class Clock:
    """Counts steps of one run: time [s], platen strain (compression positive), platen speed over the full one.

    `total` is how many steps the run takes: with steps that adapt or a servo, if nothing changes any more.
    `pace`: fraction of their speed at which a servo lets the platens go; `loaded`: the time [s] in which they would
    have gone as far at full speed, by which the start, rows and the end are counted.
    """

    def __init__(self, sim: Simulation):
        scene = sim.scene
        self._sim, self._pass_list = sim, ORDERS[scene.order]
        self.dt, self.total = scene.dt, scene.steps
        self.end = scene.t_end if scene.schedule.adaptive else self.total * self.dt  # [s]
        self.factor, self.tracks = scene.loading.start.factor, True  # tracks: whether it looks for cracks
        self.step, self.pace, self._loaded, self.servo = 0, 1.0, 0.0, scene.servo
        self._since = 0, 0.0  # step and time at which steps of this length began

    @property
    def time(self) -> float:
        return self._time_of(self.step)

    @property
    def loaded(self) -> float:
        return self.time if self.servo is None else self._loaded

    def _time_of(self, step: float) -> float:
        first, start = self._since
        return start + (step - first) * self.dt

    @property
    def strain(self) -> float:
        """How far the ends of the load have come closer, over their distance; NaN where no two face each other."""
        pair = self._sim.scene.loading.ends
        if pair is None:
            return math.nan
        lower, upper = self._sim.grid.gone()[pair[0].axis]
        return float(lower - upper) / self._sim.scene.loading.height

    @property
    def fraction(self) -> float:
        """Of the run that is done, 0 to 1."""
        return min(1.0, self.loaded / self.end)

    def state(self) -> dict[str, float]:
        """What `resume` needs to go on where this clock is."""
        first, since = self._since
        state = {"step": self.step, "total": self.total, "first": first}
        return state | {"dt": self.dt, "since": since, "pace": self.pace, "loaded": self._loaded}

    def resume(self, state: dict[str, float]) -> None:
        self.step, self.dt = int(state["step"]), float(state["dt"])
        self.total, self._since = int(state["total"]), (int(state["first"]), float(state["since"]))
        self.pace, self._loaded = float(state["pace"]), float(state["loaded"])

    @property
    def done(self) -> bool:
        return self.step >= self.total

    def retime(self, dt: float) -> None:
        """Steps of dt [s] from here on."""
        self._since, self.dt = (self.step, self.time), dt
        self.total = self.step + math.ceil((self.end - self.time) / dt - 1e-6)

    def keep_pace(self, pace: float) -> None:
        """The platens go at this fraction of their speed from here on."""
        self.pace = pace
        self.total = self.step + math.ceil((self.end - self._loaded) / (pace * self.dt) - 1e-6)

    def advance(self, steps: int) -> None:
        """Take steps, fewer if the run ends before; with a nonlocal mean, a look for cracks every `interval` steps."""
        last = min(self.step + steps, self.total)
        while self.step < last:
            chunk = last - self.step
            if self._sim.is_nonlocal:  # a look comes after steps 1, 1 + interval, 1 + 2 interval ...
                interval = self._sim.look_interval
                chunk = min(chunk, (-self.step) % interval + 1)
            factors = self._factors(chunk)
            self._pass_list(self._sim, self.dt, self.time, factors)
            self.step += chunk
            self._loaded += chunk * self.pace * self.dt
            if self._sim.is_nonlocal and self.tracks and (self.step - 1) % self._sim.look_interval == 0:
                track_cracks(self._sim, self.time)

    def _factors(self, steps: int) -> list[float]:
        """Of the platens' speed, or force, in the middle of each of so many steps."""
        if self.servo is None:
            return [self.factor(self._time_of(self.step + k + 0.5)) for k in range(steps)]
        return [self.pace * self.factor(self._loaded + (k + 0.5) * self.pace * self.dt) for k in range(steps)]
