"""What is asked of a law after failure, and what one that answers wrongly is told."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
import taichi as ti

from rsmpm_ti import AfterFailure, Output, SceneError, UnstableRun, Variable, load_scene, simulate


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Late(AfterFailure):
    """Counts as failed a while after its strength began to be lost; the count of steps has a name of its own."""

    history = (Variable(name="count", unit="1", whole=True, about="steps since"),)

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        sim.particles.history.count[p] = sim.particles.history.count[p] + 1
        return 0.0 * sim.particles.sigma[p], 0.0

    @ti.func
    def failed_mode(self, sim: ti.template(), p):
        return ti.select(sim.particles.history.count[p] > 20, sim.particles.mode[p], 0)


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Twice(AfterFailure):
    """Fails in tension and, a step later, in shear, but says that it makes one event."""

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        sim.particles.mode[p] = 3 - sim.particles.mode[p]
        return 0.0 * sim.particles.sigma[p], 0.0


def scene(law):
    cube = load_scene("cube", dx=2e-3, flaw_width=6e-3, time_scale=16.0, strain_end=2.5e-4)
    rock = replace(cube.rock, after_failure=law)
    return replace(cube, rock=rock, schedule=replace(cube.schedule, rows=40), output=Output(frames=0, vtu=0))


def test_snapshot_events_and_summary_agree_on_what_has_failed():
    """Whatever the law calls what it remembers: its `failed_mode` is asked."""
    result = simulate(scene(Late()), threads=1)
    state = result.snapshot
    begun, failed = state.history["count"] > 0, state.history["count"] > 20
    assert 0 < failed.sum() < begun.sum()
    np.testing.assert_array_equal(state.failure_mode > 0, failed)
    np.testing.assert_array_equal(np.isfinite(state.failure_time), failed)
    assert len(result.events) == failed.sum() == result.summary["failed_tension"] + result.summary["failed_shear"]


@pytest.mark.thorough
def test_law_that_makes_more_events_than_it_says_ends_the_run_and_not_the_process():
    with pytest.raises(UnstableRun, match="Twice made more than max_events = 1 events") as stopped:
        simulate(scene(Twice()), threads=1)
    assert 0 < len(stopped.value.result.events) <= stopped.value.result.summary["particles"]


def law_of(*variables, **facts) -> AfterFailure:
    kind = type("Own", (AfterFailure,), {"history": variables, **facts})
    return kind()


def variable(name: str, **more) -> Variable:
    return Variable(name=name, unit="1", about="something", **more)


@pytest.mark.parametrize("name", ["", "has space", "to_numpy", "components", "_hidden", "1st"])
def test_variable_that_no_field_can_be_called_is_refused(name):
    with pytest.raises(SceneError, match="Own.history = .* is refused"):
        scene(law_of(variable(name)))


def test_history_that_cannot_be_kept_is_refused():
    with pytest.raises(SceneError, match="that no other variable has"):
        scene(law_of(variable("a"), variable("a")))
    with pytest.raises(SceneError, match="a tuple of one ends in a comma"):
        scene(type("Own", (AfterFailure,), {"history": (variable("a"))})())
    with pytest.raises(SceneError, match="with crack_normal and crack_strain_max"):
        scene(law_of(variable("crack_normal"), oriented=True))
