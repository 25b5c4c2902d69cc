"""Every shape function of the package against its closed form, inside the grid and beside walls."""

import numpy as np
import pytest
import taichi as ti
from exact import shape_function
from harness import dtype_of, epsilon, name_of, rounded, variants, vector

from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline, fold_at_walls
from rsmpm_ti.method.tensor_product import offsets, tensor_gradient, tensor_weight
from rsmpm_ti.spec.scene import Scene

FREE = (-(10**6), 10**6)
"""Wall rows of an axis without walls."""

WALLS = (5, 11)
every_shape = pytest.mark.parametrize("shape", [*variants(Scene, "shape"), Gimp(half_width=0.5)], ids=repr)
both_dims = pytest.mark.parametrize("dim", [2, 3])
positions = pytest.mark.parametrize("position", ["free", "walls"])


@pytest.fixture(scope="module")
def kernels():
    """Compiled kernels by (shape, dim, place), for one precision at a time."""
    return {}


def weights(kernels, shape, xi, walls, real):
    """(node [n, k, dim], w_ip [n, k], grad w_ip [n, k, dim] per cell) at grid coordinates xi.

    One-dimensional values come from the package, products over axes are NumPy's; test_tensor_products ties the two.
    """
    n, dim = xi.shape
    lower, upper = (walls[0],) * dim, (walls[1],) * dim

    def compiled():
        @ti.kernel
        def run(x: ti.types.ndarray(), first: ti.types.ndarray(), values: ti.types.ndarray()):
            for p in range(x.shape[0]):
                x_p = vector(x, p, 0, dim)
                base = ti.floor(x_p - shape.shift).cast(int)
                w = fold_at_walls(shape.weights(x_p - base), base, lower, upper)
                dw = fold_at_walls(shape.gradients(x_p - base), base, lower, upper)
                for k, d in ti.static(ti.ndrange(shape.width, dim)):
                    values[p, 0, k, d] = w[k, d]
                    values[p, 1, k, d] = dw[k, d]
                for d in ti.static(range(dim)):
                    first[p, d] = base[d]

        return run

    key = (shape, dim, walls, real)
    if key not in kernels:
        kernels[key] = compiled()
    base, values = np.zeros((n, dim), dtype=np.int32), np.full((n, 2, shape.width, dim), np.nan, dtype=dtype_of(real))
    kernels[key](np.ascontiguousarray(xi, dtype=dtype_of(real)), base, values)
    stencil = np.array(offsets(shape, dim))
    return base[:, None, :] + stencil, *products(values.astype(np.float64), stencil)


def products(values, stencil):
    """(w_ip, grad w_ip) from one-dimensional values and slopes [n, 2, width, dim]."""
    axes = range(stencil.shape[1])
    w = np.prod([values[:, 0, stencil[:, d], d] for d in axes], axis=0)
    g = [np.prod([values[:, int(d == a), stencil[:, d], d] for d in axes], axis=0) for a in axes]
    return w, np.stack(g, axis=-1)


def points(position: str, dim: int, real, n: int = 300) -> np.ndarray:
    """Grid coordinates between the walls; most of those for `walls` lie within half a cell of one, two on them."""
    random = np.random.default_rng(21)
    xi = random.uniform(*WALLS, size=(n, dim))
    if position == "walls":
        near = random.uniform(0.0, 0.5, size=(n, dim))
        beside = np.where(random.uniform(size=(n, dim)) < 0.5, WALLS[0] + near, WALLS[1] - near)
        xi = np.where(random.uniform(size=(n, dim)) < 0.7, beside, xi)
        xi[0], xi[1] = WALLS
    return rounded(xi, real)


def walls_of(position: str) -> tuple[int, int]:
    return {"free": FREE, "walls": WALLS}[position]


def folded(values: np.ndarray, nodes: np.ndarray, walls) -> np.ndarray:
    """1D values [n, nodes]: v_-1 = 2 v_0 - v_1 takes the node beyond a wall out of the sum."""
    values = values.copy()
    for wall, outward in ((walls[0], -1), (walls[1], 1)):
        k = np.flatnonzero(nodes == wall)
        if len(k):
            beyond = values[:, k + outward].copy()
            values[:, k] += 2.0 * beyond
            values[:, k - outward] -= beyond
            values[:, k + outward] = 0.0
    return values


