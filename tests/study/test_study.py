"""Families of runs: what is kept and run again, how wings are read, and how the command behaves."""

import csv
import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

from rsmpm_ti.cases.case import Outcome, at_most
from rsmpm_ti.study import fracture_energy, runs
from rsmpm_ti.study.__main__ import main
from rsmpm_ti.study.catalogue import STUDIES
from rsmpm_ti.study.grid_independence import BIN, FLAW, PATH, finish, read_wing, spread
from rsmpm_ti.study.rotated_specimen import ENDS
from rsmpm_ti.study.runs import Run, Study, kept, run_all


def squares(*, upto: int, log: str) -> dict:
    """Work of a run in another process: leaves a line in a file each time that it is done."""
    with open(log, "a") as file:
        file.write(f"{upto}\n")
    return {"values": np.arange(upto) ** 2, "upto": upto}


def test_run_that_is_done_is_not_run_again_unless_its_settings_changed(tmp_path):
    log = tmp_path / "log"

    def go(upto):
        found = list(run_all([Run("one", squares, {"upto": upto, "log": str(log)})], tmp_path / "kept", 1))
        assert [tag for tag, _, _ in found] == ["one"]
        np.testing.assert_array_equal(found[0][1]["values"], np.arange(upto) ** 2)
        return found[0][2], log.read_text().splitlines()

    seconds, done = go(3)
    assert done == ["3"] and seconds > 0.0
    assert go(3) == (0.0, ["3"])
    assert go(4)[1] == ["3", "4"]
    assert not list(tmp_path.rglob("*.part*"))


@pytest.fixture
def stored(tmp_path):
    """A kept result of Run("a", squares, {"upto": 3}), written by hand."""
    run = Run("a", squares, {"upto": 3})
    np.savez_compressed(tmp_path / "a.npz", stamp=np.array(runs.stamp(run)), values=np.arange(3))
    return run, tmp_path


def test_result_of_the_same_settings_is_kept(stored):
    run, folder = stored
    result = kept(run, folder)
    assert set(result) == {"values"} and result["values"].tolist() == [0, 1, 2]
    assert kept(Run("b", squares, {"upto": 3}), folder) is None


@pytest.mark.parametrize(
    "other",
    [
        Run("a", squares, {"upto": 4}),
        Run("a", squares, {"upto": 3, "more": 1.0}),
        Run("a", squares, {}),
        Run("a", squares, {"upto": 3}, precision="f32"),
    ],
    ids=["value", "added", "missing", "precision"],
)
def test_result_of_other_settings_is_refused(stored, other):
    assert kept(other, stored[1]) is None


def test_result_of_another_version_is_refused(stored, monkeypatch):
    run, folder = stored
    monkeypatch.setattr(runs, "__version__", "0.0.0")
    assert kept(run, folder) is None


def test_result_of_other_sources_is_refused(stored, monkeypatch):
    run, folder = stored
    monkeypatch.setattr(runs, "sources", lambda work: "another solver")
    assert kept(run, folder) is None


def test_sources_are_those_of_the_work_the_solver_and_the_scenes(tmp_path, monkeypatch):
    before = runs.sources.__wrapped__(squares)
    assert before == runs.sources.__wrapped__(squares) != runs.sources.__wrapped__(fracture_energy.pull_seam)
    (tmp_path / "scenes").mkdir()
    (tmp_path / "scenes" / "mine.py").write_text("def scene(): ...")
    monkeypatch.chdir(tmp_path)
    assert runs.sources.__wrapped__(squares) != before


def test_rooms_within_rooms_are_of_the_solver_too():
    """The law of broken rock lies two rooms deep."""
    files = [file for file in runs.code_behind(squares) if file.is_relative_to(runs.PACKAGE)]
    behind = {file.relative_to(runs.PACKAGE).as_posix() for file in files}
    assert {"rock/broken/crack_return.py", "spec/quasi_static/servo.py", "setups/uniaxial.py", "units.py"} <= behind
    assert not any(name.startswith(("paint/", "output/", "study/")) for name in behind)


