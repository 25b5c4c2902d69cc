"""A static start: bodies come to rest before the clock starts, and everything that is counted counts from there."""

import json
import os
import signal
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Affine,
    Apic,
    Body,
    Box,
    BulkViscosity,
    Domain,
    Gravity,
    Hooke,
    Jittered,
    Linear,
    Loading,
    MohrCoulomb,
    NoViscosity,
    Output,
    PicFlip,
    Platen,
    QuadraticBSpline,
    Rock,
    Scene,
    SceneError,
    Schedule,
    Unbreakable,
    UnstableRun,
    Wall,
    simulate,
)
from rsmpm_ti.run import settling

E, NU, DENSITY, GRAVITY, HEIGHT, DX, WIDTH = 17e9, 0.25, 2600.0, 9.81, 10.0, 0.5, 1.0
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity())
BASE = DENSITY * GRAVITY * HEIGHT
SIDES = tuple(Wall(axis=0, side=side, position=at) for side, at in (("lower", 0.0), ("upper", WIDTH)))
FLOOR = Wall(axis=1, side="lower", position=0.0)
STEPS = 40


def column(boundaries=(*SIDES, FLOOR), steps: int = STEPS, top: float = HEIGHT + 2.0 * DX, **changes) -> Scene:
    """A column of rock that weighs; its clock runs for a few steps."""
    loading = {"body_force": (0.0, -GRAVITY), "settle": True} | changes.pop("loading", {})
    body = {"region": Box(lower=(0.0, 0.0), upper=(WIDTH, HEIGHT))} | changes.pop("body", {})
    parts = {"rock": ROCK, "shape": Linear(), "output": Output(frames=0, movie=False, vtu=0)} | changes
    lower = parts.pop("lower", (0.0, 0.0))
    scene = Scene(
        title="column",
        domain=Domain(lower=lower, upper=(WIDTH - lower[0], top), dx=DX),
        bodies=(Body(**body),),
        loading=Loading(boundaries=boundaries, width=WIDTH, **loading),
        schedule=Schedule(t_end=1e-3, rows=STEPS // 10),
        **parts,
    )
    rows = max(1, steps // 10)
    return replace(scene, schedule=replace(scene.schedule, t_end=steps * scene.dt, rows=rows))


KINDS = {
    "musl": {},
    "usf": {"order": "usf"},
    "usl": {"order": "usl", "shape": QuadraticBSpline()},
    "damped": {"transfer": PicFlip(flip=0.9)},
    "affine": {"transfer": Apic()},
    "jittered": {"body": {"seeding": Jittered(amount=0.1, seed=1)}, "shape": QuadraticBSpline()},
    "viscous": {"rock": replace(ROCK, viscosity=BulkViscosity())},
    "scaled": {"loading": {"time_scale": 4.0}},
    "single": {"precision": "f32"},
}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.thorough("affine", "damped", "jittered", "scaled", "single", "usf", "usl", "viscous")
def test_column_rests_under_its_weight_when_the_clock_starts(kind):
    """Stops at maxima leave swings of REST^(1/2) = 1e-4 of the stress."""
    changes = dict(KINDS[kind])
    precision = changes.pop("precision", "f64")
    result = simulate(column(**changes), threads=1, precision=precision)
    history, stress = result.history, result.reactions["b2_wall_y_lower_normal_N"] / WIDTH
    assert stress == pytest.approx(BASE, rel=1e-3)
    assert history["energy_kinetic_J"].max() < 10.0 * settling.REST * history["energy_elastic_J"][0]
    assert np.abs(history["work_J"]).max() < 1e-3 * history["energy_elastic_J"][0], "all of it was done before"
    assert history["energy_dissipated_J"].max() < 1e-6 * history["energy_elastic_J"][0]
    assert history["time_s"][0] == pytest.approx(11 * history["dt_s"][0], rel=1e-6)  # one step, then rows of ten
    lam, mu = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
    depth = HEIGHT - (result.snapshot.x - result.snapshot.displacement)[:, 1]
    sunk = -DENSITY * GRAVITY * (HEIGHT**2 - depth**2) / (2.0 * (lam + 2.0 * mu))
    # displacements stay; cells interpolate a parabola: 1/8 of its bend over a cell at most, DX^2/(4 H^2) of the top's
    # weights of jittered particles err by their spacing, and usf has strained already by what a stop takes from the way
    error = {"jittered": 0.01, "usf": 0.1}.get(kind, 2e-3)
    assert result.snapshot.displacement[:, 1] == pytest.approx(sunk, abs=error * np.abs(sunk).max())


@pytest.mark.thorough
def test_what_presses_at_time_0_presses_and_what_has_a_speed_waits():
    """A force from the side at once; platens from above and below start afterwards, with the affine field.

    sigma_yy between them is nu/(1 - nu) of the side's pressure, and then E/(1 - nu^2) times the strain more.
    """
    side, speed, pressure = 4.0, 2e-3, 1e6
    pressed = (
        Platen(axis=1, side="lower", position=0.0, speed=speed),
        Platen(axis=1, side="upper", position=side, speed=-speed),
        Wall(axis=0, side="lower", position=0.0),
        Platen(axis=0, side="upper", position=side, stress=pressure),
    )
    loading = Loading(boundaries=pressed, width=side, settle=True, start=Affine())
    scene = replace(
        column(), loading=loading, domain=Domain(lower=(0.0, 0.0), upper=(side, side), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(side, side))),),
    )  # fmt: skip
    result = simulate(scene, threads=1)
    rows, history = result.reactions, result.history
    assert rows["b3_platen_x_upper_normal_N"] == pytest.approx(pressure * side, rel=5e-3)
    assert rows["b1_platen_y_upper_displacement_m"] == pytest.approx(-speed * rows["time_s"], rel=1e-9)
    assert history["axial_strain"] == pytest.approx(2.0 * speed / side * history["time_s"], rel=1e-9)
    held, loaded = NU / (1.0 - NU) * pressure, E / (1.0 - NU**2) * history["axial_strain"]
    middle = loaded - 0.5 * np.diff(loaded, prepend=0.0)  # forces are means since the row before
    assert history["stress_top_Pa"] == pytest.approx(held + middle, rel=5e-3)
    # held at a pressure, its side gives way by Poisson's part of the strain from the start on
    rise = -history["lateral_strain"][-1] / history["axial_strain"][-1]
    assert rise == pytest.approx(NU / (1.0 - NU), abs=0.2)
    assert np.abs(history["work_J"][0]) < 2.0 * held * side**2 * history["axial_strain"][0]


