"""The sparse grid: every active node is visited once, whatever the size of the domain, and runs are those of the dense.

Taichi 1.7.4 skips nodes of `pointer(n).dense(8)` where n is no power of two (its issue 7112).
"""

import itertools
from dataclasses import replace

import numpy as np
import pytest
import taichi as ti

from rsmpm_ti import (
    Body,
    Disc,
    Domain,
    Hooke,
    Linear,
    Loading,
    QuadraticBSpline,
    Rock,
    Scene,
    Schedule,
    Unbreakable,
    load_scene,
    simulate,
)
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.fields.nodes import Nodes
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.domain import MARGIN
from rsmpm_ti.spec.review.memory import BLOCK

DX = 1e-3
SOME = [(5, 5), (3, 7), (6, 6), (9, 2), (12, 13), (4, 8), (1, 5), (3, 3, 3), (5, 3, 6), (2, 5, 4)]
LONG = [pytest.param(cells, marks=pytest.mark.validation) for cells in [(33, 50), *((n, 60) for n in range(20, 60))]]
ALL = [*itertools.product(range(1, 17), repeat=2), *itertools.product(range(1, 6), repeat=3)]


def flight(cells: tuple[int, ...], grid: str, at: float = 10.0) -> Scene:
    """A ball of 5 cells' radius in free flight: nothing acts on it."""
    dim = len(cells)
    ball = Body(region=Disc(centre=(at * DX,) * dim, radius=(5.0 if dim == 2 else 1.5) * DX), velocity=(10.0,) * dim)
    return Scene(
        title="free flight",
        domain=Domain(lower=(0.0,) * dim, upper=tuple(n * DX for n in cells), dx=DX, grid=grid),
        bodies=(ball,),
        rock=Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable()),
        loading=Loading(),
        shape=QuadraticBSpline() if dim == 2 else Linear(),  # whose kernels compile in seconds in 3D
        schedule=Schedule(t_end=(100 if dim == 2 else 20) * 0.5 * DX / 2600.0),
    )


@ti.kernel
def touch(nodes: ti.template(), counts: ti.template()):
    for block in ti.grouped(ti.ndrange(*counts)):
        nodes.mass[BLOCK * block] = 1.0


@ti.kernel
def visits(nodes: ti.template()) -> int:
    count = 0
    for i in ti.grouped(nodes.mass):
        count += ti.select(nodes.mass[i] >= 0.0, 1, 0)
    return count


@pytest.mark.parametrize(
    "blocks", [*SOME, *(pytest.param(b, marks=pytest.mark.validation) for b in ALL if b not in SOME)], ids=str
)
def test_every_node_of_every_active_block_is_visited_once(restart_taichi, blocks):
    restart_taichi(ti.f64)
    cells = tuple(BLOCK * n - 2 * MARGIN - 1 for n in blocks)
    scene = flight((20, 20, 20)[: len(blocks)], "sparse")
    grid = Grid(scene)
    grid.nodes = tuple(n + 2 * MARGIN + 1 for n in cells)
    nodes = Nodes(scene, grid, ti.f64, True)
    assert visits(nodes) == 0
    touch(nodes, blocks)
    assert visits(nodes) == BLOCK ** len(blocks) * np.prod(blocks)


@pytest.mark.parametrize("threads", [pytest.param(1, marks=pytest.mark.validation), 2])
@pytest.mark.parametrize("cells", [(30, 30), (13, 18, 22), *LONG], ids=str)
@pytest.mark.thorough("(13, 18, 22)-2")
def test_sparse_run_is_the_dense_one(as_written, restart_taichi, cells, threads):
    """Bit for bit on one thread, and on two: the order of particles, and so of sums, is the same."""
    found = []
    for grid in ("dense", "sparse"):
        restart_taichi(ti.f64, threads)
        drive = set_up(flight(cells, grid, at=8.0))
        drive.advance(drive.clock.total)
        found.append(take_snapshot(drive.sim, drive.clock.time))
    for name in ("x", "velocity", "sigma"):
        np.testing.assert_array_equal(getattr(found[1], name), getattr(found[0], name))
    speed = np.abs(found[1].velocity - 10.0).max()
    assert speed < 1e-9, "nothing acts on it"


@pytest.mark.parametrize(
    "change",
    [{}, *(pytest.param({"order": order}, marks=pytest.mark.validation) for order in ("usf", "usl"))],
    ids=lambda change: change.get("order", "musl"),
)
@pytest.mark.thorough
def test_sparse_run_between_rough_platens_is_the_dense_one(as_written, change):
    """Bit for bit: the grid goes with the platens, and what nodes of their planes remember is no field of the nodes."""
    scene, found = load_scene("intact", dx=5e-3, strain_end=1e-4), []
    rough = tuple(replace(platen, friction=0.4) for platen in scene.loading.boundaries)
    scene = replace(scene, loading=replace(scene.loading, boundaries=rough), **change)
    for grid in ("dense", "sparse"):
        found.append(simulate(replace(scene, domain=replace(scene.domain, grid=grid)), threads=1).snapshot)
    for name in ("x", "velocity", "sigma"):
        np.testing.assert_array_equal(getattr(found[1], name), getattr(found[0], name))
