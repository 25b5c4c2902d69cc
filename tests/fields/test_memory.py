"""The memory that is said before a run is what its fields take."""

from dataclasses import replace

import pytest

from rsmpm_ti import Apic, load_scene
from rsmpm_ti.bench.scaling import bytes_of
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.spec.review.memory import memory_of_nodes, memory_of_particles

pytestmark = pytest.mark.usefixtures("taichi_f64")

COARSE = {"dx": 5e-3, "flaw_width": 15e-3}
SCENES = {
    "elastic": load_scene("cube", **COARSE).elastic(),
    "paper": load_scene("cube", **COARSE),
    "affine, usf": replace(load_scene("cube", **COARSE), transfer=Apic(), order="usf"),
    "lab": load_scene("cube_lab", dx=2.5e-3, flaw_width=7.5e-3, length=5e-3),
    "uneven": load_scene("intact_weibull", dx=1e-3, length=2e-3),
}


@pytest.mark.parametrize("name", SCENES)
def test_estimate_of_memory_is_what_fields_take(name):
    """But for a few numbers that are one of a kind, such as the count of events: 1 kB; and room for new cracks."""
    scene = SCENES[name]
    sim = Simulation(scene, scene.particles())
    count = sim.particles.count
    held = bytes_of(sim.particles) + bytes_of(sim.events)
    assert memory_of_particles(scene, count) == pytest.approx(held, abs=1e3)
    nodes = bytes_of(sim.nodes)
    if sim.is_nonlocal:
        sums = sim.nonlocal_sums
        nodes += sum(8 * field.n * field.shape[0] * field.shape[1] for field in (sums.sums, sums.other))
        nodes += 12 * sums.peak.shape[0] * sums.peak.shape[1]  # and which nodes are overloaded, in whole numbers
    assert memory_of_nodes(scene, count) == pytest.approx(nodes, rel=1e-12)
