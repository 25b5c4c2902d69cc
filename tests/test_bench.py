"""The speed-against-error sweep: what it runs, how the front and the recommendations are chosen."""

from dataclasses import replace

import pytest

from rsmpm_ti.bench.__main__ import main
from rsmpm_ti.bench.error import CSV_NAME, draw, read_sweep
from rsmpm_ti.bench.front import cheapest, pareto, recommendations
from rsmpm_ti.bench.measures import Measure
from rsmpm_ti.bench.settings import CELLS, SHAPES, Setting, sweep


def entry(wall: float, error: float, **changes):
    return replace(Setting("bar", 16), **changes), Measure(error, wall, 1000)


ENTRIES = [entry(1.0, 0.1), entry(2.0, 0.03, order="usf"), entry(3.0, 0.04, shape="gimp"), entry(4.0, 0.008, cells=32)]


def test_front_holds_what_no_other_beats_in_both():
    assert pareto(ENTRIES, lambda m: m.wall_s) == [ENTRIES[0], ENTRIES[1], ENTRIES[3]]


@pytest.mark.parametrize("level, expected", [(0.2, 0), (0.05, 1), (0.01, 3), (0.001, None)])
def test_cheapest_setting_of_an_accuracy(level, expected):
    assert cheapest(ENTRIES, level) == (None if expected is None else ENTRIES[expected])


def test_recommendations_name_each_setting_once():
    table = recommendations(ENTRIES)
    assert table.count("| bar |") == 3 and "2.0 x" in table and "usf" in table


@pytest.mark.parametrize("case", CELLS)
def test_sweep_covers_every_scheme_once_and_leaves_out_what_is_refused(case):
    settings = sweep(case)
    assert len(set(settings)) == len(settings)
    assert not [s for s in settings if s.order == "usl" and s.shape == "linear"]
    assert {(s.shape, s.transfer, s.order) for s in settings if s.cells == CELLS[case][0]} >= {
        (shape, transfer, order) for shape in SHAPES for transfer in ("flip", "apic") for order in ("musl", "usf")
    }
    assert {s.precision for s in settings} == {"f64", "f32"} and {s.per_axis for s in settings} == {2, 3}
    assert {s.cells for s in settings} == set(CELLS[case])
    assert {s.cells for s in sweep(case, finest=False)} == set(CELLS[case][:2])


def test_error_sweep_of_one_small_case_writes_csv_and_picture(tmp_path, monkeypatch, capsys):
    """Two settings of the bar in processes of their own; errors are those of the dispersion formula over two periods:
    2 pi x 2 x (k h)^2/8 = 6.1 % for linear functions at 32 cells per wavelength (confirmed by the verification)."""
    import rsmpm_ti.bench.error as module

    settings = [Setting("bar", cells, "linear") for cells in (16, 32)]
    monkeypatch.setattr(module, "sweep", lambda case, finest: settings)
    assert main(["error", "bar", "--out", str(tmp_path), "--jobs", "2"]) == 0
    entries = dict(read_sweep(tmp_path / CSV_NAME))
    assert set(entries) == set(settings)
    # theory holds to its own next order, (k h)^2 relative, and the time step adds (omega dt)^2/24
    assert entries[settings[1]].error == pytest.approx(0.0606, rel=0.2)
    assert 3.5 < entries[settings[0]].error / entries[settings[1]].error < 5.5
    assert (tmp_path / "speed_vs_error.png").stat().st_size > 10_000
    assert "| bar |" in capsys.readouterr().out
    draw(tmp_path / "again.png", list(entries.items()))
    # another case is added to what is there
    settings[:] = [Setting("vortex", 16, "linear")]
    assert main(["error", "vortex", "--out", str(tmp_path), "--jobs", "1"]) == 0
    assert set(dict(read_sweep(tmp_path / CSV_NAME))) == set(entries) | set(settings)


def test_unknown_case_is_refused(capsys):
    with pytest.raises(SystemExit) as stop:
        main(["error", "nonsense"])
    assert stop.value.code == 2
