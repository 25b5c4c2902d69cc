"""Products of one-dimensional weights: what a particle and a node of its stencil are to each other.

Passes take a stencil by rows along the last axis. With k the place of a node in its row, the row's nodes share factors:

    w_ip = w_row w_k,    grad w_ip = (w_k grad w_row, w_row w_k'),

so what a row shares is computed once: w_row by `row_weight`, grad w_row by `row_gradient`; w_k = w[k, last] and
w_k' = dw[k, last].
"""

import numpy as np
import taichi as ti


def offsets(shape, dim: int) -> tuple[tuple[int, ...], ...]:
    """Node offsets of a stencil from its base node, first axis fastest: Python integers for static loops."""
    grid = np.indices((shape.width,) * dim).reshape(dim, -1)[::-1]
    return tuple(tuple(int(k) for k in column) for column in grid.T)


def rows(shape, dim: int) -> tuple[tuple[tuple[int, ...], tuple[tuple[int, tuple[int, ...], int], ...]], ...]:
    """The stencil by rows along the last axis: (offset along the other axes, its nodes), a node as (offset along the
    last axis, whole offset, place in `offsets`)."""
    stencil = offsets(shape, dim)
    others = sorted({offset[:-1] for offset in stencil})
    return tuple((r, tuple((o[-1], o, i) for i, o in enumerate(stencil) if o[:-1] == r)) for r in others)


def others(axis: int, count: int) -> tuple[int, ...]:
    """Axes 0 to count - 1 but one."""
    return tuple(d for d in range(count) if d != axis)


@ti.func
def row_weight(w: ti.template(), row: ti.template()):
    """w_row: product of the weights along all axes but the last."""
    weight = w[row[0], 0]
    for d in ti.static(range(1, w.m - 1)):
        weight *= w[row[d], d]
    return weight


@ti.func
def row_gradient(w: ti.template(), dw: ti.template(), row: ti.template()):
    """grad w_row, for each axis but the last: dw in place of w along that axis."""
    gradient = ti.Vector.zero(float, w.m - 1)
    for axis in ti.static(range(w.m - 1)):
        g = dw[row[axis], axis]
        for d in ti.static(others(axis, w.m - 1)):
            g *= w[row[d], d]
        gradient[axis] = g
    return gradient


@ti.func
def tensor_weight(w: ti.template(), offset: ti.template()):
    """w_ip: the product of one weight per axis."""
    weight = w[offset[0], 0]
    for d in ti.static(range(1, w.m)):
        weight *= w[offset[d], d]
    return weight


@ti.func
def tensor_gradient(w: ti.template(), dw: ti.template(), offset: ti.template()):
    """grad w_ip: along each axis its own gradient times the other axes' weights."""
    gradient = ti.Vector.zero(float, w.m)
    for axis in ti.static(range(w.m)):
        g = dw[offset[axis], axis]
        for d in ti.static(others(axis, w.m)):
            g *= w[offset[d], d]
        gradient[axis] = g
    return gradient
