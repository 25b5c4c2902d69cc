"""docs/extending.md: its recipes run, alone or together."""

import re
import runpy

import numpy as np
import pytest
from pages import ROOT, blocks, run_block

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.cases.running import run_case
from rsmpm_ti.errors import SceneError


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)  # what snippets write goes here
    return tmp_path


def recipe(*headings: str) -> str:
    """The blocks below these headings of docs/extending.md, as one file."""
    sections = re.split(r"^## ", (ROOT / "docs/extending.md").read_text(encoding="utf-8"), flags=re.MULTILINE)[1:]
    found = {section.splitlines()[0]: re.findall(r"```python\n(.*?)```", section, re.DOTALL) for section in sections}
    assert set(headings) <= set(found) and all(len(code) <= 1 for code in found.values())
    return "\n\n".join(found[heading][0] for heading in headings)


TOGETHER = ("Shape function", "Transfer", "Criterion", "Boundary", "Region", "Scene")

APART = ("Law after failure", "Observer", "History column", "Load cell", "Verification case", "A field of scene data")


def test_every_recipe_is_run():
    assert len(blocks("docs/extending.md")) == len(TOGETHER) + len(APART)
    assert all(recipe(heading) for heading in TOGETHER + APART)


def test_recipe_of_a_field_refuses_what_its_annotation_does_not_allow(folder):
    (folder / "isotropic.py").write_text(recipe("A field of scene data"), encoding="utf-8")
    kind = runpy.run_path("isotropic.py")["Isotropic"]
    assert kind(E=17e9, nu=0.14).nu == 0.14
    with pytest.raises(SceneError, match=r"^elasticity\.nu = 0\.5 is refused: it must be a number in .*; at 0\.5"):
        kind(E=17e9, nu=0.5)


def test_recipes_make_one_scene_that_breaks(folder):
    (folder / "mine.py").write_text(recipe(*TOGETHER), encoding="utf-8")
    scene = load_scene("mine.py", dx=2.5e-3, strain_end=8e-4, settings={"schedule.rows": "50"})
    assert {type(part).__name__ for part in (scene.shape, scene.transfer, scene.rock.criterion)} == {
        "Blend", "LimitedFlip", "Sheorey",
    }  # fmt: skip
    near = np.linspace(-2.0, 2.0, 401)
    total = sum(scene.shape.profile(near - k) for k in range(-4, 5))
    np.testing.assert_allclose(total, 1.0, atol=1e-14)
    result = simulate(scene, threads=1)
    assert result.summary["failed_tension"] > 0 and result.stopped == ""
    assert result.summary["energy_balance_error"] < 0.02


def test_recipe_of_a_law_remembers(folder):
    left = run_block(folder, recipe("Law after failure"))
    state = left["result"].snapshot
    failed = state.failure_mode > 0
    assert failed.any() and (state.history["age"][failed] > 0.0).all() and (state.history["age"][~failed] == 0.0).all()


def test_recipe_of_an_observer_sees_the_crack_go_down(folder):
    depths = run_block(folder, recipe("Observer"))["deepest"].depths
    assert len(depths) == 11 and depths == sorted(depths, reverse=True) and depths[-1] < 0.045 < depths[0]


def test_recipe_of_a_column_is_in_the_history(folder):
    speed = run_block(folder, recipe("History column"))["result"].history["fastest_m_s"]
    assert (speed > 2.4e-3).all()  # no slower than the platens


def test_recipe_of_a_load_cell_reads_two_rollers_as_one_side(folder):
    (folder / "bending.py").write_text(recipe("Load cell"), encoding="utf-8")
    cell = load_scene("bending.py").loading.load_cell
    assert (cell.lower, cell.upper) == ((0, 1), (2,))
    load = cell.read(np.array([[0.0, 1e3], [0.0, 1e3], [0.0, -2e3]]))
    assert (load.force_lower, load.force_upper) == (2e3, 2e3)
    assert load.stress == pytest.approx(1.5 * 2e3 * 0.08 / 0.02**2)  # 3 F L/(2 h^2)


def test_recipe_of_a_case_passes(folder, monkeypatch):
    (folder / "my_cases.py").write_text(recipe("Verification case"), encoding="utf-8")
    monkeypatch.syspath_prepend(str(folder))
    rows = run_case("my_cases", "stiffness", full=False, out=None)
    assert rows and all(row.passed for row in rows)
