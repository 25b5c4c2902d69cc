"""A probe of the history: a column of a user's own, in this file alone."""

import csv

import numpy as np
import pytest

from rsmpm_ti import Column, load_scene, simulate

MAX_TRAVEL = Column(name="fastest_m_s", unit="m/s", about="fastest particle", value=lambda view: view.survey.speed)
MEAN = Column(
    name="mean_stress_Pa", unit="Pa", about="axial stress, mean over particles", value=lambda view: axial(view.snapshot)
)


def axial(snapshot) -> float:
    return -float(np.average(snapshot.sigma[:, 1, 1], weights=snapshot.volume))


def test_columns_of_ones_own_land_in_file_result_and_checkpoint(tmp_path):
    quick = {"shape": "Linear", "schedule.rows": "40", "output.frames": "0"}  # Linear compiles fastest
    scene = load_scene("intact", dx=5e-3, strain_end=2e-4, settings=quick).elastic()
    result = simulate(scene, out=tmp_path, threads=1, columns=(MAX_TRAVEL, MEAN))
    history = result.history
    # in uniform straining the mean over the body is the platens' stress, but that theirs is a mean over the row
    middle = 0.5 * (history["mean_stress_Pa"][1:] + history["mean_stress_Pa"][:-1])
    np.testing.assert_allclose(middle, history["stress_top_Pa"][1:], atol=0.02 * history["stress_top_Pa"].max())
    assert (history["fastest_m_s"] > 0.0).all()
    with open(tmp_path / "history.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["fastest_m_s"]) for row in rows] == pytest.approx(history["fastest_m_s"], rel=1e-9)
    with np.load(tmp_path / "checkpoint.npz") as kept:
        assert np.array_equal(kept["history"][:, -1], history["mean_stress_Pa"])
