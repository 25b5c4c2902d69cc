"""Tensor algebra against NumPy: packing, principal stresses, finite rotation, in 2D and 3D, f64 and f32."""

import numpy as np
import pytest
import taichi as ti
from harness import epsilon, flat, matrix, on_rows, rounded, vector

from rsmpm_ti.mpm.plain import PLACES, tensor
from rsmpm_ti.rock.tensors import (
    PACKED_LENGTH,
    double_contraction,
    extreme_principals,
    hughes_winget,
    in_frame,
    isotropic,
    midpoint_gradient,
    out_of_frame,
    pack,
    principal_angle,
    principal_normal,
    rotate,
    rotated_vector,
    symmetric,
    trace,
    unpack,
)
from rsmpm_ti.solver.readout import extreme_stresses

both_dims = pytest.mark.parametrize("dim", [2, 3])


def packed(full, dim: int) -> np.ndarray:
    return np.stack([full[:, a, b] for a, b in PLACES[: PACKED_LENGTH[dim]]], axis=1)


def random_packed(dim: int, real, n: int = 200) -> np.ndarray:
    return rounded(np.random.default_rng(11).normal(size=(n, PACKED_LENGTH[dim])), real)


def rotation(angle, axis) -> np.ndarray:
    """Rodrigues' formula, [3, 3]; angle in radians."""
    K = np.cross(np.eye(3), np.asarray(axis) / np.linalg.norm(axis))
    return np.eye(3) + np.sin(angle) * K + (1.0 - np.cos(angle)) * K @ K


def rotations(dim: int, angles) -> np.ndarray:
    axes = np.random.default_rng(5).normal(size=(len(angles), 3))
    return np.stack([rotation(t, (0, 0, 1) if dim == 2 else a) for t, a in zip(angles, axes, strict=True)])


def cayley(gradient) -> np.ndarray:
    """R = (1 - W/2)^-1 (1 + W/2) of each gradient [n, dim, dim], embedded in 3D."""
    W = np.zeros((len(gradient), 3, 3))
    dim = gradient.shape[1]
    W[:, :dim, :dim] = 0.5 * (gradient - gradient.transpose(0, 2, 1))
    return np.linalg.solve(np.eye(3) - 0.5 * W, np.eye(3) + 0.5 * W)


def principals(s, dim: int, real) -> np.ndarray:
    length = PACKED_LENGTH[dim]

    @ti.func
    def extremes(a: ti.template(), p):
        return extreme_principals(vector(a, p, 0, length))

    return on_rows(extremes, s, 2, real)


@both_dims
def test_unpack_and_pack_are_inverse_and_put_shears_where_the_packing_says(taichi_real, dim):
    length = PACKED_LENGTH[dim]

    @ti.func
    def unpacked(a: ti.template(), p):
        return flat(unpack(vector(a, p, 0, length)))

    @ti.func
    def there_and_back(a: ti.template(), p):
        return pack(unpack(vector(a, p, 0, length)), length)

    s = random_packed(dim, taichi_real)
    np.testing.assert_array_equal(on_rows(unpacked, s, 9, taichi_real), tensor(s).reshape(-1, 9))
    np.testing.assert_array_equal(on_rows(there_and_back, s, length, taichi_real), s)


@both_dims
def test_linear_operations_agree_with_full_tensors(taichi_real, dim):
    length = PACKED_LENGTH[dim]

    @ti.func
    def operations(a: ti.template(), p):
        s, b = vector(a, p, 0, length), vector(a, p, length, length)
        return ti.Vector([trace(s), double_contraction(s, b)])

    s, b = np.split(random_packed(dim, taichi_real, 400), 2)
    found = on_rows(operations, np.concatenate([s, b], axis=1), 2, taichi_real)
    full = tensor(s)
    expected = np.column_stack([np.trace(full, axis1=1, axis2=2), np.einsum("pde,pde->p", full, tensor(b))])
    # sums of at most 9 products of numbers of size 1 to 4
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=100 * epsilon(taichi_real))


@both_dims
def test_isotropic_and_symmetric_parts(taichi_real, dim):
    length = PACKED_LENGTH[dim]

    @ti.func
    def sphere(a: ti.template(), p):
        return isotropic(a[p, 0], length)

    @ti.func
    def strain(a: ti.template(), p):
        return symmetric(matrix(a, p, 0, dim))

    G = rounded(np.random.default_rng(3).normal(size=(50, dim, dim)), taichi_real)
    full = np.zeros((50, 3, 3))
    full[:, :dim, :dim] = 0.5 * (G + G.transpose(0, 2, 1))
    found = on_rows(strain, G.reshape(50, -1), length, taichi_real)
    np.testing.assert_allclose(found, packed(full, dim), rtol=0.0, atol=8 * epsilon(taichi_real))
    identity = packed(7.0 * np.eye(3)[None], dim)
    np.testing.assert_array_equal(on_rows(sphere, [[7.0]], length, taichi_real), identity)


