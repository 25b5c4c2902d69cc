"""Fields after Taichi has been started anew."""

import numpy as np
import taichi as ti
from field_kinds import as_taichi_says, made
from taichi.lang import impl


def test_fields_after_a_new_start_are_found_where_they_are(restart_taichi):
    for real in (ti.f64, ti.f32):
        restart_taichi(real)
        assert "addresses_of_roots" not in vars(impl.get_runtime()), "none is kept from before, where others lay"
        field, wanted, _ = made("vectors apart")
        field.from_numpy(wanted)
        np.testing.assert_array_equal(as_taichi_says(field), wanted)