def closed_form(shape, xi, nodes, walls):
    """(w_ip, grad w_ip) at the nodes [n, k, dim], from the one-dimensional function and the rule at walls."""
    dim = xi.shape[1]
    row = np.arange(0, 18)
    axes = [
        [folded(part, row, walls) for part in shape_function(shape)(xi[:, d, None] - row)] for d in range(dim)
    ]  # [axis][value, slope][n, row]
    p = np.arange(len(xi))[:, None]
    w = np.prod([axes[d][0][p, nodes[:, :, d]] for d in range(dim)], axis=0)
    g = [np.prod([axes[d][int(d == a)][p, nodes[:, :, d]] for d in range(dim)], axis=0) for a in range(dim)]
    return w, np.stack(g, axis=-1)


@every_shape
def test_profile_is_the_closed_form(shape):
    d = np.linspace(-2.0, 2.0, 801)
    np.testing.assert_allclose(shape.profile(d), shape_function(shape)(d)[0], rtol=0.0, atol=1e-15)


@every_shape
@both_dims
@positions
def test_weights_and_gradients_are_the_closed_form(kernels, taichi_real, shape, dim, position):
    xi = points(position, dim, taichi_real)
    xi = xi[np.abs(xi * 8.0 - np.round(xi * 8.0)).min(axis=1) > 1e-3]  # at a kink the slope is a matter of taste
    nodes, w, g = weights(kernels, shape, xi, walls_of(position), taichi_real)
    expected_w, expected_g = closed_form(shape, xi, nodes, walls_of(position))
    # local coordinates carry round-off of coordinates up to 11; gimp divides it by its half width, 0.125 or more
    atol = 100 * epsilon(taichi_real)
    np.testing.assert_allclose(w, expected_w, rtol=0.0, atol=atol)
    np.testing.assert_allclose(g, expected_g, rtol=0.0, atol=atol)


@every_shape
@both_dims
@positions
def test_linear_fields_and_their_gradients_are_exact(kernels, taichi_real, shape, dim, position):
    xi = points(position, dim, taichi_real)
    nodes, w, g = weights(kernels, shape, xi, walls_of(position), taichi_real)
    # sums of 27 terms, each a weight times a distance of at most 2 cells, gradients up to 4 times as large
    atol = 200 * epsilon(taichi_real)
    away = nodes - xi[:, None, :]
    np.testing.assert_allclose(w.sum(axis=1), 1.0, rtol=0.0, atol=atol)
    np.testing.assert_allclose(g.sum(axis=1), 0.0, rtol=0.0, atol=atol)
    np.testing.assert_allclose(np.einsum("pk,pkd->pd", w, away), 0.0, rtol=0.0, atol=atol)
    moment = np.einsum("pkd,pke->pde", away, g)
    np.testing.assert_allclose(moment, np.broadcast_to(np.eye(dim), moment.shape), rtol=0.0, atol=atol)


@every_shape
@both_dims
@positions
def test_gradient_is_the_central_difference_of_the_weight(kernels, taichi_real, shape, dim, position):
    h = 1e-2
    xi = points(position, dim, taichi_real)
    eighths = xi * 8.0
    xi = xi[np.abs(eighths - np.round(eighths)).min(axis=1) > 16 * h]  # pieces join at eighths of a cell
    assert len(xi) > 50
    nodes, _, g = weights(kernels, shape, xi, walls_of(position), taichi_real)
    for axis in range(dim):
        step = np.eye(dim)[axis] * h
        ahead, behind = rounded(xi + step, taichi_real), rounded(xi - step, taichi_real)
        same_a, w_a, _ = weights(kernels, shape, ahead, walls_of(position), taichi_real)
        same_b, w_b, _ = weights(kernels, shape, behind, walls_of(position), taichi_real)
        assert (same_a == nodes).all() and (same_b == nodes).all()
        difference = (w_a - w_b) / (ahead - behind)[:, axis, None]
        # exact for pieces of second degree; round-off of weights at coordinates up to 11, divided by h
        np.testing.assert_allclose(difference, g[:, :, axis], rtol=0.0, atol=30 * epsilon(taichi_real) / h)


def scattered(nodes, w) -> np.ndarray:
    """Weights of each point on a common array of nodes."""
    out = np.zeros((len(w), *(18,) * nodes.shape[2]))
    for k in range(w.shape[1]):
        out[(np.arange(len(w)), *nodes[:, k].T)] += w[:, k]
    return out


