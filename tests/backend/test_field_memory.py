"""Fields read, written and filled in memory hold what Taichi's own kernels say they hold."""

import numpy as np
import pytest
import taichi as ti
from field_kinds import FIELDS, as_taichi_says, made
from taichi import _kernels

from rsmpm_ti.backend.field_memory import IN_PLACE_OF, views

pytestmark = pytest.mark.usefixtures("taichi_f64")


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


def test_no_kernel_is_compiled_for_a_second_field():
    ti.field(ti.f64, 7).fill(1.0)  # asks for the address of its root
    field, kernels = ti.field(ti.f64, 9), [getattr(_kernels, name).in_place_of for name in IN_PLACE_OF]
    other = ti.Vector.field(2, ti.f64, 9)
    before = [len(kernel._primal.compiled_kernels) for kernel in kernels]
    for each in (field, other):
        each.fill(1.0)
        each.from_numpy(each.to_numpy())
    assert [len(kernel._primal.compiled_kernels) for kernel in kernels] == before
