"""docs/outputs.md says what the tables say, and files hold what both say."""

from pathlib import Path

import meshio
import numpy as np
import pytest
from snapshots import snapshot_of

from rsmpm_ti.output.describe import TABLES, page
from rsmpm_ti.output.files import write_rows, write_vtu
from rsmpm_ti.records.files import write_csv, write_json
from rsmpm_ti.records.snapshot import PARTICLES

PAGE = Path(__file__).resolve().parents[2] / "docs" / "outputs.md"


def test_the_page_is_what_the_tables_print():
    assert PAGE.read_text(encoding="utf-8") == page(), "python -m rsmpm_ti.output.describe > docs/outputs.md"


@pytest.mark.parametrize("table", TABLES, ids=lambda table: table.file)
def test_every_column_has_a_meaning_and_names_differ(table):
    assert len(set(table.names)) == len(table.names) and table.about
    assert all(column.about for column in table.columns)
    for column in table.columns:  # a name that carries its unit carries the one that is declared
        for ending, unit in (("tip_speed_m_s", "m/s"), ("_Pa", "Pa"), ("_J", "J"), ("_deg", "degree"), ("_kg", "kg")):
            if column.name.endswith(ending):
                assert column.unit == unit, column.name


def test_what_a_law_remembers_is_written_under_its_own_name(tmp_path):
    history = {"slip": np.array([0.5, 0.25]), "damage": np.array([[1.0, 2.0, 3.0]] * 2)}
    snapshot = snapshot_of(np.array([[0.0, 0.0], [1e-3, 0.0]]), history=history)
    write_vtu(tmp_path / "p.vtu", snapshot)
    data = meshio.read(tmp_path / "p.vtu").point_data
    assert set(data) == {*PARTICLES.names, "slip", "law_damage"} - {"rock"}
    assert data["slip"].tolist() == [0.5, 0.25] and data["law_damage"].shape == (2, 3)
    assert data["damage"].tolist() == [0.0, 0.0], "the run's own field keeps its name"


def test_what_is_not_finite_is_an_empty_cell_or_null(tmp_path):
    rows = np.array([(0.5, np.nan), (np.inf, 1.0)], dtype=[("a", float), ("b", float)])
    write_rows(tmp_path / "h.csv", rows)
    assert (tmp_path / "h.csv").read_text().split() == ["a,b", "0.5,", ",1"]
    write_json(tmp_path / "s.json", {"a": float("nan"), "b": [1.0, np.float64("inf"), -np.finfo(float).max]})
    assert "".join((tmp_path / "s.json").read_text().split()) == '{"a":null,"b":[1.0,null,null]}'


def test_a_file_that_fails_half_way_leaves_the_old_one(tmp_path):
    write_csv(tmp_path / "t.csv", ("a",), [(1,)])

    def rows():
        yield (2,)
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError):
        write_csv(tmp_path / "t.csv", ("a",), rows())
    assert (tmp_path / "t.csv").read_text().split() == ["a", "1"]
    assert [path.name for path in tmp_path.iterdir()] == ["t.csv"]
