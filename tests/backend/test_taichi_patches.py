"""Errors in a kernel are told as Taichi tells them, though nothing is prepared for those that do not happen."""

import textwrap

import pytest
import taichi as ti

from rsmpm_ti.backend.taichi_patches import WholeLines, hasten_compiling

pytestmark = pytest.mark.usefixtures("taichi_f64")


@ti.kernel
def wrong():
    for _ in range(1):
        print(there_is_no_such_name)  # noqa: F821


def message() -> str:
    with pytest.raises(ti.TaichiCompilationError) as error:
        wrong()
    return str(error.value)


def test_an_error_in_a_kernel_shows_its_file_line_and_place(monkeypatch):
    builder = ti.lang.ast.ast_transformer_utils
    hasten_compiling()
    hasten_compiling()
    assert builder.TextWrapper is WholeLines, "Taichi 1.7.4 has it; look again with another one"
    lines = ti.lang.kernel_impl.getsourcelines
    assert lines.cache_info() and not hasattr(lines.__wrapped__, "cache_info"), "once, whatever the number of runs"
    mine = message()
    assert __file__ in mine and "in wrong" in mine and "there_is_no_such_name" in mine and "^^^^" in mine
    monkeypatch.setattr(builder, "TextWrapper", textwrap.TextWrapper)
    theirs = message()
    assert "".join(mine.split()) == "".join(theirs.split()), "the same words; lines break elsewhere"


def test_a_taichi_without_it_is_left_alone(monkeypatch):
    monkeypatch.delattr(ti.lang.ast.ast_transformer_utils, "TextWrapper")
    monkeypatch.delattr(ti.lang.kernel_impl, "getsourcelines")
    hasten_compiling()
    assert not hasattr(ti.lang.ast.ast_transformer_utils, "TextWrapper")
    assert not hasattr(ti.lang.kernel_impl, "getsourcelines")
