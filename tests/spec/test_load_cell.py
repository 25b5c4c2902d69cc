"""What a test measures: the sides of the load cell, its nominal stress, and gauges."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from small_scene import make, refusal

from rsmpm_ti.errors import SceneError
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.history import History
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.load_cell import Gauge, LoadCell
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.scene import Loading
from rsmpm_ti.spec.scene_json import from_plain, to_plain


def plate(side: str, position: float, axis: int = 1, **more) -> Platen:
    return Platen(axis=axis, side=side, position=position, speed=0.0, **more)


SUPPORTS = (
    plate("lower", 0.0, span=(0.0, 0.01)),
    plate("upper", 0.1),
    plate("lower", 0.0, span=(0.04, 0.05)),
    plate("lower", 0.0, axis=0),
    Wall(axis=1, side="upper", position=0.1),
)


def test_every_platen_of_a_side_counts_and_nothing_else():
    cell = Loading(boundaries=SUPPORTS, width=0.05).load_cell
    assert (cell.axis, cell.lower, cell.upper, cell.width) == (1, (0, 2), (1,), 0.05)
    alone = Loading(boundaries=(SUPPORTS[0], SUPPORTS[3])).load_cell
    assert (alone.axis, alone.lower, alone.upper) == (1, (0,), ()), "without a pair, the first platen's axis"
    assert Loading(boundaries=SUPPORTS[4:]).load_cell is None


def test_nominal_stress_is_the_sides_force_over_the_width_and_the_confining_pressure():
    cell = Loading(boundaries=SUPPORTS, width=0.05).load_cell
    forces = np.array([[9.0, 30.0], [9.0, -100.0], [9.0, 70.0], [5.0, 0.0], [0.0, -7.0]])
    load = cell.read(forces, confinement=1e3)
    assert (load.force_lower, load.force_upper) == (100.0, 100.0)
    assert (load.stress_lower, load.stress_upper, load.stress) == (3e3, 3e3, 3e3)


def test_a_cell_of_ones_own_reads_what_it_says():
    cell = LoadCell(axis=1, lower=(), upper=(1, 4), width=2.0)
    load = Loading(boundaries=SUPPORTS, width=0.05, cell=cell).load_cell.read(np.full((5, 2), -4.0))
    assert (load.force_upper, load.stress_upper) == (8.0, 4.0)
    assert np.isnan(load.force_lower) and load.stress == 4.0, "the side that is read"
    assert Loading(boundaries=SUPPORTS, width=0.05, cell=LoadCell(width=0.1)).load_cell.width == 0.1


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        (LoadCell(axis=2), "cell.axis = 2 is refused"),
        (LoadCell(lower=(1,)), r"cell.lower = \(1,\) is refused: it must be indices of .* with axis = 1"),
        (LoadCell(upper=(7,)), "cell.upper"),
        (LoadCell(gauges=(Gauge(name="g", a=(0.0, 0.0, 0.0), b=(0.0, 0.1, 0.0)),)), "gauge.a"),
        (LoadCell(gauges=(Gauge(name="g", a=(0.01, 0.0), b=(0.053, 0.1)),)), "gauge.b .* 'g' hangs in the air"),
        (LoadCell(gauges=(Gauge(name="g", a=(0.01, 0.01), b=(0.01, 0.0101)),)), "gauge.b .* the same particle"),
    ],
)  # fmt: skip
def test_a_cell_that_does_not_fit_its_scene_is_refused(cell, words):

    assert re.search(words, refusal(lambda: make(loading_cell=cell)))


def test_an_axis_alone_takes_its_platens_whether_they_face_each_other_or_not():
    one = Loading(boundaries=(plate("upper", 0.1),), width=0.05, cell=LoadCell(axis=1)).load_cell
    assert (one.lower, one.upper) == ((), (0,)) and one.read(np.full((1, 2), -4.0)).stress == pytest.approx(80.0)
    sides = (*SUPPORTS, plate("lower", 0.0, axis=0), plate("upper", 0.05, axis=0))
    cell = Loading(boundaries=sides, width=0.05, cell=LoadCell(axis=0)).load_cell
    assert cell.lower[-1] == len(SUPPORTS) and cell.upper == (len(SUPPORTS) + 1,)
    assert all(sides[k].axis == 0 and sides[k].side == "lower" for k in cell.lower)
    assert "an axis along which platens press" in refusal(lambda: make(loading_cell=LoadCell(axis=0)))


def test_a_gauge_may_begin_at_a_corner_of_the_specimen():
    make(loading_cell=LoadCell(gauges=(Gauge(name="g", a=(0.0, 0.0), b=(0.0, 0.04)),)))


def test_a_cell_without_an_axis_is_refused():
    still = {"loading_boundaries": (), "loading_start": AtRest(), "schedule_strain_end": None, "schedule_t_end": 1e-4}
    assert "cell.axis" in refusal(lambda: make(**still, loading_cell=LoadCell(lower=(0,))))


@pytest.mark.parametrize("change", [{"name": "Crack mouth"}, {"a": (0.0,)}, {"b": (0.0, 1.0, 2.0)}, {"reads": "load"}])
def test_a_gauge_that_is_none_is_refused(change):
    good = {"name": "g", "a": (0.0, 0.0), "b": (0.0, 1.0)}
    with pytest.raises(SceneError, match=f"gauge.{next(iter(change))}"):
        Gauge(**good | change)
    gauge = Gauge(**good)
    with pytest.raises(SceneError, match="cell.gauges"):
        LoadCell(gauges=(gauge, gauge))


def test_scenes_recorded_without_a_cell_still_load_and_gauges_survive_the_record():
    scene = make(loading_cell=LoadCell(gauges=(Gauge(name="g", a=(0.01, 0.01), b=(0.01, 0.09)),)))
    assert from_plain(json.loads(json.dumps(to_plain(scene)))) == scene
    old = to_plain(make())
    del old["loading"]["cell"]
    assert from_plain(old) == make()


def test_gauges_follow_uniform_straining_and_a_rotation_leaves_them_alone(taichi_f64):
    """The field is moved by hand: a gauge's own length is that of its two particles, so it is exact."""
    strip = Gauge(name="along", a=(0.025, 0.02), b=(0.025, 0.08))
    clip = Gauge(name="across", a=(0.01, 0.05), b=(0.04, 0.05), reads="opening")
    scene = make(domain_dx=5e-3, loading_cell=LoadCell(gauges=(strip, clip)))
    drive = Drive(scene, scene.particles(), ti.f64)
    history, particles = History(drive.sim, drive.clock, drive.survey), drive.sim.particles
    X = particles.reference.to_numpy()

    def read(gradient) -> tuple[float, float]:
        particles.u.from_numpy(X @ np.array(gradient).T)
        history.record(drive.survey)
        row = history.table()[-1]
        return row["gauge_along"], row["gauge_across_m"]

    along, across = read([[1e-4, 0.0], [0.0, -2e-4]])
    assert along == pytest.approx(-2e-4, rel=1e-9)
    assert across == pytest.approx(1e-4 * 0.03, rel=1e-9)
    turn = np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    assert np.abs(read(turn - np.eye(2))).max() < 1e-14
    drive.sim.particles.volume.fill(0.0)  # as dropped particles have it
    assert np.isnan(read(np.zeros((2, 2)))).all()


def test_history_reads_both_supports(taichi_f64):
    """A block between a plate and two half plates: impulses put in by hand come out as one reaction."""
    upper = plate("upper", 0.1)
    halves = (plate("lower", 0.0, span=(0.0, 0.025)), plate("lower", 0.0, span=(0.0251, 0.05)), upper)
    scene = make(
        domain_dx=5e-3, loading_boundaries=halves, loading_start=AtRest(), schedule_strain_end=None,
        schedule_t_end=1e-5,
    )  # fmt: skip
    drive = Drive(scene, scene.particles(), ti.f64)
    history = History(drive.sim, drive.clock, drive.survey)
    drive.advance(2)
    impulse = np.array([[0.0, 3.0], [0.0, 4.0], [0.0, -7.0]])
    history.record(replace(drive.survey, impulse=impulse))
    row, time = history.table()[-1], drive.clock.time
    assert row["force_bottom_N"] == pytest.approx(7.0 / time) and row["force_top_N"] == pytest.approx(7.0 / time)
    assert row["stress_bottom_Pa"] == pytest.approx(7.0 / time / 0.05)
