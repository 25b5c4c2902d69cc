"""A writer that has been started, for tests that order something of it."""

from dataclasses import replace

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.output.folder import prepare
from rsmpm_ti.output.pictures import commission
from rsmpm_ti.output.writer import Writer
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.spec.scene import Output

NO_ROWS = np.zeros(0, dtype=[(name, float) for name in HISTORY_COLUMNS])


def started(out) -> Writer:
    scene = replace(load_scene("cube", quick=True), output=Output(frames=1, movie=False))
    folder = prepare(scene, out, "cube")
    writer = Writer(commission(scene, "cube", out, scene.particles()), folder)
    folder.begin()
    return writer