def test_kept_only_draws_what_there_is_and_refuses_where_there_is_nothing(tmp_path, monkeypatch, capsys):
    plan = [Run(name, squares, {"upto": 3}) for name in ("a", "b")]
    seen = []

    def finish(results):
        seen.append(sorted(results))
        return Outcome((at_most("largest square", 4.0, 5.0, "2^2"),), lambda figure: None)

    monkeypatch.setitem(STUDIES, "toy", Study("toy", "two runs", lambda quick: plan, finish))
    command = ["toy", "--kept", "--out", str(tmp_path)]
    assert main(command) == 2
    assert "without --kept" in capsys.readouterr().err and not seen
    (tmp_path / "toy").mkdir()
    np.savez(tmp_path / "toy" / "b.npz", stamp=np.array(runs.stamp(plan[1])), values=np.arange(3))
    assert main(command) == 0 and seen == [["b"]]
    assert (tmp_path / "toy" / "toy.png").is_file()
    (row,) = csv.DictReader((tmp_path / "toy" / "toy.csv").open(encoding="utf-8"))
    assert (row["case"], row["quantity"], row["got"], row["verdict"]) == ("toy", "largest square", "4", "pass")


def test_file_that_is_no_result_is_run_over(tmp_path):
    np.savez(tmp_path / "a.npz", values=np.arange(3))
    assert kept(Run("a", squares, {"upto": 3}), tmp_path) is None


TIP = 0.5 * FLAW.length * FLAW.direction


DX = 0.5e-3
AHEAD = round(4.0 * BIN / DX)
"""How many of a bin's failures make its place."""


def wing(angle: float) -> np.ndarray:
    """What failed in one straight wing at `angle` [degrees] from the flaw's plane, from the bin above the tip upwards.

    In each bin first as many as make its place, along the line, then as many beside it.
    """
    bottom = BIN * math.ceil(TIP[1] / BIN)
    height = bottom + BIN * (np.arange(AHEAD * 25) + 0.5) / AHEAD
    middle = TIP[0] + (height - bottom) / math.tan(math.radians(45.0 + angle))
    line = np.stack([middle, height], axis=1)
    return np.concatenate([line, line + [0.7e-3, 0.0]])


@pytest.mark.parametrize("angle", [60.0, 70.0, 80.0, 95.0])
def test_straight_wing_has_its_angle_and_its_path(angle):
    made = wing(angle)
    found = read_wing({"first_0": np.array([70.0, 80.0]), "failed_0": made}, "0", DX)
    assert found.first == 75.0
    assert found.left == pytest.approx(angle, abs=0.01)
    slope = 1.0 / math.tan(math.radians(45.0 + angle))
    height = (np.arange(round(made[0, 1] / BIN - 0.5), math.floor((TIP[1] + PATH) / BIN)) + 0.5) * BIN
    expected = np.stack([TIP[0] + slope * (height - made[0, 1] + 0.5 * BIN / AHEAD), height], axis=1)
    # beyond 8 mm to a side failures are another crack's: bins that a wing leaves there are not compared
    whole = np.abs(expected[:, 0] - TIP[0]) + 0.7e-3 + 0.5 * BIN * abs(slope) < 8e-3
    assert whole.sum() > 5
    np.testing.assert_allclose(found.path[: whole.sum()], expected[whole], rtol=0.0, atol=1e-12)


def test_what_fails_late_below_or_far_aside_does_not_move_a_path():
    clean = wing(80.0)
    late = clean[-AHEAD:] + [2e-3, 0.0]
    more = np.vstack([clean, clean[0] - [0.0, 2.5e-3], clean[0] + [9e-3, 5e-3], late])
    one, other = (read_wing({"failed_1": x}, "1", DX) for x in (clean, more))
    np.testing.assert_array_equal(one.path, other.path)
    assert one.left == other.left and np.isnan(one.first)


def test_wing_that_never_failed_has_no_direction_and_no_path():
    found = read_wing({"failed_0": np.zeros((0, 2)), "first_0": np.array([75.0])}, "0", DX)
    assert found.first == 75.0 and np.isnan(found.left) and found.path.shape == (0, 2)


def test_wing_of_one_failure_has_no_direction():
    found = read_wing({"failed_0": wing(80.0)[:1]}, "0", DX)
    assert np.isnan(found.left) and found.path.shape == (1, 2)


def straight(lateral: float, first: int = 0, last: int = 20) -> np.ndarray:
    return np.stack([np.full(last - first, lateral), (np.arange(first, last) + 0.5) * BIN], axis=1)


