"""How near a particle is to failure and how much strength it has lost, from stress and openings that are given."""

import functools
import math
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from harness import unit

from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.output.files import write_vtu
from rsmpm_ti.records.snapshot import SHEAR, TENSION
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.heterogeneity import Weibull
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import ExponentialSoftening, LinearSoftening
from rsmpm_ti.run.checkpoint import particle_arrays
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

pytestmark = pytest.mark.usefixtures("taichi_f64")

MPA, MM = 1e6, 1e-3
DX, LENGTH = 1.0 * MM, 3.0 * MM
UCS = 2.0 * 5.95 * math.cos(math.radians(40.0)) / (1.0 - math.sin(math.radians(40.0)))  # [MPa]
N_PHI = (1.0 + math.sin(math.radians(40.0))) / (1.0 - math.sin(math.radians(40.0)))
SOFT = LinearSoftening(G_f_I=20.0, G_f_II=200.0)
ROCK = Rock(
    density=2600.0,
    elasticity=Hooke(E=17e9, nu=0.14),
    criterion=MohrCoulomb(cohesion=5.95 * MPA, friction_angle=40.0, tensile_strength=2.0 * MPA),
)


def block(**changes) -> Scene:
    """24 x 24 mm of rock at rest."""
    return Scene(
        title="block",
        domain=Domain(lower=(0.0, 0.0), upper=(24.0 * MM, 24.0 * MM), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(24.0 * MM, 24.0 * MM))),),
        rock=replace(ROCK, **changes),
        loading=Loading(start=AtRest()),
        schedule=Schedule(t_end=1e-6),
    )


@functools.cache  # kernels compile for each one; a test sets every field that it looks at
def simulation(**changes) -> Simulation:
    scene = block(**changes)
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    return sim


def stressed(stress, **changes) -> Simulation:
    """A block that has not failed; `stress`: positions [n, 2] -> (xx, yy, zz, xy) [MPa], each [n] or one number."""
    sim = simulation(**changes)
    x = sim.particles.reference.to_numpy()
    packed = np.stack([np.broadcast_to(np.asarray(s, dtype=float), len(x)) for s in stress(x)], axis=1)
    sim.particles.sigma.from_numpy(packed * MPA)
    for component in sim.particles.history.components:
        component.fill(0)
    if sim.particles.breaks:
        sim.particles.mode.fill(0)
    if sim.is_nonlocal:
        sim.particles.to_crack.fill(0.0)
        sim.particles.nearest_normal.fill(0.0)
    return sim


def look(sim: Simulation):
    return take_snapshot(sim, 0.0)


@pytest.mark.parametrize(
    "stress, margin, governs",
    [
        ((0.0, 0.0, 0.0, 0.0), 1.0, 0),
        ((1.5, 0.0, 0.0, 0.0), 0.25, TENSION),
        ((0.0, -0.5 * UCS, 0.0, 0.0), 0.5, SHEAR),
        ((0.0, -0.5 * UCS, -UCS, 0.0), 0.0, SHEAR),  # the stress out of the plane counts
        ((0.0, 0.0, 0.0, 1.0), 0.5, TENSION),  # sigma_1 = 1 MPa by shear alone
        # a pressure p: -p sin(phi)/(c cos(phi)) in shear, which is less than none
        ((-30.0, -30.0, -30.0, 0.0), 1.0, 0),
        # the envelope is sigma_3 = N_phi sigma_1 - UCS, and the load factor (N_phi sigma_1 - sigma_3)/UCS
        ((1.0, N_PHI - 0.75 * UCS, 0.0, 0.0), 0.25, SHEAR),
    ],
)
def test_margin_is_what_is_left_to_the_nearer_failure(stress, margin, governs):
    state = look(stressed(lambda x: stress))
    np.testing.assert_allclose(state.margin, margin, atol=1e-12)
    assert (state.governs == governs).all()
    assert (state.damage == 0.0).all() and np.isnan(state.aperture).all() and np.isnan(state.crack_angle).all()


def test_weaker_rock_is_nearer_to_failure():
    """1.5 MPa of 2 k MPa where k is each particle's own factor."""
    sim = stressed(lambda x: (1.5, 0, 0, 0), heterogeneity=Weibull(shape=20.0, reference_volume=0.25 * MM**2, seed=3))
    state = look(sim)
    assert np.ptp(state.strength) > 0.1 and state.strength.min() > 0.5
    np.testing.assert_allclose(state.margin, 1.0 - 1.5 / (2.0 * state.strength), rtol=1e-12)


def test_rock_that_cannot_break_has_no_margin():
    state = look(stressed(lambda x: (90.0, -90.0, 0.0, 0.0), criterion=Unbreakable()))
    assert np.isnan(state.margin).all() and (state.governs == 0).all() and (state.damage == 0.0).all()


