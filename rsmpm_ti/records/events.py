"""The failure events of a run."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class EventTable:
    """Failure events in the order of time. Shapes [e], x [e, dim]; SI; mode 1 tension, 2 shear.

    crack_angle: of the normal of the particle's crack, from +x [rad]; None for rock without a direction.
    """

    time: np.ndarray
    x: np.ndarray
    mode: np.ndarray
    sigma_1: np.ndarray
    sigma_3: np.ndarray
    released: np.ndarray
    id: np.ndarray
    crack_angle: np.ndarray | None = None
    onset: float = np.inf
    """When a particle of rock with a direction first began to lose strength [s]: not after the first event."""

    def __len__(self) -> int:
        return len(self.time)
