"""Rock that is taken out of ground under stress, against Kirsch's hole; what is booked, and a run that goes on."""

from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import (
    Body,
    Box,
    Difference,
    Disc,
    Domain,
    Excavation,
    HolePressure,
    Hooke,
    InSitu,
    Jittered,
    Lattice,
    Loading,
    NoViscosity,
    Output,
    Platen,
    Rock,
    Scene,
    SceneError,
    Schedule,
    Unbreakable,
    Wall,
    simulate,
)
from rsmpm_ti.spec.holes.excavation import marks
from rsmpm_ti.spec.review.plausible import implausible
from rsmpm_ti.spec.scene_json import from_plain, to_plain

E, NU, DENSITY, RADIUS, HALF, DX, VERTICAL = 17e9, 0.25, 2600.0, 8e-3, 80e-3, 1.6e-3, 10e6
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=E, nu=NU), criterion=Unbreakable(), viscosity=NoViscosity())
TRANSIT = HALF / ROCK.wave_speed()
DISC = Disc(centre=(0.0, 0.0), radius=RADIUS)
DIG = Excavation(region=DISC, time=0.2 * TRANSIT, relaxation=20.0 * TRANSIT)


FITTED = Lattice(fitted=True)


def ground(half: float = HALF, K0: float = 0.5, end: float = 22.2, seeding=FITTED, **changes) -> Scene:
    """A quarter of a block between walls that stand still, from which a quarter of a disc is taken."""
    walls = tuple(
        Wall(axis=axis, side=side, position=at) for axis in (0, 1) for side, at in (("lower", 0.0), ("upper", half))
    )
    stress = InSitu(axis=1, overburden=VERTICAL, K0=K0)
    return Scene(
        title="ground",
        domain=Domain(lower=(0.0, 0.0), upper=(half, half), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(half, half)), seeding=seeding),),
        rock=ROCK,
        loading=Loading(boundaries=walls, **({"initial_stress": stress, "holes": (DIG,)} | changes)),
        schedule=Schedule(t_end=end * TRANSIT),
        output=Output(frames=0, movie=False, vtu=0),
    )


