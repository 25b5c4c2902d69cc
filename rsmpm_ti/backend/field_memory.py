"""Fields read, written and filled where they lie in memory, in place of a kernel that Taichi 1.7.4 compiles for each.

Thirty milliseconds for each field and use, ten where kernels are kept: half of all kernels of a run, and most of those
of a test. Only what one process holds in one piece is read so: on a CPU, fields that are dense from their root on.
Others go through Taichi's own kernels, and so does everything in a Taichi without what is replaced here.
"""

import ctypes
import math
import numbers

import numpy as np
import taichi as ti
from taichi import _kernels
from taichi._lib import core
from taichi.lang import impl
from taichi.lang.field import ScalarField
from taichi.lang.util import to_numpy_type


@ti.kernel
def _address(field: ti.template(), dim: ti.template()) -> ti.u64:
    """Of a field's first entry; Taichi tells it to kernels only, so it is asked once for all fields of a root."""
    return ti.get_addr(field, ti.static((0,) * dim))


def views(field) -> list[np.ndarray] | None:
    """Each component of a field as a view of its memory, in the field's shape; None where there is none.

    A view lives as long as the field: until the next `ti.init`.
    """
    if impl.current_cfg().arch not in (ti.x64, ti.arm64):
        return None
    runtime = impl.get_runtime()
    runtime.materialize()  # from then on fields have their offsets
    roots = vars(runtime).setdefault("addresses_of_roots", {})  # `ti.init` makes another runtime
    found, shape, kind = [], field.shape, np.dtype(to_numpy_type(field.dtype))
    for member in field._get_field_members():
        position = member.ptr.snode()
        cell = position.parent
        root = None if cell is None else cell.parent
        if (
            root is None
            or root.type != core.SNodeType.root
            or cell.type != core.SNodeType.dense
            or any(position.offset)
        ):
            return None
        tree, offset = root.get_snode_tree_id(), cell.offset_bytes_in_parent_cell + position.offset_bytes_in_parent_cell
        if tree not in roots:
            roots[tree] = _address(ScalarField(member), len(shape)) - offset
        strides = [cell.cell_size_bytes * math.prod(shape[d + 1 :]) for d in range(len(shape))]
        length = cell.cell_size_bytes * (math.prod(shape) - 1) + kind.itemsize
        memory = (ctypes.c_char * length).from_address(roots[tree] + offset)
        found.append(np.ndarray(shape, kind, memory, strides=strides))
    return found


def _read(members: list[np.ndarray], array: np.ndarray) -> None:
    for view, entries in zip(members, _entries(members, array), strict=True):
        entries[...] = view


def _write(members: list[np.ndarray], array: np.ndarray) -> None:
    for view, entries in zip(members, _entries(members, array), strict=True):
        view[...] = entries


def _fill(members: list[np.ndarray], value) -> None:
    for view, entry in zip(members, np.broadcast_to(np.ravel(value), len(members)), strict=True):
        view[...] = entry


def _entries(members: list[np.ndarray], array: np.ndarray) -> list[np.ndarray]:
    """The parts of an array of whole vectors or matrices that belong to each component."""
    flat = array.reshape(*members[0].shape, len(members))
    return [flat[..., k] for k in range(len(members))]


IN_PLACE_OF = {
    "tensor_to_ext_arr": _read, "matrix_to_ext_arr": _read, "ext_arr_to_tensor": _write, "ext_arr_to_matrix": _write,
    "fill_field": _fill, "field_fill_python_scope": _fill,
}  # fmt: skip
"""Kernels of `taichi._kernels` by which fields are read, written and filled; Taichi looks them up at each use."""


def use_field_memory() -> None:
    """Replace the kernels, once in a process."""
    for name, own in IN_PLACE_OF.items():
        kernel = getattr(_kernels, name, None)
        if kernel is not None and not hasattr(kernel, "in_place_of"):
            setattr(_kernels, name, _where_it_can(own, kernel))


def _plain(other) -> bool:
    """Whether it is an array of numbers as this machine has them, or numbers; of anything else Taichi judges."""
    if isinstance(other, np.ndarray):
        return other.ndim > 0 and other.dtype.kind in "biuf" and other.dtype.isnative
    return isinstance(other, (numbers.Real, tuple))


def _where_it_can(own, kernel):
    def run(*arguments):
        field, other = arguments[:2] if isinstance(arguments[0], ti.Field) else arguments[1::-1]
        members = views(field) if _plain(other) else None
        if members is None:
            kernel(*arguments)
        else:
            own(members, other)

    run.in_place_of = kernel
    return run