def test_instruments_are_set_to_zero_when_the_clock_starts():
    result = simulate(column(loading={"confinement": 2e6}, boundaries=(FLOOR,), lower=(-2.0 * DX, 0.0)), threads=1)
    sinking = BASE * HEIGHT / (2.0 * E)
    assert np.abs(result.snapshot.displacement[:, 1]).max() > 0.5 * sinking
    assert np.abs(result.history["work_J"]).max() < 1e-3 * result.history["energy_elastic_J"][0]
    assert np.abs(result.reactions["b0_wall_y_lower_displacement_m"]).max() == 0.0


@pytest.mark.thorough
def test_a_force_field_waits_at_time_0():
    result = simulate(
        column(loading={"body_force": None, "force_field": Gravity(b=(0.0, -GRAVITY), ramp=1.0)}), threads=1
    )
    assert result.history["energy_elastic_J"][0] < 1e-6 * BASE**2 / E


@pytest.mark.thorough
def test_rock_that_fails_on_the_way_is_said_and_booked_at_time_0():
    weak = replace(ROCK, criterion=MohrCoulomb(cohesion=30e3, friction_angle=10.0, tensile_strength=20e3))
    result = simulate(column(rock=weak), threads=1)
    failed = len(result.events)
    assert failed and (result.events.time == 0.0).all()
    assert [w for w in result.summary["warnings"] if w.startswith(f"{failed} failures while the bodies settled")]
    assert result.history["failed_shear"][0] + result.history["failed_tension"][0] == failed


@pytest.mark.thorough
def test_rock_that_bears_the_load_at_rest_does_not_fail_on_the_way():
    """At its base rho g H presses against nu/(1 - nu) of it: 255 of 307 kPa that it bears. Let go, it sees twice."""
    sound = replace(ROCK, criterion=MohrCoulomb(cohesion=78e3, friction_angle=10.0, tensile_strength=4e5))
    assert BASE < sound.criterion.strength(NU / (1.0 - NU) * BASE) < 1.5 * BASE
    assert len(simulate(column(rock=sound), threads=1).events) == 0
    assert len(simulate(column(rock=sound, loading={"settle": False}, steps=120), threads=1).events) > 0


@pytest.mark.thorough
def test_a_body_that_nothing_holds_does_not_come_to_rest(tmp_path):
    with pytest.raises(UnstableRun, match=r"did not come to rest in \d+ steps of loading.settle|left the domain"):
        simulate(column(boundaries=SIDES), threads=1, out=tmp_path)
    assert not (tmp_path / "checkpoint.npz").exists()


@pytest.mark.parametrize("motion", [{"velocity": (0.0, 1.0)}, {"spin": 1.0}])
def test_bodies_that_move_cannot_come_to_rest_first(motion):
    with pytest.raises(SceneError, match="loading.settle = True is refused"):
        column(body=motion)


@pytest.mark.thorough
def test_it_goes_on_from_a_checkpoint_to_the_same_numbers(tmp_path):
    whole = simulate(column(steps=80), threads=1)

    def stop(progress) -> None:
        if progress.fraction > 0.4:
            os.kill(os.getpid(), signal.SIGINT)

    assert simulate(column(steps=80), threads=1, out=tmp_path, progress=stop).stopped
    result = simulate(column(steps=80), threads=1, out=tmp_path, resume=True)
    assert len(result.history) == 8
    assert np.array_equal(result.reactions, whole.reactions)
    assert all(np.array_equal(result.history[n], whole.history[n], equal_nan=True) for n in whole.history.dtype.names)


@pytest.mark.thorough
def test_stopped_meanwhile_it_leaves_no_checkpoint_of_a_start_that_is_none(tmp_path, monkeypatch):
    relax = settling._relax

    def stopped(drive, interrupt, transit):
        interrupt.signal = signal.SIGINT
        return relax(drive, interrupt, transit)

    with monkeypatch.context() as patch:
        patch.setattr(settling, "_relax", stopped)
        result = simulate(column(), threads=1, out=tmp_path)
    assert result.stopped.startswith("interrupted after step 0") and not (tmp_path / "checkpoint.npz").exists()
    assert json.loads((tmp_path / "summary.json").read_text())["stopped"] == result.stopped
    again = simulate(column(), threads=1, out=tmp_path, resume=True)
    assert len(again.history) == STEPS // 10
