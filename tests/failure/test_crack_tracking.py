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
RADIUS, SLOPE = 4e-3, math.tan(math.radians(25.0))
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
    """Nothing has cracked, nothing is excluded."""
    particles, h = sim.particles, sim.particles.history
    for field in (particles.mode, h.slip, h.crack_strain_max, h.crack_normal, particles.excluding_normal):
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


def beside(sim: Simulation, crack: int, angle: float) -> np.ndarray:
    """Outside the wedge about the line of a crack with its normal at `angle` [degrees], and nearer than the radius."""
    d = positions(sim) - positions(sim)[crack]
    n = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    across, along = np.abs(d @ n), np.abs(d @ [-n[1], n[0]])
    return (np.hypot(across, along) < RADIUS) & (across > SLOPE * along)


@pytest.mark.parametrize("angle", [0.0, 30.0, -70.0])
def test_only_the_most_overloaded_particle_of_a_hump_cracks_and_excludes_what_lies_beside_it(angle):
    sim = rested(simulation())
    top = particle_near(sim, 15.3, 16.8)
    sigma = pulled_along(angle, humps(sim, [top]))
    assert look(sim, sigma) == {top}
    assert (sim.particles.overload.to_numpy() > 0.0).sum() > 20  # the others were overloaded too
    normal = sim.particles.history.crack_normal.to_numpy()[top]
    assert normal == pytest.approx(unit(math.radians(angle)), abs=1e-6)
    assert sim.events.onset[None] == 1.0 and sim.events.count[None] == 0
    excluding, side = sim.particles.excluding_normal.to_numpy(), beside(sim, top, angle)
    assert 100 < side.sum() < 200  # 130 degrees of 180 of a circle that holds 201 particles
    assert (excluding[side] == normal).all()
    assert (np.delete(excluding, np.append(np.flatnonzero(side), top), axis=0) == 0.0).all()


def test_equal_humps_far_from_each_other_crack_in_the_same_look():
    sim = rested(simulation())
    tops = [particle_near(sim, 8.3, 8.3), particle_near(sim, 24.3, 22.3)]
    assert look(sim, pulled_along(90.0, humps(sim, tops))) == set(tops)


def test_crack_grows_from_its_ends_as_a_line():
    """Stress is given and stays: nothing but exclusion keeps the whole hump from cracking, look after look."""
    sim = rested(simulation())
    top = particle_near(sim, 16.3, 16.3)
    sigma, cracked = pulled_along(0.0, humps(sim, [top], width=4e-3)), []
    for time in range(12):
        cracked += look(sim, sigma, float(time))
    d = np.abs(positions(sim)[cracked] - positions(sim)[top])
    near = np.hypot(*d.T) < RADIUS
    assert len(cracked) > 8 and (d[near, 0] <= SLOPE * d[near, 1] + 1e-12).all()
    assert np.ptp(positions(sim)[cracked][near, 1]) > 0.9 * RADIUS  # along itself it has grown
    assert sim.events.onset[None] == 0.0


def test_exclusion_holds_for_a_mean_stress_along_its_crack_only():
    sim = rested(simulation())
    top = particle_near(sim, 15.3, 16.8)
    sigma = pulled_along(0.0, humps(sim, [top]))
    for degrees, cracks in ((0.0, False), (40.0, False), (-40.0, False), (180.0, False), (50.0, True), (90.0, True)):
        rested(sim).particles.excluding_normal.fill(ti.Vector(unit(math.radians(degrees))))
        assert look(sim, sigma) == ({top} if cracks else set()), degrees


@ti.kernel
def own_modes(sim: ti.template(), mode: ti.types.ndarray()):
    for p in range(mode.shape[0]):
        mode[p] = failure_by_own_stress(sim, p, extreme_principals(sim.particles.sigma[p]))


@pytest.mark.parametrize(
    "stress, normal, expected",
    [
        ((3.0, 0.0, 0.0, 0.0), 0.0, 1),
        ((3.0, 0.0, 0.0, 0.0), math.radians(40.0), 1),
        ((3.0, 0.0, 0.0, 0.0), math.radians(50.0), 0),
        ((3.0, 0.0, 0.0, 0.0), 0.5 * math.pi, 0),
        ((0.0, 3.0, 0.0, 0.0), 0.5 * math.pi, 1),
        ((0.0, 3.0, 0.0, 0.0), 0.0, 0),
        ((3.0, 0.0, 0.0, 0.0), None, 0),
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
def test_excluded_particle_fails_by_its_own_stress_if_that_would_open_the_crack_beside(stress, normal, expected):
    sim = rested(simulation())
    sim.particles.sigma.from_numpy(np.tile(MPA * np.array(stress), (sim.particles.count, 1)))
    sim.particles.excluding_normal.fill(0.0 if normal is None else ti.Vector(unit(normal)))
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
    while len(seen) < 5 and len(found) < 5:
        found.append(look(sim, sigma) & set(tops))
        seen |= found[-1]
    assert seen == set(tops) and len(found[0]) == 2 and sum(map(len, found)) == 5
    excluding = np.linalg.norm(sim.particles.excluding_normal.to_numpy(), axis=1)
    for top in tops:
        assert excluding[beside(sim, top, 0.0) & (sim.particles.mode.to_numpy() == 0)] == pytest.approx(1.0)
