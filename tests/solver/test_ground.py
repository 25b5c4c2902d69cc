"""Rock in the ground: it starts with the stress of its weight, or the weight comes slowly; closed forms of a column."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Body,
    Box,
    Domain,
    Gravity,
    Hooke,
    InSitu,
    Jittered,
    Linear,
    Loading,
    MohrCoulomb,
    NoViscosity,
    Output,
    QuadraticBSpline,
    Rock,
    Scene,
    SceneError,
    Schedule,
    Unbreakable,
    Wall,
    simulate,
)
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.spec.scene_json import from_plain, to_plain

E, NU, DENSITY, GRAVITY, HEIGHT, DX = 17e9, 0.25, 2600.0, 9.81, 10.0, 0.5
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity())
BASE = DENSITY * GRAVITY * HEIGHT
BULK = E / (3.0 * (1.0 - 2.0 * NU))
SPEED = ROCK.wave_speed()
LATERAL = NU / (1.0 - NU)


def column(dim: int = 2, lid: bool = False, steps: int = 200, rock: Rock = ROCK, **loading) -> Scene:
    """A column of two cells by twenty between smooth walls, under a free top or a lid."""
    top = (*(dim - 1) * (2.0 * DX,), HEIGHT)
    walls = [Wall(axis=d, side=s, position=p) for d in range(dim - 1) for s, p in (("lower", 0.0), ("upper", 2.0 * DX))]
    walls += [Wall(axis=dim - 1, side="lower", position=0.0)]
    walls += [Wall(axis=dim - 1, side="upper", position=HEIGHT)] if lid else []
    parts = {name: loading.pop(name) for name in ("shape", "order", "seeding", "transfer") if name in loading}
    scene = Scene(
        title="column",
        domain=Domain(lower=dim * (0.0,), upper=(*top[:-1], HEIGHT if lid else HEIGHT + 4.0 * DX), dx=DX),
        bodies=(Body(region=Box(lower=dim * (0.0,), upper=top), seeding=parts.pop("seeding", Body.seeding)),),
        rock=rock,
        loading=Loading(boundaries=tuple(walls), **loading),
        schedule=Schedule(t_end=1.0, rows=200),
        output=Output(frames=0, movie=False, vtu=0),
        **{"shape": Linear(), **parts},
    )
    return replace(scene, schedule=replace(scene.schedule, t_end=steps * scene.dt))


def down(dim: int = 2) -> tuple[float, ...]:
    return (*(dim - 1) * (0.0,), -GRAVITY)


def in_place(dim: int = 2, **changes) -> InSitu:
    return InSitu(**{"axis": dim - 1, "surface": HEIGHT, "K0": LATERAL} | changes)


def base_stress(result, dim: int = 2) -> np.ndarray:
    """Of the floor [Pa], row by row."""
    return result.reactions[f"b{2 * (dim - 1)}_wall_{'xyz'[dim - 1]}_lower_normal_N"] / (2.0 * DX) ** (dim - 1)


SPREAD = (1.0 + 2.0 * LATERAL) / 3.0 * BASE / BULK
"""Largest 1 - J: weights of single particles err by it at most, and so does everything that they set in motion."""


@pytest.mark.parametrize(("dim", "time_scale"), [(2, 1.0), (2, 5.0), (3, 1.0)])
@pytest.mark.thorough("2-5.0", "3-1.0")
def test_column_starts_in_the_equilibrium_of_its_weight(dim, time_scale):
    """On a lattice, by linear functions, the discrete equilibrium is the exact one, whatever the mass scaling."""
    scene = column(dim, body_force=down(dim), initial_stress=in_place(dim), time_scale=time_scale)
    result = simulate(scene, threads=1)
    fall = BASE / (DENSITY * time_scale**2 * scene.wave_speed)  # speed of the base's stress in free motion
    assert np.abs(result.snapshot.velocity).max() < 2.0 * SPREAD * fall
    assert base_stress(result, dim) == pytest.approx(BASE, rel=2.0 * SPREAD)
    x = result.snapshot.x[:, dim - 1]
    assert result.snapshot.sigma[:, dim - 1, dim - 1] == pytest.approx(
        -DENSITY * GRAVITY * (HEIGHT - x), abs=2.0 * SPREAD * BASE
    )
    assert result.snapshot.sigma[:, 0, 0] == pytest.approx(
        -LATERAL * DENSITY * GRAVITY * (HEIGHT - x), abs=2.0 * SPREAD * BASE
    )
    assert np.abs(result.history["work_J"]).max() < 4.0 * SPREAD * result.history["energy_elastic_J"][0]
    stored = column_energy(dim)
    assert result.history["energy_elastic_J"] == pytest.approx(stored, rel=1.0 / 1600.0 + 4.0 * SPREAD)


def column_energy(dim: int) -> float:
    """(rho g H)^2 A H/(6 M), of a column that is held at its sides; by particles in the middle of 40 slices the
    integral of z^2 is less by 1/(4 40^2) of it."""
    lam, mu = E * NU / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (2.0 * (1.0 + NU))
    return BASE**2 * (2.0 * DX) ** (dim - 1) * HEIGHT / (6.0 * (lam + 2.0 * mu))


@pytest.mark.parametrize("shape", [QuadraticBSpline(), Linear()], ids=["spline", "linear"])
@pytest.mark.thorough
def test_elsewhere_it_moves_as_little_as_a_cell_of_rock_weighs(shape):
    """Jittered, or by splines at a free top, the sums of a cell are not exact: some weight of one cell stays over."""
    seeding = Jittered(amount=0.1, seed=1)
    scene = column(body_force=down(), initial_stress=in_place(), shape=shape, seeding=seeding)
    result = simulate(scene, threads=1)
    assert np.abs(result.snapshot.velocity).max() < DENSITY * GRAVITY * DX / (DENSITY * SPEED)
    assert base_stress(result) == pytest.approx(BASE, rel=DX / HEIGHT)


@pytest.mark.parametrize("order", ["musl", "usf", "usl"])
@pytest.mark.thorough("usf", "usl")
def test_overburden_in_a_box_of_walls_stays_exactly(order):
    shape = QuadraticBSpline() if order == "usl" else Linear()
    result = simulate(
        column(lid=True, initial_stress=InSitu(axis=1, overburden=20e6, K0=0.5), order=order, shape=shape), threads=1
    )
    sigma = result.snapshot.sigma
    assert sigma[:, (1, 0, 2), (1, 0, 2)] == pytest.approx(np.tile([-20e6, -10e6, -10e6], (len(sigma), 1)), rel=1e-12)
    assert np.abs(result.snapshot.velocity).max() < 1e-12 * 20e6 / (DENSITY * SPEED)
    rows = result.reactions
    assert rows["b3_wall_y_upper_normal_N"] == pytest.approx(20e6 * 2.0 * DX, rel=1e-9)
    assert rows["b0_wall_x_lower_normal_N"] == pytest.approx(10e6 * HEIGHT, rel=1e-9)


def test_rock_in_the_ground_is_squeezed_by_its_stress_and_weighs_what_it_weighs(taichi_f64):
    """K (1 - J) = (1 + 2 K0) p/3, by which rock that fails keeps its pressure; mass is that of the scene's density."""
    scene = column(body_force=down(), initial_stress=in_place(overburden=20e6, K0=0.5))
    sim = set_up(scene).sim
    depth = HEIGHT - sim.particles.reference.to_numpy()[:, 1]
    J, volume = sim.particles.J.to_numpy(), sim.particles.volume.to_numpy()
    assert BULK * (1.0 - J) == pytest.approx(2.0 / 3.0 * (20e6 + DENSITY * GRAVITY * depth), rel=1e-9)
    assert volume * J == pytest.approx(np.full(len(J), 0.25 * DX**2), rel=1e-12)
    assert sim.density * volume.sum() == pytest.approx(DENSITY * 2.0 * DX * HEIGHT, rel=1e-12)