def kirsch(x: np.ndarray, K0: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Radial and hoop stress [Pa], and radial displacement [m] since the excavation, in plane strain.

    Kirsch (1898); Jaeger, Cook & Zimmerman (2007), sec. 8.5. The displacement is that of the stress taken off the wall.
    """
    r, t = np.hypot(*x.T), np.arctan2(x[:, 1], x[:, 0])
    mean, half, k, c = 0.5 * (K0 + 1.0) * VERTICAL, 0.5 * (K0 - 1.0) * VERTICAL, (RADIUS / r) ** 2, np.cos(2.0 * t)
    s_rr = -mean * (1.0 - k) - half * (1.0 - 4.0 * k + 3.0 * k * k) * c
    s_tt = -mean * (1.0 + k) + half * (1.0 + 3.0 * k * k) * c
    return s_rr, s_tt, -(1.0 + NU) / E * r * k * (mean + half * (4.0 * (1.0 - NU) - k) * c)


@pytest.mark.thorough("1.0")
@pytest.mark.parametrize("K0", [0.5, 1.0])
def test_excavated_hole_is_that_of_kirsch(K0):
    """Walls that stand still ten radii away hold back 3 (R/half)^2 of the convergence under equal pressures, exactly so
    in a round block; a wall of five cells to the radius is a per cent or two off, as that of a ring under pressure."""
    result = simulate(ground(K0=K0), threads=1)
    snapshot = result.snapshot
    x = snapshot.x - snapshot.displacement
    r = np.hypot(*x.T)
    radial, sigma = x / r[:, None], snapshot.sigma[:, :2, :2]
    across = np.stack([-radial[:, 1], radial[:, 0]], axis=1)
    s_rr, s_tt = (np.einsum("pi,pij,pj->p", n, sigma, n) for n in (radial, across))
    u = np.sum(snapshot.displacement * radial, axis=1)
    e_rr, e_tt, e_u = kirsch(x, K0)
    near, wall = r < 3.0 * RADIUS, r < RADIUS + DX
    assert np.sqrt(np.mean((s_rr - e_rr)[near] ** 2)) < 0.02 * VERTICAL
    assert np.sqrt(np.mean((s_tt - e_tt)[near] ** 2)) < 0.03 * VERTICAL
    for side in (x[:, 1] < 0.17 * r, x[:, 0] < 0.17 * r):  # 10 degrees: 3 sigma_v - sigma_h, and the crown
        assert s_tt[wall & side].mean() == pytest.approx(e_tt[wall & side].mean(), rel=0.03)
        assert u[wall & side].mean() == pytest.approx(e_u[wall & side].mean(), rel=0.045)
    history = result.history
    books = history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
    books -= history["work_J"] + books[0] - history["work_J"][0]
    assert np.abs(books).max() < 0.005 * np.abs(history["work_J"]).max()
    assert history["energy_kinetic_J"].max() < 1e-4 * history["energy_elastic_J"][0]  # no shock
    assert result.summary["excavated"] == np.sum(marks(ground()) == 0) and result.summary["dropped"] == 0
    assert len(snapshot.x) == result.summary["particles"] - result.summary["excavated"]


SMALL = {"half": 24e-3, "end": 6.0}
QUICKLY = replace(DIG, relaxation=4.0 * TRANSIT)


@pytest.mark.thorough
def test_before_its_time_and_while_the_support_is_whole_nothing_moves():
    """But for what particles that are fitted to both sides of a curve do to uniform stress: 0.5 %."""
    late = replace(DIG, time=1.0 * TRANSIT, relaxation=1e6 * TRANSIT)
    for hole in (replace(DIG, time=1.0 * TRANSIT), late):
        snapshot = simulate(
            ground(half=24e-3, end=1.01 if hole is not late else 1.5, holes=(hole,)), threads=1
        ).snapshot
        assert np.abs(snapshot.velocity).max() < 0.01 * VERTICAL / (DENSITY * ROCK.wave_speed())


@pytest.mark.parametrize("times", [(0.2, 0.2), (0.2, 0.6)])
def test_a_support_beside_another_bears_what_that_does_not(times):
    """Else both bear what presses on their common nodes, and the rock flies at V/(rho c)."""
    left, right = (Box(lower=(low, 8e-3), upper=(low + 4.8e-3, 16e-3)) for low in (8e-3, 12.8e-3))
    pair = zip((left, right), times, strict=True)
    holes = tuple(Excavation(region=box, time=time * TRANSIT, relaxation=1e6 * TRANSIT) for box, time in pair)
    snapshot = simulate(ground(half=24e-3, end=1.5, K0=1.0, seeding=Lattice(), holes=holes), threads=1).snapshot
    assert np.abs(snapshot.velocity).max() < 1e-4 * VERTICAL / (DENSITY * ROCK.wave_speed())


def test_excavation_after_the_end_is_doubted():
    said = [line for line in implausible(ground(holes=(replace(DIG, time=TRANSIT),), end=0.5)) if "holes" in line]
    assert len(said) == 1 and said[0].startswith("loading.holes[0].time = ") and "after the end" in said[0]
    assert not [line for line in implausible(ground()) if "holes" in line]


BESIDE = Box(lower=(8e-3, 8e-3), upper=(12.8e-3, 12.8e-3))
PRESSED = Platen(axis=1, side="upper", position=24e-3, stress=VERTICAL)


@pytest.mark.parametrize(
    "holes, boundaries, words",
    [
        ((HolePressure(region=BESIDE, times=(0.0,), pressures=(1e6,)),
          replace(DIG, region=Box(lower=(14.4e-3, 8e-3), upper=(19.2e-3, 16e-3)))), None,
         ["holes[1].region", "more than two cells from that of holes[0]"]),
        ((replace(DIG, region=Box(lower=(8e-3, 16e-3), upper=(16e-3, 24e-3))),), PRESSED,
         ["a platen that a force moves"]),
    ],
)  # fmt: skip
def test_what_would_lose_its_balance_is_refused(holes, boundaries, words):
    scene = ground(**SMALL, holes=holes)
    if any(isinstance(hole, HolePressure) for hole in holes):
        (body,) = scene.bodies
        cut = replace(body, region=Difference(whole=body.region, removed=(BESIDE,)))
        scene = replace(scene, bodies=(cut,))
    if boundaries is not None:
        loading = replace(scene.loading, boundaries=(*scene.loading.boundaries[:3], boundaries), width=24e-3)
        scene = replace(scene, loading=loading)
    with pytest.raises(SceneError) as caught:
        scene.particles()
    assert [word for word in words if word not in str(caught.value)] == []


def test_without_a_relaxation_the_wall_shakes_and_the_books_still_close():
    """To what the grid takes of waves as short as a cell, a quarter of the motion in six transits."""
    history = simulate(ground(**SMALL, holes=(replace(DIG, relaxation=0.0),)), threads=1).history
    books = history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
    books -= history["work_J"] + books[0] - history["work_J"][0]
    moving = history["energy_kinetic_J"].max()
    assert moving > 0.05 * history["energy_elastic_J"][0]
    assert books.max() < 1e-3 * moving and books.min() > -0.25 * moving


@pytest.mark.parametrize("order", ["usf", "usl"])
@pytest.mark.thorough("usl", "usf")
def test_other_orders_let_the_wall_come_in_as_far(order):
    scene = ground(**SMALL, holes=(QUICKLY,))
    ends = [simulate(replace(scene, order=each), threads=1).snapshot.displacement for each in ("musl", order)]
    assert np.abs(ends[1] - ends[0]).max() < 0.05 * np.abs(ends[0]).max()


@pytest.mark.parametrize("fraction", [0.02, 0.4])
@pytest.mark.thorough("0.02", "0.4")
def test_run_goes_on_across_an_excavation_to_the_same_bits(tmp_path, fraction):
    """Stopped before it, and while its support fades."""
    scene = ground(**SMALL, holes=(QUICKLY,))
    scene = replace(scene, schedule=replace(scene.schedule, rows=1_000_000))  # one each step, wherever it ends
    whole = simulate(scene, threads=1)
    part = replace(scene, schedule=replace(scene.schedule, t_end=fraction * scene.t_end))
    simulate(part, out=tmp_path / "run", threads=1)
    on = simulate(scene, out=tmp_path / "run", threads=1, resume=True)
    assert np.array_equal(on.snapshot.x, whole.snapshot.x) and np.array_equal(on.snapshot.sigma, whole.snapshot.sigma)
    assert on.summary["excavated"] == whole.summary["excavated"] > 0


def test_stages_follow_each_other_and_settling_comes_before():
    """Top heading and bench, of jittered rock that first comes to rest."""
    heading = replace(QUICKLY, region=Box(lower=(0.0, 4e-3), upper=(8e-3, 8e-3)), relaxation=0.5 * TRANSIT)
    bench = replace(heading, region=Box(lower=(0.0, 0.0), upper=(8e-3, 4e-3)), time=2.0 * TRANSIT)
    scene = ground(**SMALL, holes=(bench, heading), settle=True, seeding=Jittered(fitted=True))
    result = simulate(scene, threads=1)
    assert result.summary["excavated"] == np.sum(marks(scene) >= 0) == 100
    assert np.abs(result.snapshot.displacement).max() < 0.1 * DX


def test_it_is_recorded_and_read_back():
    assert from_plain(to_plain(ground())) == ground()


@pytest.mark.parametrize(
    ("holes", "named"),
    [
        ((replace(DIG, region=Disc(centre=(1.0, 1.0), radius=RADIUS)),), "a region in the domain"),
        ((replace(DIG, region=Disc(centre=(5e-3, 5e-3), radius=1e-7)),), "larger than a particle"),
        ((replace(DIG, region=Box(lower=(-1e-3, -1e-3), upper=(0.1, 0.1))),), "some rock is left"),
        ((DIG, replace(DIG, time=TRANSIT)), "apart from holes"),
    ],
)
def test_excavation_that_cannot_be_is_refused_before_anything_compiles(holes, named):
    with pytest.raises(SceneError) as refused:
        ground(holes=holes).particles()
    assert named in str(refused.value) and "\n" not in str(refused.value)


@pytest.mark.parametrize("changes", [{"time": -1.0}, {"relaxation": -1.0}])
def test_time_that_cannot_be_is_refused(changes):
    with pytest.raises(SceneError, match=f"excavation.{next(iter(changes))}"):
        replace(DIG, **changes)
