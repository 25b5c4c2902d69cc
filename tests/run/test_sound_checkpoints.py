"""Every kind of scene has the checkpoints that are expected of it: else none could go on."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import taichi as ti
from small_scene import SHIPPED

from rsmpm_ti import Apic, load_scene
from rsmpm_ti.run.checkpoint import read, take
from rsmpm_ti.run.kept.contents import Contents
from rsmpm_ti.run.kept.layout import check_layout
from rsmpm_ti.run.kept.reading import Header
from rsmpm_ti.run.run import simulate
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.history import History

COARSE = {"dx": 5e-3, "flaw_width": 15e-3}


SCENES = {
    "paper": lambda: load_scene("cube", **COARSE),
    "elastic, affine": lambda: replace(load_scene("cube", **COARSE).elastic(), transfer=Apic()),
    "lab": lambda: load_scene("cube_lab", dx=2.5e-3, flaw_width=7.5e-3, length=5e-3),
    "uneven": lambda: load_scene("intact_weibull", dx=1e-3, length=2e-3),
    "3D": lambda: load_scene(str(Path(__file__).parents[1] / "block_3d.py"), dx=5e-3),
}


@pytest.mark.parametrize(
    "taichi_real, name", [*(("f64", n) for n in SCENES), ("f32", "paper"), ("f32", "lab")], indirect=["taichi_real"]
)
@pytest.mark.thorough("f64-3D", "f64-lab", "f64-uneven")
def test_arrays_of_a_run_are_those_that_are_expected(taichi_real, name):
    """In both precisions."""
    scene = SCENES[name]()
    settings, seeds = Settings(precision="f64" if taichi_real == ti.f64 else "f32"), scene.particles()
    drive = Drive(scene, seeds, taichi_real)
    history = History(drive.sim, drive.clock, drive.survey)
    history.record(drive.survey)
    arrays = take(drive, history, {}, {})
    del arrays["text"]
    headers = {name: Header(values.dtype, values.shape, False) for name, values in arrays.items()}
    check_layout(headers, scene, drive.sim.particles.count, settings)
    Contents(arrays, scene, seeds).check()


@pytest.mark.validation
@pytest.mark.parametrize("name", SHIPPED)
@pytest.mark.parametrize("precision", ["f64", "f32"])
def test_every_scene_goes_on_from_where_it_was_stopped(name, precision, tmp_path):
    scene = load_scene(name, quick=True)

    def stop(progress) -> None:
        if progress.fraction > 0.03:
            os.kill(os.getpid(), 2)

    assert simulate(scene, out=tmp_path, precision=precision, progress=stop).signal == 2
    kept = read(tmp_path, scene, scene.particles(), Settings(precision=precision))
    assert kept is not None and np.isfinite(kept["clock_dt"])