def test_gravity_is_recorded_and_read_back():
    scene = column(force_field=Gravity(b=down(), ramp=0.1))
    assert from_plain(to_plain(scene)) == scene


@pytest.mark.parametrize("time_scale", [1.0, 3.0])
@pytest.mark.thorough
def test_weight_that_comes_slowly_hardly_overshoots(time_scale):
    """A mode of period T swings by R(2 pi ramp/T) of its part, R(a) = 12 |2 sin(a/2) - a cos(a/2)|/a^3, and mode n of a
    column makes 8/(pi n)^2 of the base stress, n = 1, 3, ...; at once the modes double it."""
    period = 4.0 * HEIGHT / SPEED * time_scale
    for ramp, steps in ((2.25 * period, 600), (None, 200)):
        loading = {"body_force": down()} if ramp is None else {"force_field": Gravity(b=down(), ramp=ramp)}
        scene = column(steps=steps, time_scale=time_scale, **loading)
        result = simulate(scene, threads=1)
        after = result.history["time_s"] > (ramp or 0.0)
        stress = base_stress(result)[after] / BASE
        if ramp is None:
            assert stress.max() == pytest.approx(2.0, abs=0.1)
            continue
        n = np.arange(1, 40, 2)
        a = 2.0 * math.pi * n * ramp / period
        swing = 12.0 * np.abs(2.0 * np.sin(a / 2.0) - a * np.cos(a / 2.0)) / a**3
        bound = (8.0 / (np.pi * n) ** 2 * swing).sum()
        assert bound < 0.06 and after.sum() >= 5
        assert np.abs(stress - 1.0).max() < 1.05 * bound
        assert stress.mean() == pytest.approx(1.0, abs=bound)