@both_dims
def test_extreme_principals_are_those_of_numpy_where_roots_are_apart(taichi_real, dim):
    s = random_packed(dim, taichi_real, 2000)
    values = np.linalg.eigvalsh(tensor(s))
    apart = np.diff(values, axis=1).min(axis=1) > 0.3
    assert apart.sum() > 200
    found = principals(s[apart], dim, taichi_real)
    # at a gap of 0.3 the roots of the cubic are known to about 40 round-offs
    np.testing.assert_allclose(found, values[apart][:, [2, 0]], rtol=0.0, atol=200 * epsilon(taichi_real))


def repeated_roots(dim: int) -> np.ndarray:
    """Two equal principal stresses, the pair above or below the third, along turned axes; sizes 1e-3 to 1e8."""
    values = np.array([(1, 1, -2), (2, -1, -1), (0, 0, -25.52), (2, 0, 0), (-50, -50, -14), (5, -3, -3.0)])
    R = rotations(dim, np.linspace(0.0, 3.0, 13))
    full = np.einsum("rab,vb,rcb->vrac", R, values, R).reshape(-1, 3, 3)
    return np.concatenate([packed(full, dim) * size for size in (1e-3, 1.0, 1e6)])


@both_dims
@pytest.mark.parametrize("size", [1e-12, 0.0, 1e-7])
def test_extreme_principals_of_repeated_roots_and_near_them(taichi_real, dim, size):
    s = np.concatenate([repeated_roots(dim), packed(np.eye(3) * np.array([-3e6, 0.0, 2.0])[:, None, None], dim)])
    noise = np.random.default_rng(8).normal(size=s.shape) * np.abs(s).max(axis=1, keepdims=True)
    s = rounded(s + size * noise, taichi_real)
    found, expected = principals(s, dim, taichi_real), np.linalg.eigvalsh(tensor(s))[:, [2, 0]]
    assert np.isfinite(found).all()
    assert (found[:, 0] >= found[:, 1] - 1e-30).all()
    # 3D: a double root of the cubic is known to sqrt(2 eps); centre +- hypot in the plane knows every root to round-off
    fraction = 16 * epsilon(taichi_real) if dim == 2 else 2.0 * np.sqrt(epsilon(taichi_real))
    # (in 3D, deviators below 1e-10 Pa count as none)
    scale = np.abs(s).max(axis=1, keepdims=True)
    assert (np.abs(found - expected) <= fraction * scale + 2e-10 * (dim == 3)).all()


@both_dims
def test_extreme_stresses_of_a_snapshot_are_those_of_an_eigenvalue_solver(dim):
    stress = 1e6 * random_packed(dim, ti.f64)
    exact = np.linalg.eigvalsh(tensor(stress))
    largest, smallest = extreme_stresses(stress)
    np.testing.assert_allclose(largest, exact[:, 2], rtol=0.0, atol=1e-8)  # round-off of stresses of some MPa
    np.testing.assert_allclose(smallest, exact[:, 0], rtol=0.0, atol=1e-8)
    stress[0, 0], stress[1, 1] = np.nan, np.inf
    assert np.isfinite(extreme_stresses(stress)).all(), "a run that became unstable is still painted"


@both_dims
def test_hydrostatic_state_has_one_principal_stress(taichi_real, dim):
    pressures = rounded([2e6, -25.52e6, 1e-9, 0.0, 3.0], taichi_real)
    s = packed(np.eye(3) * pressures[:, None, None], dim)
    found = principals(s, dim, taichi_real)
    np.testing.assert_allclose(
        found, np.stack([pressures, pressures], axis=1), rtol=4 * epsilon(taichi_real), atol=1e-9
    )


def test_out_of_plane_stress_counts_as_principal(taichi_real):
    s = np.array([[1.0, 2.0, 9.0, 0.1], [1.0, 2.0, -9.0, 0.1]])
    found = principals(s, 2, taichi_real)
    assert found[0, 0] == 9.0 and found[1, 1] == -9.0