def test_spread_of_parallel_paths_is_their_distance():
    assert spread([straight(1e-3), straight(2e-3)]) == pytest.approx((1e-3, 1e-3), rel=1e-12)
    # three: 1, 2 and 3 mm apart
    largest, rms = spread([straight(0.0), straight(1e-3), straight(3e-3)])
    assert largest == pytest.approx(3e-3) and rms == pytest.approx(1e-3 * math.sqrt((1 + 4 + 9) / 3.0))


def test_paths_are_compared_at_the_same_height_only():
    assert np.isnan(spread([straight(0.0, 0, 5), straight(9e-3, 5, 9)])).all()
    assert spread([straight(0.0, 0, 6), straight(9e-3, 5, 9)]) == pytest.approx((9e-3, 9e-3))
    assert np.isnan(spread([straight(0.0)])).all() and np.isnan(spread([])).all()


@pytest.mark.parametrize("name", sorted(STUDIES))
@pytest.mark.parametrize("quick", [False, True])
def test_runs_of_a_study_have_names_of_their_own_and_settings_that_are_data(name, quick):
    plan = STUDIES[name].runs(quick)
    assert len({run.tag for run in plan}) == len(plan) > 0
    assert len({(run.work, runs.stamp(run)) for run in plan}) == len(plan)  # json of settings: plain data


def test_list_names_every_study():
    done = subprocess.run(
        [sys.executable, "-m", "rsmpm_ti.study", "--list"],
        cwd=Path(__file__).resolve().parents[2], capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    assert [line.split()[0] for line in done.stdout.splitlines()] == list(STUDIES)


@pytest.mark.parametrize(
    "arguments, words",
    [(["nonsense"], "unknown study nonsense"), ([], "name a study"), (["fracture_energy", "--jobs", "0"], "--jobs 0")],
)
def test_bad_command_is_refused_in_a_line_with_the_studies(arguments, words, capsys):
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert out == "" and err.count("\n") == 1 and words in err and "grid_independence" in err


def test_fracture_energy_reads_peaks_and_energies():
    """A strip of 2 MPa on the ligament, and one of the paper's whose peak falls as the root of dx."""

    def pulled(peak: float) -> dict:
        return {"strain": np.linspace(0.0, 1e-4, 3), "stress": np.array([0.0, 0.5 * peak, 0.0]), "dissipated": None}

    results = {f"lab_{dx:g}": pulled(2e6) for dx in (1.0, 0.5)}
    results |= {f"paper_{dx:g}": pulled(2e6 * dx**0.43) for dx in (1.0, 0.5)}
    seam = {"stress": np.zeros(1), "strain": np.zeros(1), "dissipated": np.array([0.0, 5.1 * 10e-3]), "energy": 5.0}
    outcome = fracture_energy.finish(results | {"lattice_1": seam, "jittered_1": seam})
    outcome.draw(Figure())
    assert all(row.passed for row in outcome.rows) and len(outcome.rows) == 4
    assert [row.got for row in outcome.rows[:2]] == pytest.approx([5.1, 5.1])
    assert outcome.rows[-1].got == pytest.approx(0.43)


def test_peak_is_of_the_load_before_the_break_not_of_the_waves_after():
    rise = np.array([0.0, 0.3, 0.28, 0.9, 0.95, 0.93, 1.0, 0.97])
    assert fracture_energy.peak(rise) == 1.0
    assert fracture_energy.peak(np.append(rise, [0.5, -0.2, 1.2])) == 1.0
    assert fracture_energy.peak(np.append([0.0, 0.2, 0.1], rise)) == 1.0  # a ripple early on is no break


def test_grid_independence_reads_what_there_is():
    """Of one run of one rock, as --kept finds it; none of the paper's rule."""
    result = {f"failed_{name}": wing(70.0) for name in ENDS}
    result |= {f"first_{name}": np.full(6, 72.0) for name in ENDS} | {f"onset_{name}": np.array(3.3e6) for name in ENDS}
    rows = {row.quantity: row.got for row in finish({"lab_0.5_0_1": result}).rows}
    assert rows["cube_lab: largest angle of first cracks [deg]"] == pytest.approx(72.0)
    assert not any("paper" in name for name in rows)
