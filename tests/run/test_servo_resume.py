"""A run with a servo that is stopped while rock breaks goes on as if it had not been, and not from where it was not."""

import os
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import SceneError, Servo, load_scene, simulate

COARSE = {"dx": 2e-3, "flaw_width": 6e-3, "length": 4e-3}


@pytest.mark.thorough
def test_run_with_a_servo_goes_on_to_the_last_bit(tmp_path):
    scene = load_scene("cube_lab", **COARSE)
    loading = replace(scene.loading, servo=Servo(slowest=0.3), local_damping=0.3)
    scene = replace(scene, loading=loading, output=replace(scene.output, frames=0, movie=False, vtu=0))

    def stop(progress) -> None:
        if progress.fraction > 0.97:
            os.kill(os.getpid(), 2)

    whole = simulate(scene, threads=1)
    first = simulate(scene, out=tmp_path / "run", threads=1, progress=stop)
    assert first.signal == 2 and 0.3 <= first.summary["least_pace"] < 1.0
    second = simulate(scene, out=tmp_path / "run", threads=1, resume=True)
    assert len(second.history) == len(whole.history) > len(first.history)
    for name in whole.history.dtype.names:
        np.testing.assert_array_equal(second.history[name], whole.history[name], err_msg=name)
    for name in ("least_pace", "local_damping_J", "steps"):
        assert second.summary[name] == whole.summary[name]
    earlier = replace(scene, schedule=replace(scene.schedule, strain_end=5e-4))
    with pytest.raises(SceneError, match="s of platens at full speed, to where the checkpoint has come"):
        simulate(earlier, out=tmp_path / "run", threads=1, resume=True)
