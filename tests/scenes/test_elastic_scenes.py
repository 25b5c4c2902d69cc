"""Every scene that ships runs without failure too, as `--elastic` asks, and paints what there is."""

from dataclasses import replace

import numpy as np
import pytest
from scenes.conftest import COARSE

from rsmpm_ti import load_scene, simulate

STEPS = 40


@pytest.mark.parametrize("name", COARSE)
@pytest.mark.thorough(*(name for name in COARSE if name != "intact_weibull"))
def test_it_runs_without_failure(coarse, name, tmp_path):
    scene = load_scene(name, **coarse(name)).elastic()
    schedule = replace(scene.schedule, strain_end=None, t_end=STEPS * scene.dt, stop_after_drop=None)
    output = replace(scene.output, frames=1, vtu=1, movie=False, margin=True)
    result = simulate(replace(scene, schedule=schedule, output=output), out=tmp_path / "out", threads=1)
    assert result.stopped == "" and len(result.events) == 0
    assert np.isfinite(result.snapshot.sigma_1).all()
