"""How a run ends before its schedule: the load fell, the specimen burst, a signal came; and with which status."""

import json
import os
import re
import signal
from dataclasses import replace
from types import SimpleNamespace

import pytest
from small_scene import make, refusal

from rsmpm_ti import PicFlip, UnstableRun, load_scene, simulate
from rsmpm_ti.analysis.load_curve import FilteredLoad
from rsmpm_ti.errors import BrokenApart
from rsmpm_ti.run.ending import burst, fallen
from rsmpm_ti.run.run import Run
from rsmpm_ti.scene import main
from rsmpm_ti.solver.guard import EnergyBooks

COARSE = (
    "cube --set dx=2mm --set flaw_width=6mm --set schedule.rows=100 --frames 0 --no-movie --set output.vtu=0 "
    "--threads 1"
).split()


def run(tmp_path, *more: str) -> tuple[int, dict]:
    status = main([*COARSE, *more, "--out", str(tmp_path)])
    return status, json.loads((tmp_path / "summary.json").read_text())


def test_run_ends_where_the_load_has_fallen_by_the_fraction_asked_for(tmp_path, capsys):
    fall = ("--set", "strain_end=1e-3", "--set", "schedule.stop_after_drop=0.5")
    status, numbers = run(tmp_path, *fall)
    said = capsys.readouterr().out
    assert status == 0 and numbers["stopped"].startswith("stopped: the load fell to 0.")
    assert numbers["stopped"] in said and "--resume" not in said and "peak stress: " in said
    whole = load_scene("cube", dx=2e-3, flaw_width=6e-3, strain_end=1e-3).steps
    assert 0.2 * whole < numbers["steps"] < 0.8 * whole
    assert 0.9 < numbers["peak_filtered_Pa"] / numbers["peak_stress_Pa"] <= 1.0
    history = (tmp_path / "history.csv").read_text()
    status, again = run(tmp_path, *fall, "--resume")
    assert status == 0 and again["steps"] == numbers["steps"] and (tmp_path / "history.csv").read_text() == history


def test_load_that_is_only_rising_is_called_the_largest_so_far(tmp_path, capsys):
    status, numbers = run(tmp_path, "--set", "strain_end=1e-4")
    assert status == 0 and numbers["peak_stress_Pa"] is None and numbers["peak_filtered_Pa"] is None
    assert numbers["largest_stress_Pa"] > 1e6 and numbers["stopped"] == ""
    said = capsys.readouterr().out
    assert "largest stress so far" in said and "peak stress" not in said


@pytest.mark.thorough
def test_specimen_that_bursts_after_its_peak_is_a_result(tmp_path, capsys):
    """The paper's rock flies apart and leaves the domain, which has two cells of room beside it."""
    along = ("--set", "turn=0", "--set", "bodies.0.seeding=Jittered", "--set", "transfer.flip=1")  # more violent
    status, numbers = run(tmp_path, *along, "--set", "strain_end=8e-3", "--set", "schedule.stop_after_drop=none")
    said = capsys.readouterr().out
    assert status == 0 and re.match(r"burst: \d+ particles have left the domain at step", numbers["stopped"])
    assert numbers["stopped"] in said and "unstable" not in said
    assert numbers["peak_filtered_Pa"] > 1e6
    assert any("not quasi-static" in sentence for sentence in numbers["warnings"])
    assert not list(tmp_path.glob("checkpoint*.npz")), "a state that cannot be followed is no state to go on from"


def looked(failures: int = 100, strain: float = 1e-3, held: tuple = ()) -> SimpleNamespace:
    survey = SimpleNamespace(failed_tension=failures, failed_shear=0)
    sim = SimpleNamespace(particles=SimpleNamespace(count=1000), grid=SimpleNamespace(held=held))
    return SimpleNamespace(survey=survey, sim=sim, step=10, time=1e-3, strain=strain)


def load(now: float) -> FilteredLoad:
    found = FilteredLoad(make())
    for k, stress in enumerate([*range(50), *20 * [49.0 * now]]):
        found.see(1e6 * stress, 1e-5 * k)
    return found


FLOWN = BrokenApart("3 particles have left the domain at step 10; likely cause: fragments flying off")
BOOKS = EnergyBooks(start=0.0, quiet=0.0, exchanged=10.0, most=10.0, created=0.3)


