"""Drawings are run as any specimen is: by `simulate`, by the command, and again from the record of a run."""

import json
from dataclasses import replace

import numpy as np
import pytest
from drawn import PLATE, SECTION, scene

from rsmpm_ti import Affine, Difference, Linear, Loading, Mask, Mesh, Output, Platen, Polygon, Segments, simulate
from rsmpm_ti.scene import main

WEDGE = Polygon(points=((0.0, 0.0), (0.04, 0.0), (0.03, 0.08), (0.01, 0.08)))
SECTION_OF_ROCK = Mask(image=SECTION, mm_per_pixel=1.0, greys=(0, 150), origin=(-0.005, -0.005))
FLAWS = Segments(traces=((0.010, 0.020, 0.020, 0.026), (0.022, 0.050, 0.034, 0.058)), width=6e-3)


def pressed(region):
    """A specimen of 40 x 80 mm, its foot on y = 0, between platens, for a few steps."""
    drawn = scene(region, dx=2e-3)
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=0.01),
        Platen(axis=1, side="upper", position=0.08, speed=-0.01),
    )
    return replace(
        drawn,
        loading=Loading(boundaries=platens, start=Affine(), width=0.04, time_scale=4.0),
        schedule=replace(drawn.schedule, t_end=2e-5, rows=5),
        shape=Linear(),
        output=Output(frames=1, movie=False, vtu=0),
    )


@pytest.mark.parametrize(
    "region",
    [WEDGE, SECTION_OF_ROCK, Mesh(file=PLATE), Difference(whole=Mesh(file=PLATE), removed=(FLAWS,))],
    ids=["polygon", "thin section", "gmsh", "flaws"],
)
@pytest.mark.thorough("flaws", "gmsh", "polygon")
def test_drawing_is_pressed_between_platens(region):
    made = pressed(region)
    result = simulate(made, threads=1)
    assert result.stopped == "" and len(result.snapshot.x) == len(made.particles()[0].x)
    stress = result.history["stress_bottom_Pa"]
    assert np.isfinite(stress).all() and stress[-1] > 0.0


def test_command_checks_a_drawing_and_runs_its_record_again(tmp_path, monkeypatch, capsys):
    out = tmp_path / "run"
    first = simulate(pressed(SECTION_OF_ROCK), out=out, threads=1)
    record = json.loads((out / "scene.json").read_text())["scene"]
    assert len(record["bodies"][0]["region"]["sha256"]) == 64
    monkeypatch.chdir(tmp_path)
    assert main([str(out / "scene.json"), "--check"]) == 0
    assert str(len(first.snapshot.x)) in capsys.readouterr().out
    assert main([str(out / "scene.json"), "--out", "again", "--threads", "1"]) == 0
    assert (tmp_path / "again" / "history.csv").read_bytes() == (out / "history.csv").read_bytes()
