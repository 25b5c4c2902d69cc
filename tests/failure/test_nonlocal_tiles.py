"""A look for cracks averages only where it must: the same means, marks and cracks as over the whole grid."""

import numpy as np
import pytest
import taichi as ti
from nonlocal_block import DX, block, positions

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.failure import crack_tracking
from rsmpm_ti.failure.nonlocal_fields import (
    mark_overloaded,
    mean_stress,
    near_overloaded,
    need_all_tiles,
    needed_tiles,
    read_crack_strains,
    sum_needed,
    sum_nonlocal,
)

LIMIT = 2e6
CELLS = 64


@ti.kernel
def read(sim: ti.template(), mean: ti.types.ndarray(), near: ti.types.ndarray()):
    for p in range(mean.shape[0]):
        near[p] = ti.cast(near_overloaded(sim, p), ti.i32)
        m = mean_stress(sim, p)
        for k in ti.static(range(4)):
            mean[p, k] = m[k]


def found(sim) -> tuple[np.ndarray, ...]:
    mark_overloaded(sim, LIMIT)
    read_crack_strains(sim)
    n = sim.particles.count
    mean, near = np.zeros((n, 4)), np.zeros(n, dtype=np.int32)
    read(sim, mean, near)
    return mean, near == 1, sim.particles.crack_strain_nonlocal.to_numpy(), sim.nonlocal_sums.overloaded.to_numpy()


@pytest.mark.parametrize("length", [2.0 * DX, 3.0 * DX])
def test_means_of_needed_tiles_are_those_of_all(taichi_f64, length):
    sim = block(CELLS, length=length)
    rng, x = np.random.default_rng(3), positions(sim)
    for x_hot, y_hot, cracked in ((5.2, 50.7, False), (31.9, 8.0, True), (63.0, 63.0, False)):
        centre = x_hot * DX, y_hot * DX
        sigma = rng.normal(size=(len(x), 4)) * 0.15 * LIMIT  # none of it near the limit
        near = np.linalg.norm(x - centre, axis=1) < 2.2 * length
        sigma[near, :3] += 2.0 * LIMIT
        sim.particles.sigma.from_numpy(sigma)
        sim.particles.mode.from_numpy((near & cracked).astype(np.int32))
        strain = np.zeros((len(x), 2))
        strain[near & cracked] = 1e-3
        sim.particles.history.crack_strain_max.from_numpy(strain)
        sum_nonlocal(sim)
        everywhere = found(sim)
        # what is left there by other looks must not be read
        sim.nonlocal_sums.sums.fill(np.nan)
        sim.nonlocal_sums.other.fill(np.nan)
        assert needed_tiles(sim, LIMIT) == 1
        skipped = np.mean(sim.nonlocal_sums.needed.to_numpy() == 0)
        assert skipped > 0.2
        sum_needed(sim)
        here = found(sim)
        overloaded = everywhere[1]
        assert overloaded.sum() > 10
        np.testing.assert_array_equal(here[1], overloaded)
        np.testing.assert_array_equal(here[3], everywhere[3])
        np.testing.assert_array_equal(here[0][overloaded], everywhere[0][overloaded])
        np.testing.assert_array_equal(here[2][near & cracked], everywhere[2][near & cracked])
    sim.particles.mode.fill(0)
    sim.particles.sigma.from_numpy(rng.normal(size=(len(x), 4)) * 0.15 * LIMIT)
    assert needed_tiles(sim, LIMIT) == 0, "nothing is near its strength"


@pytest.mark.thorough
def test_run_cracks_as_if_all_of_the_grid_were_averaged(monkeypatch):
    """On one thread, bit for bit."""
    scene = load_scene(
        "cube_lab", dx=2e-3, length=4e-3, flaw_width=6e-3, strain_end=1.3e-3, servo=False, settings={"shape": "Linear"}
    )
    once = simulate(scene, threads=1)

    def all_tiles(sim, limit):
        need_all_tiles(sim)
        return 1

    monkeypatch.setattr(crack_tracking, "needed_tiles", all_tiles)
    again = simulate(scene, threads=1)
    assert len(once.events) > 20
    for name in ("id", "time", "mode"):
        np.testing.assert_array_equal(getattr(once.events, name), getattr(again.events, name))
    np.testing.assert_array_equal(once.snapshot.sigma, again.snapshot.sigma)
