"""A servo slows the platens while rock breaks: by its rule, by the rows of a run, and by what a user can give."""

from dataclasses import replace

import numpy as np
import pytest
from small_scene import make, platens, refusal

from rsmpm_ti import Gravity, Output, Servo, load_scene, simulate
from rsmpm_ti.scene import main
from rsmpm_ti.spec.quasi_static.servo import AUTO_DAMPING, FASTER, SLOWER

QUIET = Output(frames=0, movie=False, vtu=0)
COARSE = {"dx": 2e-3, "flaw_width": 6e-3, "length": 4e-3, "servo": False}


def slow(**changes):
    """`cube_lab` in cells of 2 mm, without pictures."""
    scene = load_scene("cube_lab", **COARSE)
    loading = replace(scene.loading, servo=Servo(activity=2e-3, slowest=0.1), **changes)
    return replace(scene, loading=loading, output=QUIET)


def test_pace_falls_while_rock_breaks_and_rises_when_it_is_quiet():
    servo = Servo(activity=1e-3, slowest=0.1)
    assert servo.next(1.0, 2e-3, 1.0, 0.5) == pytest.approx(SLOWER**0.5)
    assert servo.next(0.2, 0.9e-3, 1.0, 0.5) == 0.2, "between the two it stays"
    assert servo.next(0.2, 0.0, 1.0, 0.5) == pytest.approx(0.2 * FASTER**0.5)
    assert servo.next(0.9, 0.0, 1.0, 10.0) == 1.0 and servo.next(0.2, 1.0, 1.0, 10.0) == 0.1
    assert servo.next(0.2, 1.0, 0.0, 0.5) > 0.2, "a specimen that holds nothing can give nothing"


@pytest.mark.thorough
def test_rows_are_equal_in_strain_and_time_goes_on():
    scene = slow()
    result = simulate(scene, threads=1)
    strain, time = result.history["axial_strain"], result.history["time_s"]
    rows = np.diff(strain)[1:-1]
    # a row is so many steps at full speed; the platens' way is summed up step by step
    np.testing.assert_allclose(rows, scene.loading.strain_rate * scene.row_steps * scene.dt, rtol=1e-6)
    assert strain[-1] == pytest.approx(scene.schedule.strain_end, rel=2e-3)
    pace = rows / (scene.loading.strain_rate * np.diff(time)[1:-1])
    peak = int(np.argmax(result.history["energy_elastic_J"]))
    assert pace[: peak // 2].min() > 0.99, "nothing slows whole rock"
    assert pace.min() < 0.12 and result.summary["least_pace"] == pytest.approx(0.1)
    assert result.summary["steps"] > scene.steps


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: make(loading_servo=Servo(), loading_boundaries=()), "two ends"),
        (lambda: make(loading_servo=Servo(), loading_boundaries=platens(speed=2.5e-3)), "two ends"),
        (lambda: make(loading_servo=Servo(), schedule={"t_end": 1e-5, "adaptive": True}), "adaptive"),
        (lambda: make(loading_servo=Servo(), loading_force_field=Gravity(b=(0.0, -1.0), ramp=1e-4)), "force_field"),
        (lambda: Servo(activity=0.5), "servo.activity"),
        (lambda: Servo(slowest=0.0), "servo.slowest"),
    ],
)
def test_what_a_servo_cannot_do_is_refused(build, said):
    assert said in refusal(build)


def test_auto_holds_while_rock_breaks():
    """It is found for the first failure; beyond it a servo keeps it, unless nothing can break."""
    scene = load_scene("intact", time_scale="auto")
    assert scene.servo == Servo() and scene.elastic().servo is None
    assert scene.local_damping == AUTO_DAMPING and scene.elastic().local_damping == 0.0
    plain = load_scene("intact", time_scale=10.0)
    assert plain.servo is None and plain.local_damping == 0.0
    given = replace(scene, loading=replace(scene.loading, servo=Servo(slowest=1.0), local_damping=0.0))
    assert given.servo.slowest == 1.0 and given.local_damping == 0.0


def test_scene_whose_peak_depends_on_the_speed_has_a_servo():
    assert load_scene("cube_lab").servo == Servo() and load_scene("cube_lab", quick=True).servo is None


@pytest.mark.thorough
def test_slower_platens_are_a_smaller_time_scale():
    """What the servo rests on: equations of rock hold with t -> 2 t: half the speeds, four times the density."""
    fast = load_scene("cube_lab", **COARSE, time_scale=16.0)
    slow = load_scene("cube_lab", **COARSE, time_scale=32.0)
    halved = tuple(replace(platen, speed=0.5 * platen.speed) for platen in slow.loading.boundaries)
    slow = replace(slow, loading=replace(slow.loading, boundaries=halved))
    runs = [simulate(replace(scene, output=QUIET), threads=1).history for scene in (fast, slow)]
    for name in ("axial_strain", "force_top_N", "energy_elastic_J", "energy_dissipated_J", "failed_shear"):
        # powers of two: the same numbers but for round-off, which a run that breaks multiplies
        np.testing.assert_allclose(runs[1][name], runs[0][name], rtol=1e-6, atol=1e-6 * np.abs(runs[0][name]).max())


def test_check_says_that_steps_become_more(capsys):
    assert main(["intact", "--check", "--set", "time_scale=auto"]) == 0
    assert "at full speed; more, since a servo" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("setting", "said"),
    [
        ("loading.servo.slowest=0.2", "loading.servo is none; give it first: Servo"),
        ("loading.initial_stress.K0=2", "loading.initial_stress is none; give it first: InSitu"),
    ],
)
def test_a_field_of_what_is_not_there_says_what_to_give(capsys, setting, said):
    assert main(["cube_lab", "--quick", "--check", "--set", setting]) == 2
    assert said in capsys.readouterr().err
