"""Observers: when they look, what they see, how they fail in one line, and what a checkpoint keeps of them."""

import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from rsmpm_ti import Column, Observer, ObserverError, SceneError, load_scene, simulate
from rsmpm_ti.run import checkpoint
from rsmpm_ti.run.checkpoint import observer_arrays, restore_observers
from rsmpm_ti.solver.observer import Watch, look_all

ROWS = 40
QUICK = {"shape": "Linear", "schedule.rows": str(ROWS), "output.frames": "0", "output.vtu": "1"}


def scene():
    return load_scene("intact", dx=1e-2, strain_end=2e-4, settings=QUICK).elastic()


class Counts(Observer):
    """Notes when it looked."""

    def __init__(self, every: float = 0.0, fail_at: float = 2.0):
        self.every, self.fail_at, self.seen = every, fail_at, []

    def see(self, view) -> None:
        if view.fraction > self.fail_at:
            raise RuntimeError(f"no room left after {len(self.seen)} looks\nand more")
        self.seen.append((view.step, view.fraction, len(view.history)))

    def state(self) -> dict:
        return {"seen": self.seen}

    def resume(self, state: dict) -> None:
        self.seen = [tuple(entry) for entry in state["seen"]]


def at(fraction: float) -> SimpleNamespace:
    return SimpleNamespace(fraction=fraction)


@pytest.mark.parametrize(
    ("every", "looks"),
    [
        (0.25, [0.0, 0.25, 0.5, 0.75, 1.0]),
        (0.3, [0.0, 0.3, 0.6, 0.9]),
        (1.0, [0.0, 1.0]),
        (0.0, [k / 20 for k in range(21)]),
        (0.04, [k / 20 for k in range(21)]),  # finer than rows come
    ],
)
def test_looks_come_at_multiples_of_the_interval(every, looks):
    seen = []
    watch = Watch(SimpleNamespace(every=every, see=lambda v: seen.append(v.fraction), state=dict, resume=dict))
    for k in range(21):
        watch.look(at(k / 20))
    assert seen == looks


def test_a_look_between_two_rows_comes_with_the_second_and_does_not_shift_the_next():
    seen = []
    watch = Watch(SimpleNamespace(every=0.25, see=lambda v: seen.append(v.fraction), state=dict, resume=dict))
    for fraction in (0.0, 0.2, 0.4, 0.49, 0.51, 0.74, 0.76, 1.0):
        watch.look(at(fraction))
    assert seen == [0.0, 0.4, 0.51, 0.76, 1.0]


def test_everybody_looks_though_one_fails_and_the_failed_one_is_asked_again():
    seen = []

    def fail(view):
        seen.append("failed")
        raise KeyError("x")

    bad = Watch(SimpleNamespace(every=0.5, see=fail, state=dict, resume=dict))
    good = Watch(SimpleNamespace(every=0.5, see=lambda v: seen.append("good"), state=dict, resume=dict))
    for fraction in (0.0, 0.1):
        with pytest.raises(ObserverError, match=r"observer SimpleNamespace failed in fail\(\): KeyError"):
            look_all([bad, good], at(fraction))
    assert seen == ["failed", "good", "failed"]


def test_state_goes_through_a_checkpoint_arrays_and_all():
    kept = {"looks": 3, "names": ["a"], "sum": np.arange(3.0), "none": None}
    back = {}
    watches = [Watch(Counts()), Watch(SimpleNamespace(every=0.5, see=id, state=lambda: kept, resume=back.update))]
    watches[1].look(at(0.6))
    parts, arrays = observer_arrays(watches)
    assert set(arrays) == {"observer_1_0"}
    restore_observers(watches, json.loads(json.dumps(parts)), arrays)
    assert back.keys() == kept.keys() and np.array_equal(back.pop("sum"), kept["sum"])
    assert back == {"looks": 3, "names": ["a"], "none": None}
    seen = []
    watches[1].observer.see = lambda view: seen.append(view.fraction)
    watches[1].look(at(0.9))
    watches[1].look(at(1.0))
    assert seen == [1.0], "the next look is kept too"


@pytest.mark.parametrize("state", [{"a": object()}, {"a": np.array([object()])}, [1]])
def test_state_that_no_file_can_hold_is_refused(state):
    watch = Watch(SimpleNamespace(every=0.5, see=id, state=lambda: state, resume=id))
    with pytest.raises(ObserverError, match="observer SimpleNamespace: state"):
        observer_arrays([watch])


@pytest.mark.parametrize("every", [-0.1, 1.5, float("nan"), "1", None])
def test_an_interval_that_is_none_is_refused_before_anything_starts(every, monkeypatch, tmp_path):
    monkeypatch.setattr("rsmpm_ti.run.run.start_taichi", lambda *_: pytest.fail("Taichi was started"))
    with pytest.raises(SceneError, match="Counts.every"):
        simulate(scene(), out=tmp_path / "out", observers=(Counts(every),))
    with pytest.raises(SceneError, match="see is missing"):
        simulate(scene(), observers=(SimpleNamespace(every=0.5),))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    "column", [Column(name="work_J", unit="J", about="twice", value=len), Column(name="a", unit="1", about="none"), "a"]
)
def test_a_column_that_is_none_is_refused(column):
    with pytest.raises(SceneError, match="columns = "):
        simulate(scene(), columns=(column,))


