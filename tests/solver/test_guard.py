"""What the guard stops: energy from nowhere, against what it is held, and numbers that mean nothing any more."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
import taichi as ti

from rsmpm_ti.errors import BrokenApart, UnstableRun
from rsmpm_ti.hardcases.pieces import scene_of
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.guard import CREATED_FRACTION, EnergyBooks, guard
from rsmpm_ti.solver.history import History
from rsmpm_ti.solver.survey import Survey, survey


def energies(kinetic: float = 0.0, elastic: float = 0.0, dissipated: float = 0.0, work: float = 0.0) -> Survey:
    empty = dict.fromkeys(Survey.__dataclass_fields__, 0)
    return Survey(**empty | {"kinetic": kinetic, "elastic": elastic, "dissipated": dissipated, "work": work})


def books_after(*rows: Survey) -> EnergyBooks:
    books = EnergyBooks(start=0.0, quiet=0.0)
    for row in rows:
        books = books.after(row)
    return books


def test_unloading_is_sound_with_the_error_of_what_was_loaded():
    """10 J in, 10.1 J out: an error of 1 % of what was held, and all of what is there."""
    loaded, unloaded = energies(elastic=10.0, work=10.0), energies(elastic=1e-4, work=-0.1)
    assert books_after(loaded, unloaded).sound
    assert not books_after(unloaded).sound, "the same without what came before"


def test_error_of_many_cycles_is_held_against_all_that_passed_through():
    rows = [energies(elastic=10.0 * (k % 2), work=10.0 * (k % 2) - 0.1 * k) for k in range(200)]
    books = books_after(*rows)
    assert books.most < 11.0 and books.created > books.most and books.sound


@pytest.mark.parametrize("energy, sound", [(1.0 / (1.0 - CREATED_FRACTION) - 1e-6, True), (2.1, False), (1e6, False)])
def test_energy_that_grows_without_work_is_found(energy, sound):
    books = EnergyBooks(start=1.0, quiet=0.0).after(energies(kinetic=1.0)).after(energies(kinetic=energy))
    assert books.sound is sound


def test_number_that_is_none_is_not_sound():
    assert not books_after(energies(kinetic=np.nan)).sound


def test_history_that_resumes_holds_errors_against_what_the_run_held_before(taichi_f64):
    drive = Drive(scene_of((9, 9), (2, 2), (7, 7)), scene_of((9, 9), (2, 2), (7, 7)).particles(), ti.f64)
    history, quiet = History(drive.sim, drive.clock, drive.survey), replace(drive.survey, work=0.0)
    history.record(replace(drive.survey, elastic=10.0, work=10.0))
    other = History(drive.sim, drive.clock, drive.survey)
    with pytest.raises(UnstableRun, match="1 J, 100 % of the energy that the run has held, came from nowhere"):
        other.record(replace(quiet, work=-1.0))
    other.resume(history.state())
    other.record(replace(quiet, work=-1.0))
    assert other.books.most == 10.0 and other.books.exchanged == 21.0


def health(**changes) -> Survey:
    """Of particles that are well but for what changes."""
    well = {"J_min": 1.0, "J_max": 1.0, "J_intact": 1.0, "J_intact_min": 1.0}
    return replace(energies(), **well | changes)


@pytest.mark.parametrize(
    "changes, broken_apart",
    [
        ({"J_min": 0.01}, True),
        ({"J_max": 30.0}, True),
        ({"J_max": 30.0, "J_intact": 0.0, "J_intact_min": 1e30}, True),
        ({"J_min": 0.01, "J_intact_min": 0.01}, False),
        ({"J_max": 30.0, "J_intact": 30.0}, False),
    ],
    ids=["failed rock collapsed", "failed rock gapes", "all has failed", "intact collapsed", "intact gapes"],
)
def test_guard_tells_rock_that_has_broken_apart_from_intact_rock_that_went_wild(changes, broken_apart):
    sim = SimpleNamespace(events=SimpleNamespace(capacity=1))
    with pytest.raises(UnstableRun, match="a particle has J") as stopped:
        guard(sim, SimpleNamespace(step=1, time=1.0), health(**changes))
    assert isinstance(stopped.value, BrokenApart) is broken_apart


@pytest.mark.parametrize("broken", ["flown", "not a number"])
def test_guard_tells_a_piece_that_left_the_domain_from_a_value_that_is_none(taichi_f64, broken):
    scene = scene_of((9, 9), (2, 2), (7, 7))
    drive = Drive(scene, scene.particles(), ti.f64)
    field = drive.sim.particles.u if broken == "flown" else drive.sim.particles.v
    field[0] = (1.0, 0.0) if broken == "flown" else (float("nan"), 0.0)
    found = survey(drive.sim)
    assert (found.sick, found.not_finite) == (1, int(broken != "flown"))
    with pytest.raises(UnstableRun, match="left the domain") as stopped:
        guard(drive.sim, drive.clock, found)
    assert isinstance(stopped.value, BrokenApart) is (broken == "flown")