def test_burst_is_told_with_its_peak():
    said = burst(load(0.1), looked(), BOOKS, FLOWN)
    assert said.startswith("burst: 3 particles have left the domain at step 10, after the peak of 4")
    assert "fallen to 0.1 of it, with 100 failures of 1000 particles" in said and "likely cause" not in said


def test_burst_under_a_held_force_whose_load_cannot_fall():
    said = burst(load(0.9), looked(held=("upper",)), BOOKS, FLOWN)
    assert said.startswith("burst: 3 particles have left the domain at step 10, under a held force, 4")
    assert burst(load(0.9), looked(3, held=("upper",)), BOOKS, FLOWN) == "", "hardly broken"


@pytest.mark.parametrize(
    "now, failures, created",
    [(0.9, 100, 0.3), (1.0, 100, 0.3), (0.1, 3, 0.3), (0.1, 0, 0.3), (0.1, 100, 2.0), (0.1, 100, float("nan"))],
    ids=["yields", "rises", "hardly broken", "whole", "made energy", "no number"],
)
def test_what_has_not_burst_is_unstable(now, failures, created):
    assert burst(load(now), looked(failures), replace(BOOKS, created=created), FLOWN) == ""


@pytest.mark.thorough
def test_step_past_the_limit_makes_energy_and_bursts_nothing():
    """Breaking rock that is torn apart by its numbers: everything fails at once, and the load swings as it likes."""
    scene = load_scene("cube", dx=2e-3, flaw_width=6e-3, turn=0.0, strain_end=1e-3)
    scene = replace(scene, schedule=replace(scene.schedule, rows=100), transfer=PicFlip())
    object.__setattr__(scene.schedule, "cfl", 3.0)  # the scene would refuse it
    with pytest.raises(UnstableRun, match=r"\d\d+ % of the energy that the run has held, came from nowhere"):
        simulate(scene, threads=1)


def test_load_that_falls_before_anything_fails_ends_nothing():
    assert fallen(load(0.1), looked(failures=0), 0.5) == ""
    assert fallen(load(0.1), looked(), None) == "" and fallen(load(0.6), looked(), 0.5) == ""
    assert "to 0.1 of its peak of 4" in fallen(load(0.1), looked(), 0.5)
    pressed = load(0.1)
    pressed.pressure = 20e6
    assert ", both less the confining pressure of 20 MPa, at step" in fallen(pressed, looked(), 0.5)


def test_stop_after_drop_needs_a_load_and_a_fraction():
    said = refusal(
        lambda: make(schedule_stop_after_drop=0.5, schedule_strain_end=None, schedule_t_end=1e-5, loading={})
    )
    assert "schedule.stop_after_drop = 0.5 is refused: it must be None where no load is measured; give two" in said
    for bad in (0.0, 1.0, -0.1, "half"):
        assert "schedule.stop_after_drop" in refusal(lambda bad=bad: make(schedule_stop_after_drop=bad))


@pytest.mark.parametrize("number, status", [(signal.SIGINT, 130), (signal.SIGTERM, 143)], ids=["Ctrl-C", "SIGTERM"])
@pytest.mark.thorough("SIGTERM")
def test_run_that_a_signal_stops_has_the_status_of_a_shell(tmp_path, monkeypatch, capsys, number, status):
    row = Run._row

    def stop(self) -> None:
        row(self)
        os.kill(os.getpid(), number)

    monkeypatch.setattr(Run, "_row", stop)
    found, numbers = run(tmp_path, "--set", "strain_end=1e-4")
    assert found == status and numbers["stopped"].startswith("interrupted after step")
    assert "go on with --resume" in capsys.readouterr().out
    monkeypatch.setattr(Run, "_row", row)
    assert run(tmp_path, "--set", "strain_end=1e-4", "--resume")[0] == 0


@pytest.mark.thorough
def test_observer_looks_at_the_end_of_a_run_that_ends_by_its_load():
    from rsmpm_ti import Observer

    class Last(Observer):
        every = 0.5

        def __init__(self):
            self.seen = []

        def see(self, view) -> None:
            self.seen.append((view.step, view.fraction))

    scene = load_scene("cube", dx=2e-3, flaw_width=6e-3, strain_end=1e-3)
    scene = replace(scene, schedule=replace(scene.schedule, rows=100, stop_after_drop=0.5))
    last = Last()
    result = simulate(scene, threads=1, observers=(last,))
    assert result.stopped and result.signal == 0
    assert last.seen[-1] == (result.summary["steps"], 1.0)
