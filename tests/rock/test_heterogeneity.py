"""Strength that varies from place to place: its distribution, how it sees the mesh, and its way through a run."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtri
from scipy.stats import kstest, norm, weibull_min

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.heterogeneity import Uniform, Weibull
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.scene_json import from_plain, to_plain
from rsmpm_ti.spec.seeding import Jittered, Lattice

MM = 1e-3
VARIED = Weibull(shape=3.0, reference_volume=1e-6, seed=7)


def positions(n: int, spacing: float) -> np.ndarray:
    """n x n particles on a lattice, [n^2, 2]."""
    axis = (np.arange(n) + 0.5) * spacing
    return np.stack(np.meshgrid(axis, axis, indexing="ij"), axis=-1).reshape(-1, 2)


@pytest.mark.parametrize(
    "field, value",
    [
        *[("shape", v) for v in (0.0, -3.0, 0.4, 1001.0, math.nan, math.inf)],
        *[("reference_volume", v) for v in (0.0, -1e-6, 1e-30, math.nan, math.inf)],
        *[("seed", v) for v in (-1, 1.5, True)],
        *[("correlation_length", v) for v in (-1e-3, 1e-12, math.nan, math.inf)],
    ],
)
def test_bad_value_is_refused_by_name(field, value):
    with pytest.raises(SceneError, match=f"heterogeneity.{field} = "):
        replace(VARIED, **{field: value})


@pytest.mark.parametrize("volume", [0.25e-6, 1e-6, 9e-6])
def test_factors_are_weibull_with_the_scale_of_their_volume(volume):
    k = VARIED.factors(positions(100, 1.0), np.full(10_000, volume))
    scale = (1e-6 / volume) ** (1.0 / 3.0)
    assert kstest(k, weibull_min(3.0, scale=scale).cdf).pvalue > 0.01  # one seed: 1 in 100 would fall below
    assert kstest(k, weibull_min(3.0, scale=1.05 * scale).cdf).pvalue < 1e-4  # a wrong scale would be seen


def test_particles_of_different_volumes_have_each_its_own_scale():
    volume = np.tile([1e-6, 0.5e-6, 8e-6], 4000)
    scaled = VARIED.factors(positions(110, 1.0)[:12_000], volume) * (volume / 1e-6) ** (1.0 / 3.0)
    for k in range(3):
        assert kstest(scaled[k::3], weibull_min(3.0).cdf).pvalue > 0.01


@pytest.mark.parametrize("per_side", [8, 24])
def test_the_weakest_of_an_area_does_not_see_the_particle_size(per_side):
    """Mean over seeds of the minimum over 8 x 8 mm: Gamma(1 + 1/m) (V_ref/A)^(1/m), whatever the particles."""
    seeds, area, volume = 1000, 64e-6, np.full(per_side**2, 64e-6 / per_side**2)
    x = positions(per_side, 8 * MM / per_side)
    weakest = np.array([replace(VARIED, seed=seed).factors(x, volume).min() for seed in range(seeds)])
    mean = math.gamma(4.0 / 3.0) * (1e-6 / area) ** (1.0 / 3.0)
    scatter = math.sqrt(math.gamma(5.0 / 3.0) / math.gamma(4.0 / 3.0) ** 2 - 1.0)  # standard deviation over mean
    assert weakest.mean() == pytest.approx(mean, rel=3.0 * scatter / math.sqrt(seeds))  # 3 standard errors, 3.4 %
    assert weakest.std() == pytest.approx(scatter * mean, rel=0.08)  # 3 of its own: 1/sqrt(2 x 1000) each, about


def gaussian(k: np.ndarray) -> np.ndarray:
    """The normal number behind a factor of VARIED where V = V_ref: F(k) = 1 - exp(-k^m), by the inverse copula."""
    return ndtri(-np.expm1(-(k**3.0)))


def correlated(length: float, seed: int) -> Weibull:
    """Factors of scale 1 for all particles smaller than the correlation volume."""
    return replace(VARIED, seed=seed, correlation_length=length, reference_volume=math.pi * length**2)


def test_correlation_falls_as_a_gaussian_with_distance():
    n, length, seeds = 40, 4 * MM, 40
    fields = []
    for seed in range(seeds):
        fields.append(gaussian(correlated(length, seed).factors(positions(n, MM), np.full(n * n, MM**2))).reshape(n, n))
    fields = np.array(fields)
    # independent pieces: 40 seeds of 40 x 40 mm over an area pi l^2/2 of correlation of products; error 1/sqrt of them
    error = 1.0 / math.sqrt(seeds * (n * MM) ** 2 / (0.5 * math.pi * length**2))
    for lag in (0, 1, 2, 4, 6, 8, 12):
        along = (fields[:, : n - lag] * fields[:, lag:]).mean()
        across = (fields[:, :, : n - lag] * fields[:, :, lag:]).mean()
        expected = math.exp(-((lag * MM / length) ** 2))
        assert along == pytest.approx(expected, abs=3.0 * error), lag
        assert across == pytest.approx(expected, abs=3.0 * error), lag
    diagonal = (fields[:, :-3, :-3] * fields[:, 3:, 3:]).mean()
    assert diagonal == pytest.approx(math.exp(-18.0 / 16.0), abs=3.0 * error)  # isotropic: r = 3 sqrt(2) mm


def test_correlated_factors_are_weibull_at_any_one_place():
    """2000 seeds at one place: the sum of random waves is normal enough for the copula, its tails included."""
    x, volume = np.array([[3 * MM, 5 * MM]]), np.array([MM**2])
    k = np.array([correlated(4 * MM, seed).factors(x, volume)[0] for seed in range(2000)])
    assert kstest(k, weibull_min(3.0).cdf).pvalue > 0.01
    # 1 in 50 lies below the 2 % quantile, give or take 3 standard deviations of a count of 40
    assert np.count_nonzero(k < weibull_min(3.0).ppf(0.02)) == pytest.approx(40, abs=3.0 * math.sqrt(40))


def test_two_meshes_see_the_same_correlated_field():
    """Particles of a third of the size: every third one lies where a coarse one did and is as strong to round-off."""
    law = correlated(4 * MM, seed=3)
    coarse, fine = positions(20, 1.5 * MM), positions(60, 0.5 * MM)
    k, k_fine = law.factors(coarse, np.full(400, (1.5 * MM) ** 2)), law.factors(fine, np.full(3600, (0.5 * MM) ** 2))
    assert np.allclose(fine.reshape(60, 60, 2)[1::3, 1::3].reshape(-1, 2), coarse, rtol=0.0, atol=1e-15)
    assert k_fine.reshape(60, 60)[1::3, 1::3].ravel() == pytest.approx(k, rel=1e-9)
    assert k_fine.mean() == pytest.approx(k.mean(), rel=0.01)  # nor does their mean grow: the same field, sampled finer


def test_particle_beyond_the_correlation_volume_counts_by_its_own():
    """V_c = pi l^2 in 2D, pi^(3/2) l^3 in 3D, the integral of the correlation; scaling is continuous there."""
    for dim, volume in ((2, math.pi * 16e-6), (3, math.pi**1.5 * 64e-9)):
        law, x = correlated(4 * MM, seed=3), np.full((4, dim), 2 * MM)
        k = law.factors(x, volume * np.array([0.01, 1.0, 8.0, 64.0]))
        assert k[1:] / k[0] == pytest.approx([1.0, 0.5, 0.25], rel=1e-12)


def test_factors_are_exact_far_into_both_tails(monkeypatch):
    """-ln(1 - Phi(g)) taken by its letters is 0 at g = -9, a particle that fails at once, and infinite at g = 9."""
    monkeypatch.setattr(Weibull, "_gaussian", lambda self, x: np.array([-9.0, 9.0]))
    k = VARIED.factors(np.zeros((2, 2)), np.full(2, 1e-6))
    assert k**3 == pytest.approx([norm.sf(9.0), -norm.logsf(9.0)], rel=1e-9)


@pytest.mark.parametrize("length", [0.0, 4 * MM])
def test_seed_alone_decides(length):
    law, x, volume = replace(VARIED, correlation_length=length), positions(30, MM), np.full(900, MM**2)
    assert np.array_equal(law.factors(x, volume), replace(law).factors(x, volume))
    other = replace(law, seed=8).factors(x, volume)
    assert abs(np.corrcoef(law.factors(x, volume), other)[0, 1]) < 0.3  # 3 of 1/sqrt of some hundred independent pieces


def test_uniform_is_one_everywhere():
    assert np.array_equal(Uniform().factors(positions(3, MM), np.full(9, 1.0)), np.ones(9))


def pulled(heterogeneity, bodies=2, **changes) -> Scene:
    """Blocks of 4 x 4 mm on a grid of 1 mm, free to move; nothing drives them but what a test does."""
    boxes = [Box(lower=(8e-3 * k, 0.0), upper=(8e-3 * k + 4e-3, 4e-3)) for k in range(bodies)]
    rock = Rock(
        density=2600.0,
        elasticity=Hooke(E=17e9, nu=0.14),
        criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=2e6),
        viscosity=NoViscosity(),
        heterogeneity=heterogeneity,
    )
    scene = Scene(
        title="blocks",
        domain=Domain(lower=(-4e-3, -4e-3), upper=(20e-3, 8e-3), dx=MM),
        bodies=tuple(Body(region=box, seeding=Jittered(amount=0.2) if k else Lattice()) for k, box in enumerate(boxes)),
        rock=rock,
        loading=Loading(start=AtRest()),
        schedule=Schedule(t_end=1e-6),
        shape=Linear(),
    )
    return replace(scene, **changes)


def strengths_by_seed(scene: Scene) -> np.ndarray:
    """What the particles of a scene must have, in the order in which they were seeded."""
    seeds = scene.particles()
    x, volume = np.concatenate([s.x for s in seeds]), np.concatenate([s.volume for s in seeds])
    return scene.rock.heterogeneity.factors(x, volume)


def test_heterogeneous_scene_survives_json():
    scene = pulled(replace(VARIED, correlation_length=2e-3))
    assert from_plain(to_plain(scene)) == scene
    with pytest.raises(SceneError, match="heterogeneity"):
        from_plain(to_plain(scene) | {"rock": to_plain(scene.rock) | {"heterogeneity": {"type": "Hooke"}}})


def test_uniform_scene_has_no_field_of_strength(taichi_f64):
    from rsmpm_ti.fields.state import Simulation
    from rsmpm_ti.solver.readout import take_snapshot

    scene = pulled(Uniform())
    sim = Simulation(scene, scene.particles())
    varied = Simulation(pulled(VARIED), scene.particles())
    assert not hasattr(sim.particles, "strength")
    assert len(varied.particles.real_components) == len(sim.particles.real_components) + 1
    assert np.array_equal(take_snapshot(sim, 0.0).strength, np.ones(128))


@pytest.mark.parametrize("length", [0.0, 3 * MM])
def test_strength_stays_with_its_particle_through_sorting(taichi_f64, length):
    from rsmpm_ti.fields.cell_order import sort_particles
    from rsmpm_ti.fields.state import Simulation
    from rsmpm_ti.solver.readout import take_snapshot

    scene = pulled(replace(VARIED, correlation_length=length))
    expected, sim = strengths_by_seed(scene), Simulation(scene, scene.particles())
    assert np.array_equal(take_snapshot(sim, 0.0).strength, expected)
    before = sim.particles.id.to_numpy()
    # every particle to another cell: the picture is mirrored, so cell order is turned round
    u = sim.particles.u.to_numpy()
    u[:] = np.array([12e-3, 4e-3]) - 2.0 * sim.particles.reference.to_numpy()
    sim.particles.u.from_numpy(u)
    sort_particles(sim)
    assert not np.array_equal(sim.particles.id.to_numpy(), before)
    assert np.array_equal(take_snapshot(sim, 0.0).strength, expected)


def test_particle_fails_at_its_own_strength_and_no_other(taichi_f64):
    """Stress is given, not computed: uniaxial tension and compression at 1 % below and above each particle's own."""
    from rsmpm_ti.fields.cell_order import sort_particles
    from rsmpm_ti.fields.state import Simulation
    from rsmpm_ti.mpm.passes import Pass
    from rsmpm_ti.mpm.stepper import gather_all

    scene = pulled(VARIED)
    k, ucs = strengths_by_seed(scene), scene.rock.criterion.ucs
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    fraction = np.where(np.arange(128) % 2 == 0, 0.99, 1.01)
    axial = k * fraction * np.where(np.arange(128) < 64, 2e6, -ucs)
    sigma = np.zeros((128, 4))
    sigma[:, 1] = axial
    sim.particles.sigma.from_numpy(sigma[sim.particles.id.to_numpy()])
    gather_all(sim, Pass(stress=True), 1e-12, 0.0)  # nodes are at rest: the stress stays and is checked
    order = np.argsort(sim.particles.id.to_numpy())
    expected = np.where(fraction > 1.0, np.where(np.arange(128) < 64, 1, 2), 0)
    assert np.array_equal(sim.particles.mode.to_numpy()[order], expected)
    events = sim.events
    own, recorded = events.id.to_numpy()[:64], events.sigma_1.to_numpy()[:64] + events.sigma_3.to_numpy()[:64]
    assert recorded == pytest.approx(axial[own], rel=1e-12)  # an event keeps the stress itself, not its fraction of k


