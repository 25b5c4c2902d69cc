"""Tests of scenes count with the smallest numbers there are; and data sheets in files."""

import ctypes
import ctypes.util
import sys

import pytest
from granite import text_of


@pytest.fixture(scope="module", autouse=True)
def denormal_numbers():
    """Numbers below 2.2e-308 are numbers, whatever ran before: `ti.init` of Taichi 1.7.4 has its thread round them to
    zero from then on."""
    if sys.platform == "linux":  # elsewhere FE_DFL_ENV is another address
        ctypes.CDLL(ctypes.util.find_library("m")).fesetenv(ctypes.c_void_p(-1))


@pytest.fixture
def sheet(tmp_path):
    """Writes a sheet and gives its path."""

    def write(values: dict[str, str] | str, head: str = "") -> str:
        path = tmp_path / "granite.toml"
        path.write_text(values if isinstance(values, str) else text_of(values, head), encoding="utf-8")
        return str(path)

    return write