REFUSED = [
    ("initial_stress.surface = 9.0", {"initial_stress": in_place(surface=9.0)}),
    ("initial_stress.surface = None", {"initial_stress": in_place(surface=None)}),
    ("initial_stress.axis = 2", {"initial_stress": in_place(axis=2)}),
    ("loading.confinement = 1000000.0", {"initial_stress": in_place(), "confinement": 1e6}),
    ("at most 1.133e+09 Pa, 0.1 of the bulk", {"initial_stress": in_place(overburden=3e9)}),
    ("initial_stress.K0 = 0.0", {"initial_stress": in_place(overburden=30e6, K0=0.0), "breaks": True}),
    ("initial_stress.K0 = 60.0", {"initial_stress": in_place(overburden=5e6, K0=60.0), "breaks": True}),
    ("gravity.b = (0.0, 0.0, -9.81)", {"force_field": Gravity(b=down(3), ramp=1.0)}),
    ("loading.time_scale = 'auto'", {"initial_stress": in_place(), "time_scale": "auto"}),
]


@pytest.mark.parametrize(("words", "loading"), REFUSED, ids=[words for words, _ in REFUSED])
def test_what_no_rock_starts_with_is_refused(words, loading):
    criterion = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6)
    rock = replace(ROCK, criterion=criterion) if loading.pop("breaks", False) else ROCK
    with pytest.raises(SceneError) as refused:
        scene = column(rock=rock, **{"body_force": down()} | loading)
        _ = scene.time_scale
    assert words in str(refused.value)


def test_plate_is_refused():
    with pytest.raises(SceneError, match="plane stress"):
        column(rock=replace(ROCK, elasticity=Hooke(E=E, nu=NU, plane_stress=True)), initial_stress=in_place())


@pytest.mark.parametrize(
    "words", [{"K0": -0.1}, {"K0": 101.0}, {"overburden": -1.0}, {"surface": math.nan}, {"axis": 3}]
)
def test_stress_that_is_none_is_refused(words):
    (name,) = words
    with pytest.raises(SceneError, match=f"initial_stress.{name}"):
        in_place(**words)
