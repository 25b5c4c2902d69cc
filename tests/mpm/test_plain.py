"""The plain step that the passes are held to: its shape functions, and what it shares with no kernel."""

import ast
from pathlib import Path

import numpy as np
import pytest
from exact import shape_function as closed_form
from harness import name_of, variants

from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.mpm import plain
from rsmpm_ti.spec.scene import Scene


@pytest.mark.parametrize("shape", variants(Scene, "shape"), ids=name_of)
def test_its_shape_functions_are_the_closed_forms(shape):
    d = np.random.default_rng(5).uniform(-2.0, 2.0, size=400)
    for found, expected in zip(plain.shape_function(shape, d), closed_form(shape)(d), strict=True):
        np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-15)  # some round-offs of values up to 2


def test_it_knows_every_transfer():
    """PicFlip's formula is what it takes for one that it does not know."""
    assert {type(transfer) for transfer in variants(Scene, "transfer")} == {PicFlip, Apic}


def test_it_calls_no_kernel():
    """Of the package it takes a scene and the node counts of its grid alone, and no Taichi."""
    tree = ast.parse(Path(plain.__file__).read_text(encoding="utf-8"))
    taken = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    taken |= {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    assert taken == {"types", "numpy", "rsmpm_ti.fields.grid", "rsmpm_ti.spec.scene"}
