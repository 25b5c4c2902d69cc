"""What rocks of one scene do not share: stress-free volume, strength, and the rock that a mean is taken over."""

from dataclasses import replace

import numpy as np
import pytest
import taichi as ti
from rock_layers import DX, HARD, LAB, LAYERS, SEAM, layers

from rsmpm_ti.failure.failure_margin import margins
from rsmpm_ti.failure.nonlocal_fields import mean_stress, sum_nonlocal
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation, seeded, strength_factors
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.heterogeneity import Weibull
from rsmpm_ti.rock.nonlocal_mean import Nonlocal
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.spec.scene import Loading, Schedule


def test_bodies_under_pressure_stay_at_rest(taichi_f64):
    """Each rock starts with the volume that the pressure leaves it: no force, whatever its bulk modulus."""
    soft = replace(SEAM, density=LAB.density, criterion=Unbreakable())
    scene = layers(rocks=(None, soft, None))
    still = tuple(replace(platen, speed=0.0) for platen in scene.loading.boundaries)
    scene = replace(scene, loading=Loading(boundaries=still, confinement=5e6), schedule=Schedule(t_end=2e-5))
    drive = Drive(scene, scene.particles(), ti.f64)
    drive.advance(50)
    assert drive.survey.speed < 1e-9 and abs(drive.survey.work) < 1e-12
    J = drive.sim.particles.J.to_numpy()
    wanted = sorted(5e6 / rock.elasticity.bulk for rock in (LAB, soft))
    assert np.unique(np.round(1.0 - J, 9)) == pytest.approx(wanted, rel=1e-5)


def test_strength_is_drawn_for_each_rock_over_its_own_bodies():
    uneven = replace(SEAM, heterogeneity=Weibull(shape=6.0, reference_volume=1e-5))
    scene = layers(rocks=(None, uneven, HARD))
    seeds = scene.particles()
    all_of = seeded(scene, seeds)
    factors = strength_factors(scene, all_of)
    assert (factors[all_of.rock != 1] == 1.0).all()
    assert np.array_equal(factors[all_of.rock == 1], uneven.heterogeneity.factors(seeds[1].x, seeds[1].volume))


def test_the_rock_of_a_particle_goes_with_it_when_particles_are_sorted(taichi_f64):
    scene = layers()
    sim = Simulation(scene, scene.particles())
    x = sim.particles.reference.to_numpy()
    upside_down = np.stack([np.zeros(len(x)), LAYERS[-1] - 2.0 * x[:, 1]], axis=1)
    sim.particles.u.from_numpy(upside_down)
    sort_particles(sim)
    x = sim.particles.reference.to_numpy()
    assert not np.array_equal(sim.particles.id.to_numpy(), np.arange(len(x)))
    assert np.array_equal(sim.particles.rock.to_numpy(), np.searchsorted(LAYERS[1:-1], x[:, 1]))


@ti.kernel
def read_means(sim: ti.template(), means: ti.types.ndarray(dtype=ti.f64, ndim=1)):
    for p in sim.particles.mode:
        means[p] = mean_stress(sim, p)[1]


def test_a_mean_is_over_one_rock_and_its_own_length(taichi_f64):
    """Stress that jumps where the rocks meet is nowhere between: a mean of each is of the particles of it alone."""
    other = replace(LAB, nonlocal_mean=Nonlocal(length=3.0 * DX))
    scene = layers(rocks=(None, other, None))
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    assert [view.nonlocal_sums.reach for view in sim.nonlocal_views] == [7, 11]
    rock, x = sim.particles.rock.to_numpy(), sim.particles.reference.to_numpy()
    sigma = np.zeros((len(x), 4))
    sigma[:, 1] = np.where(rock == 0, 1e6, 5e6)
    sim.particles.sigma.from_numpy(sigma)
    for view in sim.nonlocal_views:
        means = np.empty(len(x))
        sum_nonlocal(view)
        read_means(view, means)
        assert means[rock == view.index] == pytest.approx((1e6, 5e6)[view.index], rel=1e-12)
    margin = margins(sim)["margin"]
    strength = LAB.criterion.tensile_strength
    assert margin == pytest.approx(1.0 - sigma[:, 1] / strength, abs=1e-12)
