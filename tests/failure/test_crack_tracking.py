"""Where cracks start and grow by the mean stress, in stress fields that are given."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from harness import unit

from rsmpm_ti.failure import crack_tracking as tracking
from rsmpm_ti.failure.crack_tracking import evaluate_overload, track_cracks
from rsmpm_ti.failure.nonlocal_fields import mark_overloaded, sum_nonlocal
from rsmpm_ti.failure.stress_update import failure_by_own_stress
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.fields.nonlocal_sums import NonlocalSums
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.heterogeneity import Uniform, Weibull
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.tensors import extreme_principals
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

pytestmark = pytest.mark.usefixtures("taichi_f64")

DX, CELLS, MPA = 1e-3, 32, 1e6
AVERAGING = Nonlocal(length=2.0 * DX, exclusion=2.0)
RADIUS = 4e-3
ROCK = Rock(
    density=2600.0,
    elasticity=Hooke(E=17e9, nu=0.14),
    criterion=MohrCoulomb(cohesion=5.95 * MPA, friction_angle=40.0, tensile_strength=2.0 * MPA),
    viscosity=NoViscosity(),
    after_failure=Directional(),
    nonlocal_mean=AVERAGING,
)


def block(heterogeneity=Uniform(), dx: float = DX, **schedule) -> Scene:  # noqa: B008
    edge = (CELLS * DX,) * 2
    return Scene(
        title="block",
        domain=Domain(lower=(0.0, 0.0), upper=edge, dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=edge)),),
        rock=replace(ROCK, heterogeneity=heterogeneity),
        loading=Loading(),
        schedule=Schedule(t_end=1e-3, **schedule),
    )


@functools.cache  # kernels compile for each one; a test sets every field that it looks at
def simulation(heterogeneity=Uniform()) -> Simulation:  # noqa: B008
    scene = block(heterogeneity)
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    return sim


def rested(sim: Simulation) -> Simulation:
    """Nothing has cracked."""
    particles, h = sim.particles, sim.particles.history
    for field in (
        particles.mode,
        h.slip,
        h.crack_strain_max,
        h.crack_normal,
        particles.to_crack,
        particles.nearest_normal,
    ):
        field.fill(0)
    sim.events.onset[None] = math.inf
    return sim


def positions(sim: Simulation) -> np.ndarray:
    return sim.particles.reference.to_numpy()


def particle_near(sim: Simulation, x: float, y: float) -> int:
    """The particle nearest to a place [mm]."""
    return int(np.hypot(*(positions(sim) - 1e-3 * np.array([x, y])).T).argmin())


def pulled_along(angle: float, size: np.ndarray) -> np.ndarray:
    """Uniaxial tension of `size` [MPa], [n], along `angle` [degrees], packed [Pa]."""
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    return MPA * size[:, None] * np.array([c * c, s * s, 0.0, c * s])


def humps(sim: Simulation, centres: list[int], width: float = 3e-3, top: float = 2.7) -> np.ndarray:
    """Size of stress with a hump at each of some particles, far from each other; its mean over the length l is
    height/(1 + (l/width)^2) at the top, `top` [MPa]."""
    x, height = positions(sim), top * (1.0 + (AVERAGING.length / width) ** 2)
    return sum(height * np.exp(-0.5 * np.sum((x - x[c]) ** 2, axis=1) / width**2) for c in centres)


def look(sim: Simulation, sigma: np.ndarray, time: float = 1.0) -> set[int]:
    """Which particles crack in one look at a stress field [n, 4]."""
    before = sim.particles.mode.to_numpy()
    sim.particles.sigma.from_numpy(sigma)
    track_cracks(sim, time)
    return set(np.flatnonzero(sim.particles.mode.to_numpy() != before))


def ahead_of(sim: Simulation, cracks: list[int], normal: float) -> None:
    """All that is intact knows some cracked particles as its nearest ones; normal: of those [rad]."""
    x = positions(sim)
    away = x[cracks][:, None] - x
    nearest = np.hypot(*np.moveaxis(away, -1, 0)).argmin(axis=0)
    sim.particles.to_crack.from_numpy(away[nearest, np.arange(len(x))])
    sim.particles.nearest_normal.fill(ti.Vector(unit(normal)))
    mode = sim.particles.mode.to_numpy()
    mode[cracks] = 1
    sim.particles.mode.from_numpy(mode)


@pytest.mark.parametrize("angle", [0.0, 30.0, -70.0])
def test_only_the_most_overloaded_particle_of_a_hump_cracks_and_those_around_learn_where(angle):
    sim = rested(simulation())
    top = particle_near(sim, 15.3, 16.8)
    sigma = pulled_along(angle, humps(sim, [top]))
    assert look(sim, sigma) == {top}
    assert (sim.particles.overload.to_numpy() > 0.0).sum() > 20  # the others were overloaded too
    normal = sim.particles.history.crack_normal.to_numpy()[top]
    assert normal == pytest.approx(unit(math.radians(angle)), abs=1e-6)
    assert sim.events.onset[None] == 1.0 and sim.events.count[None] == 0
    away = positions(sim)[top] - positions(sim)
    near = np.hypot(*away.T) < RADIUS
    near[top] = False
    assert near.sum() == 192  # places nearer than eight steps of a square lattice, but for the middle
    known = sim.particles.to_crack.to_numpy()
    np.testing.assert_allclose(known[near], away[near], atol=1e-15)
    assert (known[~near] == 0.0).all()
    assert (sim.particles.nearest_normal.to_numpy()[near] == normal).all()


def test_nearest_of_two_cracks_counts_whichever_came_first():
    for order in ((0, 1), (1, 0)):
        sim = rested(simulation())
        tops = [particle_near(sim, 14.3, 16.3), particle_near(sim, 17.3, 16.3)]
        for k in order:
            assert look(sim, pulled_along(90.0, humps(sim, [tops[k]], width=1.5e-3))) == {tops[k]}
        x, known = positions(sim), sim.particles.to_crack.to_numpy()
        away = x[tops][:, None] - x
        distance = np.hypot(*np.moveaxis(away, -1, 0))
        near = (distance < RADIUS).any(axis=0) & (sim.particles.mode.to_numpy() == 0)
        np.testing.assert_allclose(np.hypot(*known[near].T), distance.min(axis=0)[near], atol=1e-15)


def test_equal_humps_far_from_each_other_crack_in_the_same_look():
    sim = rested(simulation())
    tops = [particle_near(sim, 8.3, 8.3), particle_near(sim, 24.3, 22.3)]
    assert look(sim, pulled_along(90.0, humps(sim, tops))) == set(tops)


def tip_field(x: np.ndarray, K_I: float, K_II: float) -> np.ndarray:
    """Packed stress about the tip at 0 of a crack along x < 0: Williams (1957), J. Appl. Mech. 24:109. [MPa sqrt(m)]"""
    r, half = np.hypot(*x.T), 0.5 * np.arctan2(x[:, 1], x[:, 0])
    c, s, c3, s3 = np.cos(half), np.sin(half), np.cos(3.0 * half), np.sin(3.0 * half)
    xx = K_I * c * (1.0 - s * s3) - K_II * s * (2.0 + c * c3)
    yy = K_I * c * (1.0 + s * s3) + K_II * s * c * c3
    xy = K_I * s * c * c3 + K_II * c * (1.0 - s * s3)
    return MPA * np.stack([xx, yy, 0.0 * xx, xy], axis=1) / np.sqrt(2.0 * math.pi * r)[:, None]


def turned(angle: float) -> np.ndarray:
    """Matrix that turns by an angle [rad]."""
    return np.array([unit(angle), unit(angle + 0.5 * math.pi)]).T


def first_step(sim: Simulation, K: tuple[float, float], turn: float, angle: float) -> float:
    """Angle [degrees] from the line of a crack, which is turned in the lattice, to where it grows in one look; there is
    2.5 MPa of hoop stress at `angle` [rad], 1.25 mm from the tip."""
    rested(sim)
    end, R = particle_near(sim, 16.3, 16.3), turned(turn)
    x = (positions(sim) - positions(sim)[end]) @ R
    crack = [int(np.hypot(x[:, 0] + a, x[:, 1]).argmin()) for a in np.arange(0.0, 6.0e-3, 0.5e-3)]
    ahead_of(sim, sorted(set(crack)), turn + 0.5 * math.pi)
    tip = np.where(np.hypot(*x.T)[:, None] > 0.1e-3, x, 0.1e-3)
    s = tip_field(tip, *K)
    full = R @ np.stack([s[:, [0, 3]], s[:, [3, 1]]], axis=1) @ R.T
    sigma = np.stack([full[:, 0, 0], full[:, 1, 1], 0.0 * s[:, 2], full[:, 0, 1]], axis=1)
    half = 0.5 * angle
    equivalent = math.cos(half) * (K[0] * math.cos(half) ** 2 - 1.5 * K[1] * math.sin(angle))
    new = look(sim, sigma * 2.5 * math.sqrt(2.0 * math.pi * 1.25e-3) / equivalent)
    return max((math.degrees(math.atan2(*x[p, ::-1])) for p in new if np.hypot(*x[p]) < 2.0e-3), default=math.nan)


@pytest.mark.parametrize("K_I, K_II, angle", [(1.0, 0.0, 0.0), (1.0, 0.3, -28.6), (1.0, -1.0, 53.1)])
def test_crack_grows_where_the_hoop_stress_is_largest(K_I, K_II, angle):
    """Angles of Erdogan & Sih (1963), eq. 5; sigma_1 of the first field is largest at 60 degrees to either side.

    A particle within two cells has 50 others around it, so that one direction is known to some 10 degrees; the crack
    is turned in the lattice 24 times.
    """
    turns, at = np.arange(24) * math.pi / 12.0 + 0.05, math.radians(angle)
    found = [first_step(simulation(), (K_I, K_II), turn, at) for turn in turns]
    assert np.mean(found) == pytest.approx(angle, abs=10.0)
    assert np.std(found) < 20.0


@pytest.mark.parametrize("own, mean, cracks", [(2.1, 1.0, True), (2.1, -1.0, True), (1.9, 3.0, False)])
def test_own_tension_says_when_at_a_tip(own, mean, cracks):
    """One particle 1.5 mm ahead of a crack and its surroundings; 2 MPa of strength."""
    sim = rested(simulation())
    crack = particle_near(sim, 14.3, 16.3)
    ahead_of(sim, [crack], 0.5 * math.pi)
    ahead = particle_near(sim, 15.8, 16.3)
    size = np.full(sim.particles.count, mean)
    size[ahead] = own
    assert (ahead in look(sim, pulled_along(90.0, size))) is cracks


@pytest.mark.parametrize("degrees, cracks", [(90.0, True), (65.0, True), (55.0, False), (0.0, False), (-65.0, True)])
def test_tension_across_the_line_to_a_crack_counts_near_it(degrees, cracks):
    """2.7 sin^2 MPa of a mean stress along x, 2 MPa of strength: from 59.4 degrees on, 3 mm from a crack."""
    sim = rested(simulation())
    top = particle_near(sim, 15.3, 16.8)
    sim.particles.to_crack.fill(3e-3 * ti.Vector(unit(math.radians(degrees))))
    sim.particles.nearest_normal.fill(ti.Vector([1.0, 0.0]))
    assert look(sim, pulled_along(0.0, humps(sim, [top]))) == ({top} if cracks else set())


@ti.kernel
def own_modes(sim: ti.template(), mode: ti.types.ndarray()):
    for p in range(mode.shape[0]):
        mode[p] = failure_by_own_stress(sim, p, extreme_principals(sim.particles.sigma[p]))


@pytest.mark.parametrize(
    "stress, normal, expected",
    [
        ((2.9, 0.0, 0.0, 0.0), 0.0, 1),
        ((2.9, 0.0, 0.0, 0.0), math.radians(40.0), 1),
        ((2.9, 0.0, 0.0, 0.0), math.radians(50.0), 0),
        ((2.9, 0.0, 0.0, 0.0), 0.5 * math.pi, 0),
        ((0.0, 2.9, 0.0, 0.0), 0.5 * math.pi, 1),
        ((0.0, 2.9, 0.0, 0.0), 0.0, 0),
        ((2.9, 0.0, 0.0, 0.0), None, 0),
        ((3.1, 0.0, 0.0, 0.0), 0.5 * math.pi, 1),  # 1.55 times its strength, near a crack
        ((3.1, 0.0, 0.0, 0.0), None, 0),
        ((1.9, 0.0, 0.0, 0.0), 0.0, 0),
        ((0.0, -30.0, 0.0, 0.0), None, 2),  # shear is for a particle's own stress: 25.5 MPa
        ((0.0, -30.0, 0.0, 0.0), 0.0, 2),
        ((6.0, 0.0, 0.0, 0.0), None, 0),  # 5.55 MPa alone reaches Mohr-Coulomb: for the mean to judge, too
        ((6.0, -22.0, 0.0, 0.0), None, 2),  # beyond 25.52 - 4.599 * 2 MPa it is shear, with the cut-off's tension
        ((6.0, -15.0, 0.0, 0.0), None, 0),
        ((2.1, -30.0, 0.0, 0.0), None, 2),  # tension is for the mean, shear is not
        ((2.1, -30.0, 0.0, 0.0), 0.0, 1),  # both by its own: tension first, as in the paper
    ],
)
def test_particle_in_a_band_fails_by_its_own_stress_if_that_would_open_the_crack(stress, normal, expected):
    sim = rested(simulation())
    sim.particles.sigma.from_numpy(np.tile(MPA * np.array(stress), (sim.particles.count, 1)))
    if normal is not None:
        sim.particles.nearest_normal.fill(ti.Vector(unit(normal)))
        sim.particles.to_crack.fill(DX * ti.Vector(unit(normal)))
    mode = np.zeros(sim.particles.count, dtype=np.int32)
    own_modes(sim, mode)
    assert (mode == expected).all()


@pytest.mark.parametrize(
    "across, along, expected", [(1.9, 0.9, 1), (-1.9, -0.9, 1), (2.1, 0.0, 0), (1.9, 1.1, 0), (0.5, 0.6, 0)]
)
def test_band_of_a_crack_is_a_band_wide_and_ends_with_it(across, along, expected):
    """To either side of the crack, two cells; along it a cell, and rather beside than ahead."""
    sim = rested(simulation())
    sim.particles.sigma.from_numpy(np.tile(MPA * np.array([2.9, 0.0, 0.0, 0.0]), (sim.particles.count, 1)))
    sim.particles.nearest_normal.fill(ti.Vector([1.0, 0.0]))
    sim.particles.to_crack.fill(DX * ti.Vector([across, along]))
    mode = np.zeros(sim.particles.count, dtype=np.int32)
    own_modes(sim, mode)
    assert (mode == expected).all()


def test_overload_is_over_the_strength_of_the_particle_itself():
    sim = rested(simulation(Weibull(shape=10.0, reference_volume=0.25e-6, seed=2)))
    k = sim.particles.strength.to_numpy()
    assert sim.nonlocal_sums.weakest == pytest.approx(2.0 * MPA * k.min(), rel=1e-12)
    for stress in (1.99 * k.min(), 2.01 * k.min(), 1.8):
        sim.particles.sigma.from_numpy(pulled_along(0.0, np.full(len(k), stress)))
        sum_nonlocal(sim)
        mark_overloaded(sim, sim.nonlocal_sums.weakest)
        evaluate_overload(sim)
        load = stress / (2.0 * k)
        np.testing.assert_allclose(sim.particles.overload.to_numpy(), np.where(load >= 1.0, load, 0.0), rtol=1e-12)
    cracked = look(sim, pulled_along(0.0, np.full(len(k), 2.01 * k.min())))
    assert cracked == {int(k.argmin())}


@pytest.mark.parametrize(
    "dx, cfl, interval",
    [(1.0, 0.5, 1), (0.5, 0.5, 2), (0.4, 0.5, 2), (0.25, 0.5, 4), (0.2, 0.5, 5), (0.5, 0.25, 4)],
)
def test_looks_are_a_quarter_of_the_waves_time_over_the_length_apart(dx, cfl, interval):
    """Steps are cfl dx/c: the largest whole number of them in l/(4 c), l = 2 mm."""
    scene = block(dx=dx * 1e-3, cfl=cfl)
    assert NonlocalSums(scene, scene.rock, Grid(scene), ti.f64).interval == interval


def test_cracks_beyond_the_most_of_one_look_wait_for_the_next(monkeypatch):
    """A kernel takes the number from the module when it compiles, so this needs a simulation of its own."""
    monkeypatch.setattr(tracking, "MAX_NEW_CRACKS", 2)
    sim = rested(simulation.__wrapped__())
    tops = [particle_near(sim, x, y) for x in (6.3, 16.3, 26.3) for y in (8.3, 24.3)][:5]
    sigma = pulled_along(0.0, humps(sim, tops, width=1.5e-3, top=2.02))  # nothing but the tops is overloaded
    found, seen = [], set()
    while len(seen) < 5 and len(found) < 100:  # what lies at the first tips comes in between
        found.append(look(sim, sigma) & set(tops))
        seen |= found[-1]
    assert seen == set(tops) and len(found[0]) == 2 and sum(map(len, found)) == 5
    known, intact = np.hypot(*sim.particles.to_crack.to_numpy().T), sim.particles.mode.to_numpy() == 0
    for top in tops:
        away = np.hypot(*(positions(sim) - positions(sim)[top]).T)
        assert (known[(away < RADIUS) & intact] > 0.0).all()
