"""Mass scaling by k is the true rock loaded k times faster, seen in slow motion: what scales, and how.

With density k^2 rho and time t = k t' the equations of motion of both are the same, step for step
(docs/conventions.md): so the two runs differ by round-off, and by nothing else.
"""

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate

pytestmark = pytest.mark.thorough

K = 8.0
COARSE = {"dx": 2e-3, "flaw_width": 6e-3, "time_scale": K, "schedule.rows": 60}


@pytest.fixture(scope="module")
def pair():
    """The scaled run, and the true rock with platens K times as fast."""
    fast = {f"loading.boundaries.{k}.speed": sign * K * 2.5e-3 for k, sign in enumerate((1.0, -1.0))}
    settings = (COARSE, COARSE | fast | {"time_scale": 1.0})
    return [simulate(load_scene("cube", settings=one), threads=1) for one in settings]


def test_stress_strain_and_energies_are_those_of_the_true_rock(pair):
    scaled, true = (result.history for result in pair)
    for name in ("axial_strain", "lateral_strain", "stress_top_Pa", "energy_kinetic_J", "energy_elastic_J", "work_J"):
        np.testing.assert_allclose(scaled[name], true[name], rtol=1e-6, atol=1e-6 * np.abs(true[name]).max())


def test_true_times_and_speeds_are_those_of_the_true_rock(pair):
    scaled, true = pair
    np.testing.assert_allclose(scaled.history["true_time_s"], true.history["time_s"], rtol=1e-9)
    assert len(scaled.events) == len(true.events) > 50
    np.testing.assert_allclose(scaled.events.true_time, true.events.time, rtol=1e-9)
    assert scaled.summary["first_failure_true_time_s"] == pytest.approx(true.summary["first_failure_time_s"], rel=1e-9)
    fastest = [max(crack.speed_at.max() for crack in result.fracture.cracks) for result in pair]
    assert K * fastest[0] == pytest.approx(fastest[1], rel=1e-6)
    speed = [np.linalg.norm(result.snapshot.velocity, axis=1).max() for result in pair]
    assert K * speed[0] == pytest.approx(speed[1], rel=1e-4)


def test_kinetic_energy_at_the_true_density_is_that_of_the_platens_own_speed():
    """Of uniform straining: rho/2 times the mean square of the affine velocities, whatever the mass scaling."""
    scene = load_scene("intact", dx=1e-3, strain_end=1e-4, time_scale=K)
    history = simulate(scene, threads=1).history
    area, rate, ratio = 50e-3 * 100e-3, 0.05, 0.14 / 0.86
    affine = 0.5 * 2600.0 * area * rate**2 * ((100e-3) ** 2 + (ratio * 50e-3) ** 2) / 12.0
    # columns of 200 and rows of 100 particles sample the squares of straight lines to 1e-4
    assert history["energy_kinetic_true_density_J"][-1] == pytest.approx(affine, rel=1e-3)