@both_dims
def test_midpoint_gradient_of_a_finite_rotation_is_skew_with_twice_the_half_angle_tangent(taichi_real, dim):
    @ti.func
    def midpoint(a: ti.template(), p):
        return flat(midpoint_gradient(matrix(a, p, 0, dim)))

    angles = np.linspace(-2.9, 2.9, 60)
    R = rotations(dim, angles)
    found = on_rows(midpoint, (R - np.eye(3))[:, :dim, :dim].reshape(60, -1), dim * dim, taichi_real)
    found = found.reshape(60, dim, dim)
    # (1 + G/2) loses 1/cos^2 of half the angle in round-offs towards half a turn: 70 at 2.9
    limit = 30 * epsilon(taichi_real) / np.cos(0.5 * angles) ** 2
    assert (np.abs(found + found.transpose(0, 2, 1)).max(axis=(1, 2)) < limit).all()
    K = (R - R.transpose(0, 2, 1)) / (2.0 * np.sin(angles))[:, None, None]
    expected = 2.0 * np.tan(0.5 * angles)[:, None, None] * K[:, :dim, :dim]
    assert (np.abs(found - expected).max(axis=(1, 2)) < limit * (1.0 + np.abs(expected).max(axis=(1, 2)))).all()


@both_dims
def test_midpoint_gradient_of_a_stretch_is_referred_to_the_middle(taichi_real, dim):
    @ti.func
    def midpoint(a: ti.template(), p):
        return flat(midpoint_gradient(matrix(a, p, 0, dim)))

    stretch = rounded([0.5, -0.25, 0.125][:dim], taichi_real)
    found = on_rows(midpoint, np.diag(stretch).reshape(1, -1), dim * dim, taichi_real).reshape(dim, dim)
    np.testing.assert_allclose(found, np.diag(stretch / (1.0 + 0.5 * stretch)), atol=4 * epsilon(taichi_real))


def rotated(s, G, dim: int, real) -> np.ndarray:
    length = PACKED_LENGTH[dim]

    @ti.func
    def turn(a: ti.template(), p):
        return rotate(vector(a, p, 0, length), matrix(a, p, length, dim))

    return on_rows(turn, np.concatenate([s, G.reshape(len(s), -1)], axis=1), length, real)


@both_dims
def test_rotate_is_the_cayley_rotation_of_the_skew_part(taichi_real, dim):
    s = random_packed(dim, taichi_real)
    G = rounded(np.random.default_rng(4).normal(size=(len(s), dim, dim)), taichi_real)
    R = cayley(G)
    expected = packed(R @ tensor(s) @ R.transpose(0, 2, 1), dim)
    np.testing.assert_allclose(rotated(s, G, dim, taichi_real), expected, rtol=0.0, atol=60 * epsilon(taichi_real))


@both_dims
def test_rotate_by_the_midpoint_of_a_finite_rotation_is_that_rotation(taichi_real, dim):
    """The sense of rotation, too: a stress along x turned by +90 degrees about z lies along y."""
    angles = np.concatenate([[np.pi / 2], np.linspace(-2.5, 2.5, 40)])
    R = rotations(2, angles) if dim == 2 else np.concatenate([rotations(2, angles[:1]), rotations(3, angles[1:])])
    G = 2.0 * (R - np.eye(3)) @ np.linalg.inv(R + np.eye(3))
    s = random_packed(dim, taichi_real, 41)
    s[0] = 0.0
    s[0, 0] = 1.0
    found = rotated(s, G[:, :dim, :dim], dim, taichi_real)
    expected = packed(R @ tensor(s) @ R.transpose(0, 2, 1), dim)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=100 * epsilon(taichi_real))
    assert found[0, 1] == pytest.approx(1.0, abs=10 * epsilon(taichi_real))


@both_dims
def test_rotate_keeps_invariants_for_any_increment(taichi_real, dim):
    s = random_packed(dim, taichi_real)
    for size in (1e-6, 1.0, 100.0):
        G = size * np.random.default_rng(6).normal(size=(len(s), dim, dim))
        before, after = tensor(s), tensor(rotated(s, G, dim, taichi_real))
        for invariant in (lambda t: np.trace(t, axis1=1, axis2=2), lambda t: np.sum(t * t, axis=(1, 2)), np.linalg.det):
            # each invariant is a sum of products of a few numbers of size 4; 3D forms R with entries of size W^2/W^2
            limit = 3000 * epsilon(taichi_real)
            np.testing.assert_allclose(invariant(after), invariant(before), rtol=0.0, atol=limit)