def step(x):
    """1.5 MPa of tension along x in the right half, nothing in the left."""
    return np.where(x[:, 0] > 12.0 * MM, 1.5, 0.0), 0.0, 0.0, 0.0


def averaged(**changes):
    return stressed(step, after_failure=Directional(softening=SOFT), nonlocal_mean=Nonlocal(length=LENGTH), **changes)


def test_mean_stress_decides_on_tension_where_it_is_asked_to():
    """A step seen through a Gaussian is a normal distribution function."""
    state = look(averaged())
    inside = (np.abs(state.x - 12.0 * MM) < 3.0 * MM).all(axis=1)  # free edges, which weigh nothing, are 3 lengths off
    fraction = [0.5 * math.erfc(-(x - 12.0 * MM) / (LENGTH * math.sqrt(2.0))) for x in state.x[inside, 0]]
    # the Gaussian is cut off at three standard deviations and sampled every 1/3 of one
    np.testing.assert_allclose(state.margin[inside], 1.0 - 0.75 * np.array(fraction), atol=0.004)
    assert (state.governs[inside] == TENSION).all()


def near_crack(sim, to_crack, normal) -> np.ndarray:
    """Margins where each particle has a crack at `to_crack` [mm] from it, with a normal."""
    sim.particles.to_crack.fill(MM * ti.Vector(to_crack))
    sim.particles.nearest_normal.fill(ti.Vector(normal))
    return look(sim).margin


def test_own_stress_decides_in_the_band_of_a_crack():
    sim = averaged()
    right = look(sim).x[:, 0] > 12.0 * MM
    margin = near_crack(sim, [1.0, 0.0], [1.0, 0.0])  # a crack beside, across sigma_1
    np.testing.assert_allclose(margin[right], 0.25, atol=1e-12)
    np.testing.assert_allclose(margin[~right], 1.0, atol=1e-12)


def test_tension_across_the_line_to_a_crack_decides_near_it():
    """By a particle's own stress at a tip, 1 mm away, and by the mean stress 5 mm away, in any direction; and at the
    latest where its own tension, 0.75 of its strength here, is 1.5 times that."""
    sim = averaged()
    state = look(sim)
    inside = (np.abs(state.x - 12.0 * MM) < 3.0 * MM).all(axis=1)
    mean = 0.75 * np.array([0.5 * math.erfc(-(x - 12.0 * MM) / (LENGTH * math.sqrt(2.0))) for x in state.x[inside, 0]])
    right = state.x[inside, 0] > 12.0 * MM
    least = np.where(right, max(1.5 * N_PHI / UCS, 0.75 / 1.5), 0.0)
    for degrees in (90.0, 60.0, 0.0):
        c, s = math.cos(math.radians(degrees)), math.sin(math.radians(degrees))
        own = near_crack(sim, [c, s], [-s, c])[inside]
        np.testing.assert_allclose(own, 1.0 - np.maximum(np.where(right, 0.75 * s * s, 0.0), least), atol=1e-12)
        far = near_crack(sim, [5.0 * c, 5.0 * s], [-s, c])[inside]
        np.testing.assert_allclose(far, 1.0 - np.maximum(mean * s * s, least), atol=0.004)


def test_own_tension_beyond_the_cut_off_is_no_shear_with_averaging():
    """6 MPa reaches Mohr-Coulomb by itself, at UCS/N_phi = 5.55 MPa; 2 MPa is 0.36 of the way."""
    state = look(averaged())
    top = int(np.argmin(np.hypot(*(state.x - 12.0 * MM).T)))
    peak = stressed(
        lambda x: (np.where((x == state.x[top]).all(axis=1), 6.0, 0.0), 0.0, 0.0, 0.0),
        after_failure=Directional(softening=SOFT), nonlocal_mean=Nonlocal(length=LENGTH),
    )  # fmt: skip
    state = look(peak)
    assert state.margin.min() == pytest.approx(1.0 - 2.0 * N_PHI / UCS, rel=1e-12)
    assert (state.governs == SHEAR).sum() == 1


def test_shear_is_for_a_particles_own_stress_with_averaging_too():
    sim = stressed(
        lambda x: (0.0, np.where(x[:, 0] > 12.0 * MM, -0.5 * UCS, 0.0), 0.0, 0.0),
        after_failure=Directional(softening=SOFT), nonlocal_mean=Nonlocal(length=LENGTH),
    )  # fmt: skip
    state = look(sim)
    right = state.x[:, 0] > 12.0 * MM
    np.testing.assert_allclose(state.margin, np.where(right, 0.5, 1.0), atol=1e-12)
    assert (state.governs == np.where(right, SHEAR, 0)).all()


