"""Kinds of fields, and what Taichi's own kernels read from one."""

import numpy as np
import taichi as ti
from taichi import _kernels

FIELDS = {
    "numbers": lambda: ti.field(ti.f64, 7),
    "whole numbers": lambda: ti.field(ti.i32, (3, 2, 4)),
    "one number": lambda: ti.field(ti.f64, ()),
    "vectors apart": lambda: ti.Vector.field(3, ti.f64, (5, 4), layout=ti.Layout.SOA),
    "vectors whole": lambda: ti.Vector.field(3, ti.f64, (5, 4)),
    "matrices": lambda: ti.Matrix.field(2, 3, ti.f32, 6),
}


def made(name: str):
    """A field among others of its root, and entries for it that are all different."""
    before, field, behind = ti.field(ti.f32, 3), FIELDS[name](), ti.field(ti.f64, 5)
    before.fill(1.0)
    behind.fill(2.0)
    wanted = np.arange(1.0, 1.0 + field.to_numpy().size).reshape(field.to_numpy().shape) * 1.7
    return field, wanted.astype(field.to_numpy().dtype), (before, behind)


def as_taichi_says(field) -> np.ndarray:
    array = np.zeros_like(field.to_numpy())
    if isinstance(field, ti.MatrixField):
        _kernels.matrix_to_ext_arr.in_place_of(field, array, field.m == 1)
    else:
        _kernels.tensor_to_ext_arr.in_place_of(field, array)
    return array
