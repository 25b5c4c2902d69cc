"""The speed-against-error sweep: what it runs, how the front and the recommendations are chosen."""

import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti.bench.__main__ import main
from rsmpm_ti.bench.error import CSV_NAME, draw, read_sweep
from rsmpm_ti.bench.measures import Measure
from rsmpm_ti.bench.pareto import cheapest, pareto, recommendations
from rsmpm_ti.bench.scaling import SIZES, particles, steps_for
from rsmpm_ti.bench.speed import runners, timed
from rsmpm_ti.bench.sweep import CELLS, SHAPES, Setting, sweep
from rsmpm_ti.bench.workers import WIDTHS, Runner, compile_twins, workers


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


@pytest.mark.validation
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


@pytest.mark.skipif(shutil.which("g++") is None, reason="no g++")
@pytest.mark.validation
def test_twins_carry_a_flying_block(tmp_path):
    """Both carry a block in free flight: after 20 steps it keeps its speed."""
    from rsmpm_ti.backend.start import start_taichi
    from rsmpm_ti.bench.naive import NX, NY, Naive

    twins = compile_twins(tmp_path)
    start_taichi("f64", "cpu", 1)
    for shape, width in WIDTHS.items():
        naive = Naive(width)
        for _ in range(20):
            naive.step()
        said = subprocess.run([twins[shape]], input="20\n", capture_output=True, text=True, check=True).stdout.split()
        v = naive.v.to_numpy()
        assert float(said[0]) > 0.1 and len(v) == 4 * NX * NY
        assert float(said[1]) == pytest.approx(v[:, 0].mean(), rel=1e-6)


@pytest.mark.validation
def test_workers_give_rates_of_every_code(tmp_path):
    with workers() as (pool, twins):
        plan = [Runner("naive", "bspline"), Runner("solver", "linear", dx=2.5e-3, threads=2)]
        plan += [Runner("c++", "linear")] * twins
        rates = timed(plan, pool, rounds=2, steps=2)
    assert all(len(values) == 2 and min(values) > 1e-4 for values in rates.values())
    assert len({runner.label for runner in runners(2, True)}) == len(runners(2, True))


def test_memory_is_that_of_the_fields(capsys):
    """A plane-strain particle of the intact cube: 19 numbers of 8 bytes with scratch, and 5 of 4; less than 200."""
    assert main(["memory", "intact"]) == 0
    columns = capsys.readouterr().out.splitlines()[1].split()
    assert columns[0] == "intact" and int(columns[1]) == 80000
    assert int(columns[2]) == 18 * 8 + 5 * 4 and int(columns[2]) < 200


def test_scaling_names_particles_and_takes_few_steps_of_many():
    assert [particles(dx) for dx in SIZES] == [20000, 80000, 320000, 1280000, 5120000]
    assert steps_for(SIZES[0]) == 500 and steps_for(SIZES[-1]) == 6


@pytest.mark.validation
def test_fill_compares_both_grids_where_the_same_is_filled(capsys, monkeypatch):
    from rsmpm_ti.bench import ratios

    monkeypatch.setattr(ratios, "EDGES", {2: (30,), 3: ()})
    monkeypatch.setattr(ratios, "RADIUS", {2: 5})
    assert main(["fill", "--rounds", "1"]) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()[2:]]
    assert [row[:2] for row in rows] == [["linear", "2"], ["bspline", "2"]]
    for row in rows:
        assert 5.0 < float(row[2]) < 100.0 * np.pi * 25.0 / 900.0, "pi r^2 over nodes, more than the cells"
        assert float(row[3]) > 0.0


@pytest.mark.thorough
def test_lab_rock_is_measured_whole_and_cracked(capsys, monkeypatch):
    from rsmpm_ti.bench import ratios

    monkeypatch.setattr(ratios, "PEAK", 1e-5)
    assert main(["lab", "--dx", "1e-3", "--rounds", "1", "--threads", "2"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line[:24].strip() for line in lines[2:]] == ["the paper's rule", "cube_lab, whole", "cube_lab, at its peak"]
    assert float(lines[2].split()[-1]) == 1.0 and all(float(line.split()[-1]) > 0.1 for line in lines[3:])
