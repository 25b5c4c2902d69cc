"""The failure events of a run."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class EventTable:
    """Failure events in the order of time. Shapes [e], x [e, dim]; SI; mode 1 tension, 2 shear.

    normal: unit vector across the particle's crack, [e, dim]; None for rock whose cracks have no direction.
    """

    time: np.ndarray
    x: np.ndarray
    mode: np.ndarray
    sigma_1: np.ndarray
    sigma_3: np.ndarray
    released: np.ndarray
    id: np.ndarray
    normal: np.ndarray | None = None
    onset: float = np.inf
    """When a particle of rock with a direction first began to lose strength [s]: not after the first event."""

    @property
    def crack_angle(self) -> np.ndarray | None:
        """Of the normal, from +x in the x-y plane [rad], in (-pi, pi]."""
        if self.normal is None:
            return None
        return np.arctan2(self.normal[:, 1].astype(float), self.normal[:, 0].astype(float))

    def __len__(self) -> int:
        return len(self.time)
