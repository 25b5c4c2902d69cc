"""Runs of several rocks in one scene: laws that differ in kind, files, checkpoints, and what is not shared."""

import json
from dataclasses import replace

import meshio
import numpy as np
import pytest
from PIL import Image
from rock_layers import LAB, layers

from rsmpm_ti import simulate
from rsmpm_ti.errors import ObserverError
from rsmpm_ti.records.progress import Progress
from rsmpm_ti.records.snapshot import INTACT
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.scene import Schedule


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Of a run in which the seam breaks."""
    out = tmp_path_factory.mktemp("layers") / "run"
    simulate(layers(), out=out, threads=1)
    return out


def summary_of(folder) -> dict:
    return json.loads((folder / "summary.json").read_text())


def test_the_seam_breaks_and_it_alone(folder):
    data = meshio.read(folder / "particles_0002.vtu").point_data
    assert [int(np.count_nonzero(data["rock"] == k)) for k in range(3)] == [480, 288, 384]
    failed = data["failure_mode"] != INTACT
    assert failed.any() and (data["rock"][failed] == 1).all()
    assert np.isnan(data["margin"][data["rock"] == 2]).all() and np.isfinite(data["margin"][data["rock"] != 2]).all()
    assert np.isnan(data["aperture_m"][data["rock"] == 1]).all() and (data["aperture_m"][data["rock"] == 0] == 0).all()


def test_energy_closes(folder):
    summary = summary_of(folder)
    assert summary["energy_balance_error_elastic"] < 1e-3
    # first order in the step where rock collapses into a fluid at once: 1.1 % with the seam's rock alone
    assert summary["energy_balance_error"] < 0.02


def test_failures_are_counted_by_rock(folder):
    summary = summary_of(folder)
    rocks = summary["by_rock"]
    assert [entry["rock"] for entry in rocks] == ["rock", "bodies[1].rock", "bodies[2].rock"]
    assert [entry["particles"] for entry in rocks] == [480, 288, 384]
    for name in ("failed_tension", "failed_shear"):
        assert [entry[name] for entry in rocks] == [0, summary[name], 0]


def test_pictures_of_cracks_show_where_rocks_meet(folder):
    """A line of its own grey, twice across the specimen."""
    image = np.asarray(Image.open(folder / "frames" / "cracks_0000.png").convert("RGB"))
    rows = np.flatnonzero((image == (0x70, 0x70, 0x68)).all(axis=2).sum(axis=1) > 100)
    assert len(rows) == 2


@pytest.mark.thorough
def test_a_run_that_was_stopped_goes_on_to_the_same_end(folder, tmp_path):
    def stop(progress: Progress) -> None:
        if progress.fraction > 0.6:
            raise RuntimeError

    with pytest.raises(ObserverError):
        simulate(layers(), out=tmp_path / "run", threads=1, checkpoint_every=0.0, progress=stop)
    simulate(layers(), out=tmp_path / "run", threads=1, resume=True)
    for name in ("history.csv", "events.csv", "particles_0002.vtu"):
        assert (tmp_path / "run" / name).read_bytes() == (folder / name).read_bytes(), name


@pytest.mark.thorough
def test_the_same_rock_given_to_a_body_changes_no_bit():
    one = layers(rocks=(None, None, None), start=Affine())
    given = layers(rocks=(None, replace(LAB), LAB), start=Affine())
    first, second = (simulate(scene, threads=1) for scene in (one, given))
    assert np.array_equal(first.snapshot.sigma, second.snapshot.sigma) and second.snapshot.rock is None
    assert first.history.tobytes() == second.history.tobytes() and "by_rock" not in second.summary


@pytest.mark.thorough
def test_rocks_that_differ_in_nothing_that_acts_run_alike():
    """Code for several rocks, and numbers of one: rock whose strength is never reached is as good as unbreakable."""
    whole = replace(LAB, criterion=Unbreakable())
    one = layers(rocks=(None, None, None))
    two = layers(rocks=(None, whole, None))
    short = Schedule(strain_end=1e-4, rows=20)
    first, second = (simulate(replace(scene, schedule=short), threads=1).snapshot for scene in (one, two))
    assert second.rock is not None
    largest = np.abs(first.sigma).max()
    assert np.abs(first.sigma - second.sigma).max() < 1e-9 * largest, "the same sums, whose order may differ"