@pytest.mark.thorough
def test_specimen_first_fails_at_its_weakest_particle():
    """Stress is uniform until then: UCS of the rock times the smallest factor, at that particle's place."""
    # the paper's rule, by which a particle fails when its own stress reaches its strength
    settings = {"rock.nonlocal_mean": "Local", "rock.after_failure": "CompressionOnly", "domain.dx": "0.0025"}
    scene = load_scene("intact_weibull", quick=True, time_scale=40.0, strain_end=3.8e-4, settings=settings)
    # on a lattice: the scene's jitter makes stress noise of 2 %
    scene = replace(scene, shape=Linear(), bodies=(replace(scene.bodies[0], seeding=Lattice()),))
    x, k = scene.particles()[0].x, strengths_by_seed(scene)
    result = simulate(scene, threads=1)
    # steps of 0.1 % of the load, and inertia of the scaled mass: 0.1 % of the intact specimen's strength at 40
    assert result.summary["first_failure_stress_Pa"] == pytest.approx(25.520e6 * k.min(), rel=0.005)
    assert result.summary["first_failure_mode"] == "shear"
    assert result.summary["first_failure_position_m"] == pytest.approx(x[k.argmin()], abs=0.1 * MM)
    assert np.array_equal(result.snapshot.strength, k)
