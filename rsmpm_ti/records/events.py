"""The failure events of a run."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti.records.rows import data_frame
from rsmpm_ti.records.snapshot import MODE_NAMES
from rsmpm_ti.records.tables import Column, Table


@dataclass(frozen=True)
class EventTable:
    """Failure events in the order of time. Shapes [e], x [e, dim]; SI; mode 1 tension, 2 shear.

    normal: unit vector across the particle's crack, [e, dim]; None for rock whose cracks have no direction.
    time_scale: of the run's mass scaling.
    """

    time: np.ndarray
    x: np.ndarray
    mode: np.ndarray
    sigma_1: np.ndarray
    sigma_3: np.ndarray
    released: np.ndarray
    id: np.ndarray
    normal: np.ndarray | None = None
    time_scale: float = 1.0
    onset: float = np.inf
    """When a particle of rock with a direction first began to lose strength [s]: not after the first event."""

    @property
    def crack_angle(self) -> np.ndarray | None:
        """Of the normal, from +x in the x-y plane [rad], in (-pi, pi]."""
        if self.normal is None:
            return None
        return np.arctan2(self.normal[:, 1].astype(float), self.normal[:, 0].astype(float))

    @property
    def true_time(self) -> np.ndarray:
        """Times in the rock of true density, loaded so many times faster [s]; see docs/conventions.md."""
        return self.time / self.time_scale

    def until(self, time: float) -> "EventTable":
        """The events up to a time [s], that time included."""
        n = int(np.searchsorted(self.time, time, side="right"))
        columns = ("time", "x", "mode", "sigma_1", "sigma_3", "released", "id")
        cut = {name: getattr(self, name)[:n] for name in columns}
        return replace(self, **cut, normal=None if self.normal is None else self.normal[:n])

    def to_frame(self):
        """A pandas.DataFrame with the columns of events.csv. Raises SceneError where pandas is not installed."""
        return data_frame(EVENTS.filled(self, self.x.shape[1]))

    def __len__(self) -> int:
        return len(self.time)


EVENTS = Table(
    file="events.csv",
    about="Failures of particles in the order of time; of rock that softens, when half of the strength is lost.",
    columns=(
        Column(name="time_s", unit="s", about="when it failed", value=lambda events: events.time),
        Column(
            name="true_time_s", unit="s", about="the same without mass scaling: time_s / time_scale",
            value=lambda events: events.true_time,
        ),
        Column(name="{axis}_m", unit="m", about="where the particle was", value=lambda events: events.x),
        Column(
            name="mode", unit="", about="tension or shear", value=lambda events: [MODE_NAMES[m] for m in events.mode]
        ),
        Column(
            name="sigma_1_Pa", unit="Pa", about="largest (most tensile) principal stress then, tension positive",
            value=lambda events: events.sigma_1,
        ),
        Column(
            name="sigma_3_Pa", unit="Pa", about="smallest principal stress then", value=lambda events: events.sigma_3
        ),
        Column(
            name="released_energy_J", unit="J", about="elastic energy that the failure set free; per metre in 2D",
            value=lambda events: events.released,
        ),
        Column(
            name="crack_normal_deg", unit="degree", about="angle of the crack's normal from +x, counter-clockwise",
            value=lambda events: np.degrees(events.crack_angle),
            only="rock whose cracks have a direction", wanted=lambda events: events.crack_angle is not None,
        ),
    ),
)  # fmt: skip
