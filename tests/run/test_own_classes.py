"""A scene with classes of its own, whatever they hold, runs to its end by the command, and its record says so."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from rsmpm_ti.scene import main

ROOT = Path(__file__).resolve().parents[2]

SCENE = '''
"""Mine."""
from dataclasses import replace

import numpy as np
import taichi as ti

from rsmpm_ti import load_scene


class Lens:
    def __init__(self):
        self.centre, self.radii, self.rule = np.array([0.025, 0.05]), {0.01, 0.02}, lambda x: x
        self.me, self.phase, self.table = self, 1j, np.arange(20_000.0)

    def contains(self, x):
        return np.hypot(*(x - self.centre).T) < max(self.radii)

    def bounds(self):
        return self.centre - 0.02, self.centre + 0.02


@ti.data_oriented
class Pull:
    def __init__(self):
        self.b, self.kinds = np.float32(2.0), {"weight": b"w"}

    @ti.func
    def acceleration(self, X, t):
        return self.b * t * ti.Vector([1.0, 0.0])


def scene():
    made = load_scene("intact", dx=0.005)
    body = replace(made.bodies[0], region=Lens())
    return replace(made, bodies=(body,), loading=replace(made.loading, force_field=Pull()))
'''


@pytest.mark.thorough
def test_what_no_record_holds_does_not_end_a_run(tmp_path, monkeypatch, capsys):
    (tmp_path / "mine.py").write_text(SCENE)
    options = ["--set", "t_end=1e-5", "--set", "strain_end=none", "--frames", "0", "--no-movie", "--threads", "1"]
    command = [sys.executable, "-m", "rsmpm_ti.scene", "mine.py", *options, "--set", "output.vtu=0"]
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    done = subprocess.run(command, env=environment, cwd=tmp_path, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr[-2000:]
    out = tmp_path / "renders" / "mine"
    assert (out / "summary.json").exists() and (out / "checkpoint.npz").exists()
    region = json.loads((out / "scene.json").read_text())["scene"]["bodies"][0]["region"]
    assert region["type"] == "Lens" and region["own"]["rule"] == {"unrecorded": "function"}
    monkeypatch.chdir(out)
    assert main(["scene.json"]) == 2
    refused = capsys.readouterr().err
    assert refused.count("\n") == 1 and "scene.bodies[0].region is of 'Lens', a class of the scene file" in refused
