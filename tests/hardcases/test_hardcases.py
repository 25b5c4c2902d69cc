"""The quick tier of `python -m rsmpm_ti.hardcases`, case by case, and what finds a run unstable or a bar parted."""

import json
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti.analysis.numerical_fracture import parted, parting_warning
from rsmpm_ti.cases.running import run_case
from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.hardcases.__main__ import main
from rsmpm_ti.hardcases.catalogue import CASES, MODULES
from rsmpm_ti.hardcases.pieces import C_P, DX, scene_of
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.records.snapshot import Snapshot
from rsmpm_ti.run.run import simulate
from rsmpm_ti.spec.scene import Output, Schedule

QUICK = [name for name, case in CASES.items() if case.quick]


@pytest.mark.parametrize("name", QUICK)
def test_case_holds(name):
    rows = run_case("rsmpm_ti.hardcases.catalogue", name, full=False, out=None, threads=1)
    assert rows and [row for row in rows if not row.passed] == []
    assert all(len(row.reason) > 3 for row in rows), "every limit has its reason beside it"


def test_names_are_unique_and_list_names_every_case(capsys):
    names = [case.name for module in MODULES for case in module.CASES]
    assert len(set(names)) == len(names) and max(map(len, names)) <= 18
    assert main(["--list"]) == 0
    printed = capsys.readouterr().out
    assert all(name in printed for name in names)


def too_long_a_step(cfl: float):
    """A scene that no check has seen the step of: flying, free, elastic."""
    scene = scene_of((30, 12), (3, 3), (9, 9), schedule=Schedule(t_end=400.0 * DX / C_P, rows=100))
    body = replace(scene.bodies[0], velocity=(0.1, 0.0))
    scene = replace(scene, bodies=(body,), output=Output(frames=0, movie=False, vtu=0))
    object.__setattr__(scene.schedule, "cfl", cfl)  # the scene would refuse it
    return scene


def test_step_past_the_limit_is_found_by_its_energy_and_everything_up_to_there_is_written(tmp_path):
    with pytest.raises(
        UnstableRun, match=r"% of the energy .* came from nowhere at step \d+.* at \[.*\] mm; likely cause"
    ):
        simulate(too_long_a_step(1.9), out=tmp_path, threads=1)
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert "came from nowhere" in summary["stopped"]
    table = np.genfromtxt(tmp_path / "history.csv", delimiter=",", names=True)
    energy = table["energy_kinetic_J"] + table["energy_elastic_J"]
    assert energy[-1] > 2.0 * energy[0], "the row that showed it is in the file"
    assert energy[-2] < 2.0 * energy[0], "and it is the first that did"


def drawn_out(stretch: float, broken: slice = slice(0, 0)) -> Snapshot:
    """A strip of 8 x 2 particles, half a cell apart, drawn out along x."""
    reference = DX * 0.5 * np.stack(np.meshgrid(np.arange(8), np.arange(2), indexing="ij"), axis=-1).reshape(-1, 2)
    x = reference * np.array([stretch, 1.0])
    n = len(x)
    mode = np.zeros(n, dtype=np.int8)
    mode[broken] = 1
    empty = {name: np.zeros(n) for name in Snapshot.__dataclass_fields__}
    return Snapshot(**empty | {"x": x, "displacement": x - reference, "failure_mode": mode, "damage": 1.0 * (mode > 0)})


@pytest.mark.parametrize("shape, bridged", [(Linear(), 1.0), (Gimp(), 1.5), (QuadraticBSpline(), 2.0)], ids=str)
def test_neighbours_are_parted_beyond_what_a_shape_function_surely_bridges(shape, bridged):
    """Two points share a node wherever they are iff they are no farther apart than the support less one cell."""
    where = np.linspace(0.0, 1.0, 101)
    for distance, always in ((bridged, True), (bridged + 0.05, False)):
        nodes = np.arange(-3, 6)
        reached = [(shape.profile(position - nodes) > 0.0) for position in (where[:, None], where[:, None] + distance)]
        # at the distance itself a support may end on the very node: what is asked for is just below it
        closer = shape.profile(where[:, None] + distance - 1e-9 - nodes) > 0.0
        shared = (reached[0] & (closer if always else reached[1])).any(axis=1)
        assert shared.all() == always
    scene = scene_of((30, 8), (2, 2), (6, 3), shape=shape)
    assert len(parted(scene, drawn_out(2.0 * bridged * 0.99))) == 0
    assert parting_warning(scene, drawn_out(2.0 * bridged * 0.99)) == ""
    assert len(parted(scene, drawn_out(2.0 * bridged * 1.01))) == 14  # seven gaps in each of two rows
    assert "parted by its discretisation" in parting_warning(scene, drawn_out(2.0 * bridged * 1.01))


def test_broken_rock_may_part():
    scene = scene_of((30, 8), (2, 2), (6, 3))
    assert len(parted(scene, drawn_out(3.0, broken=slice(0, 16)))) == 0
    assert len(parted(scene, drawn_out(3.0, broken=slice(0, 2)))) == 12  # those of the first gap belong to a crack
