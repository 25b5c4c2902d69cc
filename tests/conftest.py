"""Fixtures that several test files share."""

import signal
from functools import partial

import pytest
import taichi as ti

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.fields import state
from rsmpm_ti.fields.parallel import Chunks, Single, Slabs

FIRST = ("tests/run/test_resume.py",)
"""Files with tests of half a minute: begun last, they would keep one worker waiting for the other."""


KEPT = {"taichi_f64", "taichi_real", "every_traversal"}
"""Fixtures whose Taichi a file's tests share, and with it fields that they may keep from one to the next."""


def concerns(mark, item) -> bool:
    """Whether a mark is one of this test: `thorough("a", "b")` is of the parameter sets of these names alone."""
    return mark.name != "thorough" or not mark.args or item.callspec.id in mark.args


@pytest.hookimpl(tryfirst=True)  # before those that -m leaves out are taken out
def pytest_collection_modifyitems(items) -> None:
    for item in items:
        item.own_markers = [mark for mark in item.own_markers if concerns(mark, item)]
    items.sort(key=lambda item: not item.nodeid.startswith(FIRST))
    keepers = {item.path for item in items if KEPT & set(item.fixturenames)}
    for item in items:
        # a start frees every field: what a test beside it had kept would be read from memory that is gone
        if "restart_taichi" in item.fixturenames and item.path in keepers:
            raise pytest.UsageError(f"{item.nodeid} starts Taichi anew, other tests of its file share one: move it")


def pytest_sessionstart() -> None:
    """Ctrl-C reaches tests and what they start, which would ignore it as what a shell runs in the background does."""
    if signal.getsignal(signal.SIGINT) == signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)


def start(real, threads: int = 2) -> None:
    start_taichi("f64" if real == ti.f64 else "f32", "cpu", threads)


@pytest.fixture(scope="module")
def taichi_f64():
    """Taichi on the CPU in double precision; fields of earlier modules are gone afterwards."""
    start(ti.f64)


@pytest.fixture(scope="module", params=["f64", "f32"])
def taichi_real(request):
    """The same in both precisions, the module's tests first in one, then in the other; gives ti.f64 or ti.f32."""
    real = getattr(ti, request.param)
    start(real)
    return real


@pytest.fixture
def restart_taichi():
    """start(real, threads): Taichi again, inside a test; fields are gone at every call. Ends with two threads, f64."""
    yield start
    start(ti.f64)


@pytest.fixture
def as_written(monkeypatch):
    """Arithmetic as it is written: else LLVM fuses and reorders it, on some processors not alike in two kernels."""
    monkeypatch.setattr(ti, "init", partial(ti.init, fast_math=False))


TRAVERSALS = {
    "Single": Single,
    "Slabs": lambda particle_count: Slabs(2, ordered=False),
    "Chunks": Chunks,  # the GPU's; it runs on a CPU too
}


@pytest.fixture(scope="module", params=TRAVERSALS)
def every_traversal(request):
    """The module's tests over each way to go over particles in turn; Taichi in double precision; gives its name."""
    start(ti.f64)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(state, "traversal", lambda count, gpu, deterministic: TRAVERSALS[request.param](count))
        yield request.param