@every_shape
@positions
def test_weights_are_continuous_across_cell_boundaries(kernels, taichi_real, shape, position):
    step = 64 * epsilon(taichi_real)
    line = np.arange(2 * WALLS[0] + 1, 2 * WALLS[1]) / 2.0  # nodes and cell centres, where base nodes change
    at = np.stack(np.meshgrid(line, line), axis=-1).reshape(-1, 2)
    before, after = (weights(kernels, shape, at + s, walls_of(position), taichi_real)[:2] for s in (-step, step))
    # slopes are at most 2 beside walls (a folded weight), the step is 2 x 64 round-offs along each axis
    assert np.abs(scattered(*before) - scattered(*after)).max() < 12 * step


@every_shape
@both_dims
def test_nodes_beyond_a_wall_get_nothing(kernels, taichi_real, shape, dim):
    xi = points("walls", dim, taichi_real)[2:]  # on the wall itself the hat has no slope
    nodes, w, g = weights(kernels, shape, xi, WALLS, taichi_real)
    beyond = ((nodes < WALLS[0]) | (nodes > WALLS[1])).any(axis=2)
    assert beyond.any() or shape.width == 2
    assert not w[beyond].any() and not g[beyond].any()


@every_shape
@both_dims
def test_on_a_wall_only_its_own_node_counts(kernels, taichi_real, shape, dim):
    xi = points("walls", dim, taichi_real)[:2]
    nodes, w, _ = weights(kernels, shape, xi, WALLS, taichi_real)
    own = (nodes == xi[:, None, :]).all(axis=2)
    assert (own.sum(axis=1) == 1).all()
    np.testing.assert_allclose(w, own.astype(float), rtol=0.0, atol=4 * epsilon(taichi_real))


@pytest.mark.parametrize("width", [2, 3])
@both_dims
def test_tensor_products(taichi_real, width, dim):
    if dim == 3 and width == 3 and taichi_real == ti.f32:
        pytest.skip("27 unrolled nodes compile for seconds; one precision is enough for products")
    inv_dx = 2.0  # per metre, with cells of half a metre, gradients are twice those per cell
    stencil = offsets({2: Linear(), 3: QuadraticBSpline()}[width], dim)
    values = rounded(np.random.default_rng(9).normal(size=(20, 2, width, dim)), taichi_real)

    @ti.kernel
    def run(a: ti.types.ndarray(), w: ti.types.ndarray(), g: ti.types.ndarray()):
        for p in range(a.shape[0]):
            value, slope = ti.Matrix.zero(float, width, dim), ti.Matrix.zero(float, width, dim)
            for k, d in ti.static(ti.ndrange(width, dim)):
                value[k, d], slope[k, d] = a[p, 0, k, d], a[p, 1, k, d]
            for k, offset in ti.static(enumerate(stencil)):
                w[p, k] = tensor_weight(value, offset)
                gradient = tensor_gradient(value, inv_dx * slope, offset)
                for d in ti.static(range(dim)):
                    g[p, k, d] = gradient[d]

    dtype = dtype_of(taichi_real)
    w, g = np.zeros((20, len(stencil)), dtype=dtype), np.zeros((20, len(stencil), dim), dtype=dtype)
    run(values.astype(dtype), w, g)
    expected_w, expected_g = products(values, np.array(stencil))
    # products of three numbers of size up to 3
    np.testing.assert_allclose(w, expected_w, rtol=0.0, atol=100 * epsilon(taichi_real))
    np.testing.assert_allclose(g, inv_dx * expected_g, rtol=0.0, atol=200 * epsilon(taichi_real))


@every_shape
@both_dims
def test_offsets_run_over_the_stencil_with_the_first_axis_fastest(shape, dim):
    stencil = offsets(shape, dim)
    assert stencil[:2] == ((0,) * dim, (1,) + (0,) * (dim - 1))
    assert len(set(stencil)) == len(stencil) == shape.width**dim


def test_every_shape_declares_what_kernels_read():
    for shape in variants(Scene, "shape"):
        assert shape.width in (2, 3, 4) and 0.0 < shape.stable_cfl < 3.0, name_of(shape)
        # no node outside the stencil of floor(x - shift) sees the particle
        xi = np.linspace(5.0, 6.0, 401)
        base = np.floor(xi - shape.shift)
        outside = np.concatenate([base - 1.0 - xi, base + shape.width - xi])
        assert np.abs(shape.profile(outside)).max() < 1e-15, name_of(shape)
