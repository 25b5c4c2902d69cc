"""Fixtures that several test files share."""

import pytest
import taichi as ti


@pytest.fixture(scope="module")
def taichi_f64():
    """Taichi on the CPU in double precision; fields of earlier modules are gone afterwards."""
    ti.init(arch=ti.cpu, default_fp=ti.f64, cpu_max_num_threads=2, offline_cache=True)
