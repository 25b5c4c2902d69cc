"""A slope below Culmann's height by far stands; one above it slides."""

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate


def way(result) -> float:
    """Of the particle that went farthest [m]."""
    return float(np.linalg.norm(result.snapshot.displacement, axis=1).max())


@pytest.mark.thorough
def test_strong_rock_stands_and_weak_rock_slides(coarse, coarse_run):
    """Of 400 kPa Culmann's height is 290 m. Rock that stands settles by less than rho g H^2/E, H from the floor up."""
    strong = simulate(load_scene("slope", **coarse("slope"), cohesion=400e3), threads=1)
    assert len(strong.events) == 0
    assert way(strong) < 2.0 * 2400.0 * 9.81 * 120.0**2 / 500e6
    assert way(coarse_run("slope")) > 5.0
