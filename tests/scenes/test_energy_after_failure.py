"""Rock that has broken gives no energy back, through the command a user types, to the end of each scene."""

import csv

import numpy as np
import pytest

from rsmpm_ti.scene import main

SCENES = ("cube_lab", "two_flaws", "intact_weibull", "confined", "disc_lab", "cube", "disc", "intact")
WHERE = {"disc": "loading.time_scale", "disc_lab": "loading.time_scale"}


@pytest.mark.validation
@pytest.mark.parametrize("time_scale", [16, 8, 4, 2])
@pytest.mark.parametrize("scene", SCENES)
def test_dissipated_energy_never_falls_and_the_balance_closes(tmp_path, scene, time_scale):
    """Within 1e-4 of the largest work, and 0.5 % of it: what a step of half its load errs, summed."""
    asked = [scene, "--quick", "--set", f"{WHERE.get(scene, 'time_scale')}={time_scale}", "--frames", "1", "--no-movie"]
    assert main([*asked, "--set", "output.vtu=0", "--out", str(tmp_path / "out")]) == 0
    with open(tmp_path / "out" / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    kinetic, elastic, lost, work = (
        np.array([float(row[name]) for row in rows])
        for name in ("energy_kinetic_J", "energy_elastic_J", "energy_dissipated_J", "work_J")
    )
    assert (np.maximum.accumulate(lost) - lost).max() < 1e-4 * work.max()
    missing = work - kinetic - elastic - lost
    missing -= missing[0]  # what the confining pressure has stored before the test begins
    assert np.abs(missing).max() < 5e-3 * work.max()
