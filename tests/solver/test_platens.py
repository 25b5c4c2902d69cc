"""Platens in a run: moved by a force or by a table, on two axes at once, and what they cannot be."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Affine,
    Body,
    Box,
    BulkViscosity,
    Domain,
    Fixed,
    Hooke,
    Loading,
    MohrCoulomb,
    Platen,
    Program,
    Ramp,
    Rock,
    Scene,
    SceneError,
    Schedule,
    Unbreakable,
    Wall,
    simulate,
)
from rsmpm_ti.analysis.load_curve import filter_rows, loading_curve
from rsmpm_ti.output.pictures import load_limits

E, NU, DENSITY, DX, SIDE = 17e9, 0.14, 2600.0, 2e-3, 20e-3
MODULUS = E / (1.0 - NU**2)
TRANSIT = SIDE / math.sqrt(MODULUS / DENSITY)


def block(boundaries, schedule: Schedule, **loading) -> Scene:
    """A square block that its boundaries touch, with three empty cells around it where there are none."""
    free = tuple(0.0 if d in {b.axis for b in boundaries} else 3.0 * DX for d in range(2))
    return Scene(
        title="block",
        domain=Domain(lower=tuple(-f for f in free), upper=tuple(SIDE + f for f in free), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(SIDE, SIDE))),),
        rock=Rock(
            density=DENSITY,
            elasticity=Hooke(E=E, nu=NU),
            criterion=Unbreakable(),
            viscosity=BulkViscosity(),
        ),
        loading=Loading(boundaries=boundaries, width=SIDE, **loading),
        schedule=schedule,
    )


def pair(axis: int = 1, **upper) -> tuple[Platen, Platen]:
    return Platen(axis=axis, side="lower", position=0.0), Platen(axis=axis, side="upper", position=SIDE, **upper)


@pytest.mark.parametrize(
    ("axis", "held", "confinement"),
    [(1, {"stress": 10e6}, 0.0), (0, {"force": 10e6 * SIDE}, 0.0), (1, {"stress": 10e6}, 20e6)],
)
def test_a_platen_that_a_force_moves_makes_the_stress_and_strain_of_the_force(axis, held, confinement):
    """Pressed during forty transits and held for forty: what still swings is 2 % and has no mean."""
    program = Program(times=(40.0 * TRANSIT,), factors=(1.0,))
    scene = block(pair(axis, **held), Schedule(t_end=80.0 * TRANSIT), start=program, confinement=confinement)
    middle, stress, strain = loading_curve(simulate(scene, threads=1).history)
    holding = middle > 50.0 * TRANSIT
    assert stress[holding].mean() - confinement == pytest.approx(10e6, rel=2e-3)
    assert strain[holding].mean() == pytest.approx(10e6 / MODULUS, rel=2e-3)
    assert np.interp(20.0 * TRANSIT, middle, stress) - confinement == pytest.approx(5e6, rel=0.05)


def test_strain_and_load_of_a_platen_against_a_wall_are_those_of_two_platens():
    """Whatever is at rest and faces it; and the pictures' axes hold the curve."""
    program = Program(times=(40.0 * TRANSIT,), factors=(1.0,))
    wall, (_, upper) = Wall(axis=1, side="lower", position=0.0), pair(stress=10e6)
    scene = block((wall, upper), Schedule(t_end=80.0 * TRANSIT), start=program)
    history = simulate(scene, threads=1).history
    middle, stress, strain = loading_curve(history)
    holding = middle > 50.0 * TRANSIT
    assert stress[holding].mean() == pytest.approx(10e6, rel=2e-3)
    assert strain[holding].mean() == pytest.approx(10e6 / MODULUS, rel=2e-3)
    both = block(pair(stress=10e6), Schedule(t_end=80.0 * TRANSIT), start=program)
    every = Schedule(t_end=80.0 * TRANSIT, rows=100_000)
    assert filter_rows(replace(scene, schedule=every)) == filter_rows(replace(both, schedule=every)) > 3
    limits = load_limits(scene, SIDE**2)
    assert limits == load_limits(both, SIDE**2) and limits[0] > strain.max() and limits[1] > stress.max()
    clamp = Fixed(axis=1, side="lower", position=0.0)
    assert Loading(boundaries=(clamp, upper)).ends == (clamp, upper)
    assert Loading(boundaries=(wall, clamp, *pair())).ends == pair(), "two platens come first"
    assert Loading(boundaries=(wall,)).ends is None and Loading(boundaries=(upper,)).ends is None


