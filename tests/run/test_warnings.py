"""What a run warns of, in sentences: each where it is due, and not where it is not."""

from dataclasses import replace

import numpy as np
import pytest
from small_scene import make

from rsmpm_ti import load_scene
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.run.warnings import kinetic_share_after, warnings_of
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Disc
from rsmpm_ti.spec.scene import Body

QUIET = {
    "platen_imbalance": 0.001, "kinetic_share_after": None, "first_failure_time_s": None,
    "peak_filtered_strain": None, "numerical_fracture": None, "peak_filtered_Pa": None,
    "largest_stress_Pa": None,
}  # fmt: skip


def curve(kinetic: list[float]) -> np.ndarray:
    names = ("time_s", "axial_strain", "energy_kinetic_J", "energy_elastic_J")
    rows = [(float(k), 1e-3 * k, value, min(k, 2.0)) for k, value in enumerate(kinetic)]
    return np.array(rows, dtype=[(name, float) for name in names])


def failed_at(*x: float, time: float = 0.0) -> EventTable:
    one = np.zeros(1)
    empty = {name: one for name in EventTable.__dataclass_fields__}
    return EventTable(**empty | {"time": one + time, "x": np.array([x])})


NOTHING = EventTable(**{name: np.zeros(0) for name in EventTable.__dataclass_fields__})
HISTORY = curve([0.0, 0.01])


def sentences(scene=None, numbers=QUIET, history=HISTORY, events=NOTHING) -> list[str]:
    return warnings_of(scene or make(), numbers, history, events)


def test_sound_test_warns_of_nothing():
    assert sentences() == [] and sentences(events=failed_at(0.025, 0.05)) == []


def test_forces_without_a_width_are_no_load():
    platens = make().loading.boundaries
    still = tuple(replace(platen, speed=0.0) for platen in platens)
    timed = {"schedule_strain_end": None, "schedule_t_end": 1e-4, "loading_start": AtRest()}
    (said,) = sentences(make(loading_boundaries=still, loading_width=None, **timed))
    assert said.startswith("loading.width is missing") and "no load curve" in said


def test_platens_at_full_speed_on_a_body_at_rest():
    scene = make(loading_start=AtRest())
    (said,) = sentences(scene)
    wave = scene.density * scene.wave_speed * 2.5e-3 / 1e6  # rho c v
    assert said.startswith("platens move at full speed") and f"{wave:.3g} MPa" in said
    body = replace(scene.bodies[0], velocity=(0.0, -1.0))
    assert sentences(replace(scene, bodies=(body,))) == [], "an impact is meant"
    still = tuple(replace(platen, speed=0.0) for platen in scene.loading.boundaries)
    scene = make(loading_boundaries=still, loading_start=AtRest(), schedule={"t_end": 1e-5})
    assert sentences(scene) == []


def test_imbalance_and_numerical_fracture_and_what_has_no_imbalance():
    assert "platen imbalance 2 %" in sentences(numbers=QUIET | {"platen_imbalance": 0.02})[0]
    assert sentences(numbers=QUIET | {"platen_imbalance": None}) == []
    assert sentences(numbers=QUIET | {"numerical_fracture": "parted"}) == ["parted"]


def test_two_peaks_that_differ_are_said():
    peaks = QUIET | {"peak_filtered_Pa": 153e6, "largest_stress_Pa": 160e6}
    (said,) = sentences(numbers=peaks)
    assert "153 MPa, is 4.4 % below that of one row, 160 MPa: the strength lies between" in said
    assert sentences(numbers=peaks | {"peak_filtered_Pa": 159e6}) == []


def test_motion_after_failure_is_held_against_what_was_stored():
    history = curve([0.0, 0.9, 0.01, 0.05, 0.3, 0.4, 0.2])
    assert kinetic_share_after(history, 2.5) == pytest.approx(0.2) and kinetic_share_after(history, None) is None
    assert kinetic_share_after(history, 99.0) is None
    numbers = QUIET | {"kinetic_share_after": 0.2, "first_failure_time_s": 2.5, "peak_filtered_strain": 3e-3}
    (said,) = sentences(numbers=numbers, history=history)
    assert "reaches 20 %" in said and "from a strain of 0.004 on, after the peak" in said
    assert "before the peak" in sentences(numbers=numbers | {"peak_filtered_strain": 5e-3}, history=history)[0]
    assert sentences(numbers=numbers | {"kinetic_share_after": 0.01}, history=history) == []


@pytest.mark.parametrize(
    "y, time, near",
    [(0.7e-3, 0.0, True), (0.8e-3, 0.0, False), (0.0994, 0.0, True), (0.0992, 0.0, False), (0.8e-3, 0.1, True)],
)
def test_first_failure_within_a_cell_and_a_half_of_a_platen_where_it_is_then(y, time, near):
    """dx is 0.5 mm, so up to 0.75 mm; after 0.1 s at 2.5 mm/s a platen is 0.25 mm farther."""
    said = sentences(events=failed_at(0.025, y, time=time))
    assert bool(said) is near and all("cells from the platen" in sentence for sentence in said)


@pytest.mark.parametrize(
    "x, y, beside",
    [(50.0, 50.0, False), (50.0, 66.0, False), (50.0, 67.0, True), (68.0, 50.0, True), (50.0, 20.0, True)],
)
def test_disc_that_does_not_break_from_its_middle(x, y, beside):
    scene = load_scene("disc", quick=True)
    disc = Disc(centre=(0.05, 0.05), radius=0.05)
    scene = replace(scene, bodies=(Body(region=disc),))
    said = sentences(scene, events=failed_at(1e-3 * x, 1e-3 * y))
    assert bool(said) is beside and all("neither its load nor the peak is a strength" in sentence for sentence in said)
    assert sentences(load_scene("disc", quick=True), events=failed_at(0.05, 0.02)) == [], "a flaw says where it breaks"
