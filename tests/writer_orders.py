"""A writer that has been started, for tests that order something of it."""

from dataclasses import replace

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.output.pictures import commission
from rsmpm_ti.output.writer import Writer
from rsmpm_ti.records.snapshot import HISTORY_COLUMNS
from rsmpm_ti.spec.scene import Output

NO_ROWS = np.zeros(0, dtype=[(name, float) for name in HISTORY_COLUMNS])


def started(out) -> Writer:
    scene = replace(load_scene("cube", quick=True), output=Output(frames=1, movie=False))
    (out / "frames").mkdir()
    return Writer(commission(scene, "cube", out, 5e-3))
