"""Fields read, written and filled in memory hold what Taichi's own kernels say they hold."""

import numpy as np
import pytest
import taichi as ti
from taichi import _kernels
from taichi.lang import impl

from rsmpm_ti.backend.field_memory import IN_PLACE_OF, views

FIELDS = {
    "numbers": lambda: ti.field(ti.f64, 7),
    "whole numbers": lambda: ti.field(ti.i32, (3, 2, 4)),
    "one number": lambda: ti.field(ti.f64, ()),
    "vectors apart": lambda: ti.Vector.field(3, ti.f64, (5, 4), layout=ti.Layout.SOA),
    "vectors whole": lambda: ti.Vector.field(3, ti.f64, (5, 4)),
    "matrices": lambda: ti.Matrix.field(2, 3, ti.f32, 6),
}
pytestmark = pytest.mark.usefixtures("taichi_f64")


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


@pytest.mark.parametrize("name", FIELDS)
def test_what_is_written_is_what_taichi_reads_and_what_is_read_back(name):
    field, wanted, beside = made(name)
    assert views(field) is not None
    field.from_numpy(wanted)
    np.testing.assert_array_equal(as_taichi_says(field), wanted)
    np.testing.assert_array_equal(field.to_numpy(), wanted)
    field.fill(3)
    assert (as_taichi_says(field) == 3).all()
    assert [set(other.to_numpy()) for other in beside] == [{1.0}, {2.0}], "and nothing beside it is touched"


def test_a_vector_is_filled_component_by_component():
    field, _, _ = made("vectors apart")
    field.fill((1.0, 2.0, 3.0))
    np.testing.assert_array_equal(as_taichi_says(field), np.broadcast_to((1.0, 2.0, 3.0), (5, 4, 3)))


def test_entries_of_another_shape_are_refused():
    with pytest.raises(ValueError, match="reshape"):
        ti.Vector.field(3, ti.f64, 4).from_numpy(np.zeros((5, 3)))


def test_sparse_fields_go_through_taichi():
    field = ti.field(ti.f64)
    ti.root.pointer(ti.i, 4).dense(ti.i, 4).place(field)
    assert views(field) is None
    field[5] = 3.0
    np.testing.assert_array_equal(field.to_numpy(), 3.0 * (np.arange(16) == 5))


def test_fields_after_a_new_start_are_found_where_they_are(restart_taichi):
    for real in (ti.f64, ti.f32):
        restart_taichi(real)
        assert "addresses_of_roots" not in vars(impl.get_runtime()), "none is kept from before, where others lay"
        field, wanted, _ = made("vectors apart")
        field.from_numpy(wanted)
        np.testing.assert_array_equal(as_taichi_says(field), wanted)


def test_no_kernel_is_compiled_for_a_second_field():
    ti.field(ti.f64, 7).fill(1.0)  # asks for the address of its root
    field, kernels = ti.field(ti.f64, 9), [getattr(_kernels, name).in_place_of for name in IN_PLACE_OF]
    other = ti.Vector.field(2, ti.f64, 9)
    before = [len(kernel._primal.compiled_kernels) for kernel in kernels]
    for each in (field, other):
        each.fill(1.0)
        each.from_numpy(each.to_numpy())
    assert [len(kernel._primal.compiled_kernels) for kernel in kernels] == before