def test_a_table_loads_holds_and_unloads():
    program = Program(times=(1.0, 2.0, 4.0), factors=(1.0, 1.0, -0.5))
    assert [program.factor(t) for t in (0.0, 0.25, 1.0, 1.7, 3.0, 4.0, 9.0)] == [0.0, 0.25, 1.0, 1.0, 0.25, -0.5, -0.5]


@pytest.mark.thorough
def test_platens_on_two_axes_strain_uniformly():
    """Equal squeeze of both: sigma = (lambda + mu) 2 ln(1 - strain), in plane strain, the same in every particle."""
    strain, speed = 0.01, 0.2
    platens = tuple(
        Platen(axis=axis, side=side, position=at, speed=v)
        for axis in (0, 1)
        for side, at, v in (("lower", 0.0, speed), ("upper", SIDE, -speed))
    )
    scene = block(platens, Schedule(strain_end=strain), start=Affine())
    sigma = simulate(scene, threads=1).snapshot.sigma
    lam, mu = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
    expected = 2.0 * (lam + mu) * math.log1p(-strain)
    # the start is uniform along the first axis alone, so that the other begins with a shock of rho c v/2
    shock = DENSITY * math.sqrt(MODULUS / DENSITY) * speed / 2.0
    assert np.abs(sigma[:, (0, 1), (0, 1)] - expected).max() < 3.0 * shock
    assert sigma[:, (0, 1), (0, 1)].mean() == pytest.approx(expected, rel=2e-3)


LOW, HIGH = pair(speed=-0.1)
STEP = Schedule(t_end=1e-5)


@pytest.mark.parametrize(
    ("boundaries", "field"),
    [
        ((LOW, HIGH, replace(HIGH, speed=-0.2, span=(0.0, 0.01))), r"boundaries\[2\]\.speed = -0\.2"),
        ((LOW, HIGH, replace(HIGH, position=SIDE - DX)), r"boundaries\[2\]\.position = 0\.018"),
        ((LOW, replace(HIGH, speed=0.1)), r"boundaries\[\d\]\.speed = \S+ is refused: it must be towards"),
        ((LOW, replace(HIGH, speed=0.0, force=1e3), replace(HIGH, speed=0.0)), r"boundaries\[2\] = "),
    ],
)
def test_what_the_grid_cannot_follow_is_refused(boundaries, field):
    with pytest.raises(SceneError, match=field):
        block(boundaries, STEP)


@pytest.mark.parametrize("more", [{"force": 1.0}, {"stress": 1.0}])
def test_a_platen_has_one_motion(more):
    with pytest.raises(SceneError, match="a platen has a speed, a force or a stress"):
        replace(HIGH, **more)


def test_a_force_that_pulls_needs_a_platen_that_can():
    with pytest.raises(SceneError, match=r"platen\.force = -1\.0"):
        replace(HIGH, speed=0.0, force=-1.0)
    assert replace(HIGH, speed=0.0, force=-1.0, pulls=True).held


def test_how_far_a_force_goes_is_no_end():
    with pytest.raises(SceneError, match="give t_end"):
        block(pair(force=1e3), Schedule(strain_end=0.1))


