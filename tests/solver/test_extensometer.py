"""Strain across the load: exact for uniform strain, the opening over the width for halves that part, the rock's own
Poisson ratio in a run."""

import math

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.solver.extensometer import GRIP, sides, weights

DX = 1e-3


def specimen(dim: int, jitter: float = 0.2) -> np.ndarray:
    """Two particles per cell and axis in a block whose lateral faces are flat, moved by up to `jitter` spacings."""
    edges = (10, 20, 8)[:dim]
    grid = np.stack(np.meshgrid(*(np.arange(2 * n) + 0.5 for n in edges), indexing="ij"), axis=-1).reshape(-1, dim)
    return 0.5 * DX * (grid + np.random.default_rng(1).uniform(-jitter, jitter, grid.shape))


def strain_of(x: np.ndarray, axis: int, u: np.ndarray) -> float:
    lower, upper = sides(x, axis, DX)
    whole = np.ones(len(x), dtype=bool)
    return float(weights(x, axis, lower, upper, whole) @ u[:, axis])


@pytest.mark.parametrize(("dim", "axis"), [(2, 0), (3, 0), (3, 2)])
def test_uniform_strain_is_read_exactly_whatever_else_the_specimen_does(dim, axis):
    """With shear, turning and a shift on top of it, and on particles that lie anyhow."""
    x, gradient = specimen(dim), np.random.default_rng(2).uniform(-1e-3, 1e-3, (dim, dim))
    assert strain_of(x, axis, x @ gradient.T + 0.3) == pytest.approx(gradient[axis, axis], rel=1e-9)


def test_two_halves_that_part_show_their_distance_over_the_width():
    x, gap = specimen(2, jitter=0.0), 1e-5
    u = np.zeros_like(x)
    u[x[:, 0] > 5e-3, 0] = gap
    assert strain_of(x, 0, u) == pytest.approx(gap / (10e-3 - 0.5 * DX), rel=1e-12)  # between outermost particles


def test_feet_stand_on_the_sides_over_the_middle_half_of_the_height():
    x = specimen(2)
    for side, edge in zip(sides(x, 0, DX), (0.0, 10e-3), strict=True):
        assert len(side) == 10, "one in every cell's breadth"
        assert (np.abs(x[side, 0] - edge) < 0.5 * DX).all()
        assert (np.abs(x[side, 1] - 10e-3) <= 5e-3).all()


def test_with_too_few_feet_on_sound_rock_nothing_is_read():
    x = specimen(2)
    lower, upper = sides(x, 0, DX)
    sound = np.ones(len(x), dtype=bool)
    sound[lower[: math.floor((1.0 - GRIP) * len(lower))]] = False
    gradient = np.array([[1e-3, 2e-4], [0.0, 0.0]])
    u = (x @ gradient.T)[sound]
    assert float(weights(x, 0, lower, upper, sound) @ u[:, 0]) == pytest.approx(1e-3, rel=1e-9)
    sound[lower] = False
    assert weights(x, 0, lower, upper, sound) is None


@pytest.mark.parametrize("plane_stress", [False, True])
@pytest.mark.thorough
def test_lateral_over_axial_strain_of_a_run_is_poissons_ratio(plane_stress):
    """nu in plane stress, nu/(1 - nu) in plane strain, of straining that is uniform from the first step on.

    Velocities are straight lines in space, so strains are nominal ones of finite size: lateral and axial differ from
    the ratio of small strains by the strain itself, 4e-4.
    """
    scene = load_scene("intact", dx=5e-3, strain_end=4e-4, settings={"rock.elasticity.plane_stress": plane_stress})
    history = simulate(scene, threads=1).history
    ratio = -history["lateral_strain"] / history["axial_strain"]
    assert ratio[-1] == pytest.approx(0.14 if plane_stress else 0.14 / 0.86, rel=2e-3)
    volumetric = history["volumetric_strain"]
    if plane_stress:
        assert np.isnan(volumetric).all(), "the thickness is not followed"
    else:
        np.testing.assert_allclose(volumetric, history["axial_strain"] + history["lateral_strain"], rtol=1e-12)
        assert (volumetric > 0.0).all(), "compression positive"


@pytest.mark.thorough
def test_without_an_axis_of_the_load_no_strain_is_known():
    scene = load_scene("intact", dx=5e-3, settings={"loading.boundaries": (), "strain_end": None, "t_end": 1e-5,
                                                    "loading.start": "AtRest", "schedule.rows": 3})  # fmt: skip
    assert np.isnan(simulate(scene, threads=1).history["lateral_strain"]).all()