def test_stress_in_a_frame_is_that_seen_from_turned_axes(taichi_real):
    """s' = R^T s R with the columns of R the turned axes; a quarter turn swaps nn and tt. And back again."""

    @ti.func
    def seen(a: ti.template(), p):
        s, n = vector(a, p, 0, 4), vector(a, p, 4, 2)
        there = in_frame(s, n)
        back = out_of_frame(there, n)
        return ti.Vector([there[0], there[1], there[2], there[3], back[0], back[1], back[2], back[3]])

    s = random_packed(2, taichi_real, 61)
    angles = np.concatenate([[0.5 * np.pi], np.linspace(-7.0, 7.0, 60)])
    s[0] = [1.0, 2.0, 3.0, 4.0]
    R = rotations(2, angles)
    expected = packed(R.transpose(0, 2, 1) @ tensor(s) @ R, 2)
    found = on_rows(seen, np.column_stack([s, R[:, 0, 0], R[:, 1, 0]]), 8, taichi_real)
    # a few products of stresses of size 4 and of squares of a unit vector, which itself is rounded
    np.testing.assert_allclose(found[:, :4], expected, rtol=0.0, atol=60 * epsilon(taichi_real))
    np.testing.assert_allclose(found[:, 4:], s, rtol=0.0, atol=60 * epsilon(taichi_real))
    np.testing.assert_allclose(found[0, :4], [2.0, 1.0, 3.0, -4.0], rtol=0.0, atol=30 * epsilon(taichi_real))


def test_unit_vector_turns_as_stress_does(taichi_real):
    """Against a finite rotation; and for any gradient a turned stress in the turned frame is what it was before."""

    @ti.func
    def turned(a: ti.template(), p):
        return rotated_vector(vector(a, p, 4, 2), matrix(a, p, 0, 2))

    @ti.func
    def difference(a: ti.template(), p):
        G, n, s = matrix(a, p, 0, 2), vector(a, p, 4, 2), vector(a, p, 6, 4)
        moved, _ = hughes_winget(s, G)
        return in_frame(moved, rotated_vector(n, G)) - in_frame(s, n)

    rng, angles = np.random.default_rng(13), np.linspace(-2.9, 2.9, 60)
    R = rotations(2, angles)[:, :2, :2]
    n = np.stack([np.cos(7.0 * angles), np.sin(7.0 * angles)], axis=1)
    found = on_rows(turned, np.column_stack([(R - np.eye(2)).reshape(60, 4), n]), 2, taichi_real)
    # half the angle's tangent is a ratio of numbers that lose 1/cos of it near half a turn
    limit = 50 * epsilon(taichi_real) / np.cos(1.45) ** 2
    np.testing.assert_allclose(found, np.einsum("nij,nj->ni", R, n), rtol=0.0, atol=limit)
    G = np.concatenate([rng.uniform(-0.8, 0.8, size=(200, 4)), np.zeros((60, 4))])
    G[200:] = (R - np.eye(2)).reshape(60, 4)
    around = rng.uniform(0.0, 2.0 * np.pi, len(G))
    rows = np.column_stack([G, np.cos(around), np.sin(around), rng.normal(size=(len(G), 4))])
    left = on_rows(difference, rows, 4, taichi_real)
    np.testing.assert_allclose(left, 0.0, rtol=0.0, atol=200 * epsilon(taichi_real))


def test_principal_normal_is_the_direction_of_the_larger_stress(taichi_real):
    """Both signs of a vector are one direction: its square with NumPy's eigenvector is 1."""

    @ti.func
    def normal(a: ti.template(), p):
        return principal_normal(vector(a, p, 0, 4))

    s = random_packed(2, taichi_real, 40)
    _, axes = np.linalg.eigh(tensor(s)[:, :2, :2])
    along = np.einsum("ni,ni->n", on_rows(normal, s, 2, taichi_real), axes[:, :, 1])
    gap = np.hypot(s[:, 0] - s[:, 1], 2.0 * s[:, 3])
    assert (1.0 - along**2 <= 20 * epsilon(taichi_real) * (1.0 + 4.0 / gap)).all()  # round-off of s turns it by 4/gap


def test_principal_angle_is_that_of_the_larger_eigenvector(taichi_real):
    @ti.func
    def angle_of(a: ti.template(), p):
        return ti.Vector([principal_angle(vector(a, p, 0, 4))])

    s = random_packed(2, taichi_real)
    values, vectors = np.linalg.eigh(tensor(s)[:, :2, :2])
    apart = np.diff(values, axis=1)[:, 0] > 0.05  # the direction of nearly equal stresses is round-off
    assert apart.sum() > 150
    found = on_rows(angle_of, s, 1, taichi_real)[:, 0]
    normal = np.stack([np.cos(found), np.sin(found)], axis=1)
    across = np.abs(np.sum(normal * vectors[:, :, 0], axis=1))  # zero when it is the larger one's, of either sign
    assert (across[apart] < 200 * epsilon(taichi_real)).all()
    assert (np.abs(found) <= 0.5 * np.pi + epsilon(taichi_real)).all()