def test_looking_changes_nothing_that_a_particle_holds():
    sim = averaged()
    before = particle_arrays(sim)
    look(sim)
    after = particle_arrays(sim)
    assert all(np.array_equal(before[name], after[name]) for name in before)


def test_failed_rock_of_the_paper_has_no_margin_and_all_of_the_damage():
    sim = stressed(lambda x: (0.0, 0.0, 0.0, 0.0))
    mode = sim.particles.mode
    wanted = np.arange(sim.particles.count, dtype=np.int32) % 3
    mode.from_numpy(wanted)
    state, order = look(sim), np.argsort(sim.particles.id.to_numpy())
    np.testing.assert_array_equal(state.margin, np.where(wanted[order] > 0, 0.0, 1.0))
    np.testing.assert_array_equal(state.damage, np.where(wanted[order] > 0, 1.0, 0.0))
    np.testing.assert_array_equal(state.governs, wanted[order])
    assert np.isnan(state.aperture).all(), "a fluid has no opening"


@pytest.mark.parametrize("softening", [SOFT, ExponentialSoftening(G_f_I=20.0, G_f_II=200.0)])
def test_damage_and_opening_follow_the_softening_law(softening):
    """Opening w = h e with h two cells for quadratic B-splines; the largest so far decides on damage."""
    sim = stressed(lambda x: (0.0, 0.0, 0.0, 0.0), after_failure=Directional(softening=softening))
    particles, n = sim.particles, sim.particles.count
    widest = np.linspace(0.0, 25e-6, n)  # [m]; linear softening is over at 20 um
    now = 0.6 * widest
    particles.mode.fill(TENSION)
    particles.history.crack_normal.fill(ti.Vector(unit(-0.25 * math.pi)))
    band = 2.0 * DX
    particles.history.crack_strain_max.from_numpy(np.stack([widest, 0.3 * widest], axis=1) / band)
    particles.history.crack_strain.from_numpy(np.stack([now, 0.3 * now], axis=1) / band)
    state, order = look(sim), np.argsort(particles.id.to_numpy())
    relative = widest * 2.0 * MPA / 20.0  # w f_t/G_f
    lost = np.minimum(0.5 * relative, 1.0) if softening is SOFT else 1.0 - np.exp(-relative)
    np.testing.assert_allclose(state.damage, lost[order], atol=1e-12)
    np.testing.assert_allclose(state.aperture, now[order], rtol=1e-12)
    np.testing.assert_allclose(state.crack_angle, 135.0, rtol=1e-12)
    assert (state.margin == 0.0).all() and (state.governs == TENSION).all() and (state.failure_mode == 0).all()


def test_slip_and_the_second_crack_damage_too():
    sim = stressed(lambda x: (0.0, 0.0, 0.0, 0.0), after_failure=Directional(softening=SOFT))
    particles, band = sim.particles, 2.0 * DX
    particles.mode.fill(SHEAR)
    half_slip = 200.0 / (5.95 * MPA) / band  # half of cohesion is gone at w = G_f/c
    particles.history.slip.fill(half_slip)
    np.testing.assert_allclose(look(sim).damage, 0.5, rtol=1e-12)
    second = np.zeros((particles.count, 2))
    second[:, 1] = 16e-6 / band  # 80 % of the tensile strength along the first crack
    particles.history.crack_strain_max.from_numpy(second)
    np.testing.assert_allclose(look(sim).damage, 0.8, rtol=1e-12)


def test_vtu_holds_margin_and_damage(tmp_path):
    meshio = pytest.importorskip("meshio")
    sim = stressed(step, after_failure=Directional(softening=SOFT))
    wide = np.zeros((sim.particles.count, 2))
    wide[::3, 0] = 12e-6 / (2.0 * DX)
    sim.particles.mode.from_numpy(np.where(wide[:, 0] > 0.0, TENSION, 0).astype(np.int32))
    sim.particles.history.crack_strain_max.from_numpy(wide)
    sim.particles.history.crack_strain.from_numpy(wide)
    state = look(sim)
    write_vtu(tmp_path / "p.vtu", state)
    data = meshio.read(tmp_path / "p.vtu").point_data
    found = {"margin": (0.0, 0.25, 1.0), "governs": (0, 1), "damage": (0.0, 0.6), "aperture_m": (0.0, 12e-6)}
    for name, values in found.items():
        written = getattr(state, name.removesuffix("_m")).astype(data[name].dtype)  # in single precision
        np.testing.assert_array_equal(data[name].ravel(), written, err_msg=name)
        np.testing.assert_allclose(np.unique(written), values, rtol=np.finfo(np.float32).eps, atol=1e-12, err_msg=name)
