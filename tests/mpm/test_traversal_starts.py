"""Traversals that Taichi is started anew for: which one a device takes, and steps in single precision by each."""

import pytest
import taichi as ti
from cloud import by_id, close, compare_step, free_scene, simulation
from harness import epsilon

from rsmpm_ti.fields.parallel import Chunks, Single, Slabs, traversal
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.method.transfer import PicFlip


@pytest.mark.parametrize(
    ("threads", "gpu", "deterministic", "expected"),
    [(1, False, False, Single), (2, False, False, Slabs), (1, False, True, Slabs), (2, True, False, Chunks)],
)
def test_device_and_threads_choose_the_traversal(restart_taichi, threads, gpu, deterministic, expected):
    restart_taichi(ti.f64, threads)
    assert type(traversal(100, gpu, deterministic)) is expected


@pytest.mark.thorough
def test_step_in_single_precision_is_that_of_a_plain_loop_and_the_same_by_every_traversal(restart_taichi):
    """Two threads meet at the border of their slabs."""
    scene, found = free_scene(Linear(), PicFlip(flip=0.3)), []
    for threads, gpu in ((1, False), (2, False), (2, True)):
        restart_taichi(ti.f32, threads)
        sim = simulation(scene, ti.f32, gpu)
        compare_step(scene, sim)
        found.append([by_id(sim, name) for name in ("v", "sigma", "u")])
    for one, *others in zip(*found, strict=True):
        for other in others:
            close(other, one, epsilon(ti.f32))
