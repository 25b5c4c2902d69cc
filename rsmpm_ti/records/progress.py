"""What a progress bar shows while a run goes on."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Progress:
    """What a progress bar shows."""

    fraction: float
    time: float
    strain: float
    stress: float
    failed_tension: int
    failed_shear: int
    particle_steps_per_s: float
