"""The hot loops still become vector instructions: counted in what LLVM makes of them, in a process of its own."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from rsmpm_ti.method.shape import QuadraticBSpline

ROOT = Path(__file__).resolve().parents[2]

CHILD = """
import sys
import taichi as ti
from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.bench.workers import Runner, simulation
from rsmpm_ti.mpm.passes import Pass, g2p, p2g

real, _ = start_taichi("f64", "cpu", int(sys.argv[1]))
ti.lang.impl.current_cfg().print_kernel_llvm_ir_optimized = True
sim = simulation(Runner("solver", "bspline", dx=4e-3), real).sim
p2g(sim, Pass(momentum=True, force=True), 0.0, sim.traversal.ticket())
g2p(sim, Pass(velocity=True, position=True), 0.0, 0.0, sim.traversal.ticket())
g2p(sim, Pass(stress=True), 0.0, 0.0, sim.traversal.ticket())
ti.sync()
"""

FLOPS = {"p2g": 14, "velocity and position": 8, "stress": 8}
"""Fewest multiplications and additions of a pass in 2D per particle and node. p2g: sums of mass (2), momentum (4) and
force (8); velocity and position: v_pic and dv (4 each); stress: the two sums of a row, of v_i w_k and of v_i w_k'."""


def vector_arithmetic(ir: str) -> int:
    """Multiplications and additions of several double numbers at once."""
    return len(re.findall(r"= f(?:mul|add|sub)\b[a-z ]*<\d+ x double>", ir))


@pytest.mark.parametrize("threads", [1, 2])
@pytest.mark.thorough
def test_loops_over_a_run_have_vector_instructions(tmp_path, threads):
    """A branch, an atomic or a field touched first in a loop leaves nothing but single numbers, or a few pairs."""
    switches = {"TI_OFFLINE_CACHE": "0", "PYTHONPATH": str(ROOT)}
    subprocess.run(
        [sys.executable, "-c", CHILD, str(threads)],
        cwd=tmp_path, env=os.environ | switches, check=True, timeout=300, stdout=subprocess.DEVNULL,
    )  # fmt: skip
    kernels = [path.read_text() for path in sorted(tmp_path.glob("taichi_kernel_cpu_llvm_ir_optimized_*.ll"))]
    passes = [ir for ir in kernels if re.search(r"@(p2g|g2p)_c\d+_", ir)]
    assert len(passes) == len(FLOPS)
    nodes = QuadraticBSpline.width**2
    found = {name: vector_arithmetic(ir) for name, ir in zip(FLOPS, passes, strict=True)}
    assert all(found[name] >= flops * nodes for name, flops in FLOPS.items()), found