@pytest.mark.thorough
def test_an_observer_that_raises_ends_the_run_in_one_line_and_all_else_is_written(tmp_path):
    failing, other = Counts(0.25, fail_at=0.6), Counts()
    with pytest.raises(ObserverError) as caught:
        simulate(scene(), out=tmp_path, threads=1, observers=(failing, other))
    message = str(caught.value)
    assert "observer Counts failed in see(): RuntimeError: no room left after 3 looks" in message
    assert "at step" in message and "\n" not in message
    assert isinstance(caught.value.__cause__, RuntimeError)
    assert json.loads((tmp_path / "summary.json").read_text())["stopped"] == message
    rows = len((tmp_path / "history.csv").read_text().splitlines()) - 1
    assert other.seen[-1][2] == rows, "the look at which it failed is complete for the others"
    assert len([*tmp_path.glob("particles_*.vtu")]) == 1 and (tmp_path / "summary.png").exists()
    with np.load(tmp_path / "checkpoint.npz") as kept:
        assert kept["clock_step"] == other.seen[-1][0], "nothing of the run is lost"
    # mended, it goes on: it looks again at the next row, and nobody looks twice at one
    mended, again = Counts(0.25), Counts()
    result = simulate(scene(), out=tmp_path, threads=1, observers=(mended, again), resume=True)
    steps = [step for step, _, _ in again.seen]
    assert result.stopped == "" and steps == sorted(set(steps)) and again.seen[-1][2] == len(result.history)
    assert [fraction for _, fraction, _ in mended.seen] == pytest.approx([0.0, 0.25, 0.5, 0.75, 1.0], abs=2.5 / ROWS)


def test_more_than_a_checkpoint_is_read_back_with_is_no_state(monkeypatch):
    """Else the run could not go on from it."""
    counts = Counts()
    counts.seen = [(k, 0.0, k) for k in range(100)]
    observer_arrays([Watch(counts)])
    monkeypatch.setattr(checkpoint, "MOST_TEXT", 1000)
    with pytest.raises(ObserverError, match=r"observer Counts: state\(\) holds too many numbers"):
        observer_arrays([Watch(counts)])


@pytest.mark.thorough
def test_other_observers_than_those_of_the_checkpoint_are_refused(tmp_path):
    simulate(scene(), out=tmp_path, threads=1, observers=(Counts(),))
    with pytest.raises(SceneError, match="observers is .'Counts'. there and .. here"):
        simulate(scene(), out=tmp_path, threads=1, resume=True)


def test_a_column_that_raises_is_named_and_the_rows_before_it_are_written(tmp_path):
    def value(view) -> float:
        return 1.0 / (0.5 - view.fraction) if view.fraction < 0.5 else 1 // 0

    column = Column(name="mine", unit="1", about="fails in the middle", value=value)
    with pytest.raises(ObserverError, match="history column mine failed: ZeroDivisionError"):
        simulate(scene(), out=tmp_path, threads=1, columns=(column,))
    rows = Path(tmp_path / "history.csv").read_text().splitlines()
    assert 0.4 * ROWS < len(rows) < 0.6 * ROWS + 1 and rows[0].endswith(",mine")


def test_without_a_folder_observers_look_too():
    observer = Counts(0.5)
    simulate(scene(), threads=1, observers=(observer,))
    assert len(observer.seen) == 3 and observer.seen[0] == (0, 0.0, 0)


class Keeps(Observer):
    """Keeps what it must not, or, from its second look on, cannot say what it remembers."""

    every = 0.5

    def __init__(self, state: dict | Exception):
        self.remembered, self.views = state, []

    def see(self, view) -> None:
        self.views.append(view)

    def state(self) -> dict:
        if len(self.views) < 2:
            return {}
        if isinstance(self.remembered, Exception):
            raise self.remembered
        return self.remembered


@pytest.mark.parametrize("state", [ValueError("I forgot"), {"a": object()}])
@pytest.mark.thorough
def test_a_state_that_fails_at_the_end_costs_no_file_and_no_result(state, tmp_path):
    with pytest.raises(ObserverError, match="observer Keeps") as failed:
        simulate(scene(), out=tmp_path, observers=(Keeps(state),), threads=1)
    assert len(failed.value.result.history) >= ROWS
    assert {"history.csv", "events.csv", "summary.json", "summary.png"} <= {path.name for path in tmp_path.iterdir()}


@pytest.mark.thorough
def test_numbers_of_numpy_are_a_state(tmp_path):
    observer = Keeps({"n": np.int64(3)})
    simulate(scene(), out=tmp_path, observers=(observer,), threads=1)
    parts, _ = observer_arrays([Watch(observer)])
    assert len(observer.views) == 3 and parts[0]["own"] == {"n": 3} and type(parts[0]["own"]["n"]) is int


def test_a_view_that_was_kept_shows_no_later_state_as_its_own():
    observer = Keeps({})
    simulate(scene(), observers=(observer,), threads=1)
    first, *_, last = observer.views
    assert first.time < last.time
    with pytest.raises(RuntimeError, match="the run has gone on"):
        _ = first.snapshot


def test_what_is_no_tuple_of_objects_is_refused():
    column = Column(name="a", unit="1", about="one", value=lambda view: 1.0)
    for more, words in (({"columns": column}, "a tuple"), ({"observers": Keeps({})}, "a tuple")):
        with pytest.raises(SceneError, match=words):
            simulate(scene(), **more)
    with pytest.raises(SceneError, match=r"not classes; write Observer\(\)"):
        simulate(scene(), observers=(Observer,))
