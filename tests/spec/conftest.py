"""Tests of scenes count with the smallest numbers there are."""

import ctypes
import ctypes.util
import sys

import pytest


@pytest.fixture(scope="module", autouse=True)
def denormal_numbers():
    """Numbers below 2.2e-308 are numbers, whatever ran before: `ti.init` of Taichi 1.7.4 has its thread round them to
    zero from then on."""
    if sys.platform == "linux":  # elsewhere FE_DFL_ENV is another address
        ctypes.CDLL(ctypes.util.find_library("m")).fesetenv(ctypes.c_void_p(-1))