def test_a_platen_alone_that_a_force_moves_takes_the_block_along():
    """With F/(m + m_platen), and stress that falls linearly from F/A at the platen to none at the free end."""
    platen, rise, end = Platen(axis=1, side="upper", position=SIDE, stress=5e6), 10.0 * TRANSIT, 60.0 * TRANSIT
    scene = block((platen,), Schedule(t_end=end), start=Program(times=(rise,), factors=(1.0,)))
    scene = replace(scene, domain=replace(scene.domain, lower=(-3.0 * DX, -20.0 * DX)))
    result = simulate(scene, threads=1)
    mass = DENSITY * SIDE * (SIDE + 2.0 * DX)
    # of a force that rises by a ramp: a (t^2/2 - t r/2 + r^2/6)
    way = 5e6 * SIDE / mass * (0.5 * end**2 - 0.5 * end * rise + rise**2 / 6.0)
    assert -result.snapshot.displacement[:, 1].mean() == pytest.approx(way, rel=0.01)  # steps are whole
    along, sigma = result.snapshot.x[:, 1] - result.snapshot.x[:, 1].min(), result.snapshot.sigma[:, 1, 1]
    linear = -5e6 * DENSITY * SIDE * (along + 0.25 * DX) / mass
    assert np.abs(sigma - linear).max() < 0.1 * 5e6, "the waves of the rise: a tenth of it and less"


@pytest.mark.parametrize("width", [0.01 * SIDE, SIDE])
def test_the_width_of_the_nominal_stress_decides_nothing_but_itself(width):
    program = Program(times=(20.0 * TRANSIT,), factors=(1.0,))
    scene = block(pair(force=10e6 * SIDE), Schedule(t_end=60.0 * TRANSIT), start=program)
    scene = replace(scene, loading=replace(scene.loading, width=width))
    force = simulate(scene, threads=1).history["force_top_N"]
    assert force[len(force) // 2 :].mean() == pytest.approx(10e6 * SIDE, rel=5e-3)


def test_a_specimen_that_gives_way_under_a_force_is_the_runs_end_and_a_result():
    rock = Rock(
        density=DENSITY,
        elasticity=Hooke(E=E, nu=NU),
        criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
    )
    scene = block(pair(stress=40e6), Schedule(t_end=200.0 * TRANSIT), start=Ramp(time=60.0 * TRANSIT))
    result = simulate(replace(scene, rock=rock), threads=1)
    assert result.stopped.startswith("stopped: a platen that a force moves has come 10 % closer")
    assert result.summary["first_failure_stress_Pa"] == pytest.approx(25.52e6, rel=0.03)  # a fast test: rho c v


def test_platens_that_would_meet_are_refused_with_the_time():
    with pytest.raises(SceneError, match=r"schedule\.t_end = .*must be less than 0\.00180\d s: there the platens"):
        block(pair(speed=-10.0), Schedule(t_end=3e-3), start=Affine())
    apart = Program(times=(1e-4, 3e-3), factors=(1.0, -3.0))
    block(pair(speed=-10.0, pulls=True), Schedule(t_end=2e-3), start=apart)  # close in by 2.5 %, then go apart


@pytest.mark.thorough
def test_a_platen_from_afar_meets_rock_where_it_is_though_its_grid_has_shrunk():
    """Twelve cells of gap beside ten of rock: the grid is half as fine again when it arrives."""
    gap, speed = 12.0 * DX, 20.0
    arrives = gap / speed
    scene = block(pair(), Schedule(t_end=1.05 * arrives, cfl=0.3, rows=2000))
    lower, upper = scene.loading.boundaries
    scene = replace(
        scene,
        domain=replace(scene.domain, upper=(scene.domain.upper[0], SIDE + gap)),
        loading=replace(scene.loading, boundaries=(lower, replace(upper, position=SIDE + gap, speed=-speed))),
    )
    history = simulate(scene, threads=1).history
    first = history["time_s"][np.argmax(history["force_top_N"] > 0.0)]
    assert first == pytest.approx(arrives, abs=0.06 * DX / speed)  # a twentieth of a cell, and a row
