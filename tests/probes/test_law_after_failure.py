"""A law after failure of the user's own, with a memory of its own: nothing of the package knows of it.

A failed particle's deviatoric stress fades as exp(-t/tau), its pressure stays as long as it presses.
"""

import os
import signal
from dataclasses import dataclass, replace

import meshio
import numpy as np
import pytest
import taichi as ti

from rsmpm_ti import AfterFailure, Output, Variable, load_scene, simulate
from rsmpm_ti.rock.tensors import isotropic, trace

pytestmark = pytest.mark.thorough

TAU = 2e-5  # [s]


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Fading(AfterFailure):
    """s <- s exp(-dt/tau), p = max(p, 0), from the elastic trial stress of each step."""

    tau: float

    history = (
        Variable(name="age", unit="s", about="time since failure"),
        Variable(name="faded", unit="J/m^3", about="energy lost since failure, per stress-free volume"),
    )

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        h, trial = sim.particles.history, sim.particles.sigma[p]
        mean = trace(trial) / 3.0
        deviator = trial - isotropic(mean, trial.n)
        sigma = ti.exp(-dt / self.tau) * deviator + isotropic(ti.min(mean, 0.0), trial.n)
        J, elasticity = sim.particles.J[p], sim.rock.elasticity
        lost = J * (elasticity.energy(trial) - elasticity.energy(sigma))
        h.age[p] = h.age[p] + dt
        h.faded[p] = h.faded[p] + lost
        return sigma, lost

    @ti.func
    def damage(self, sim: ti.template(), p):
        return 1.0 - ti.exp(-sim.particles.history.age[p] / self.tau)


def scene():
    """The flawed specimen of the paper, coarse: part of it fails."""
    cube = load_scene("cube", dx=2e-3, flaw_width=6e-3, time_scale=16.0, strain_end=2e-4)
    return replace(
        cube,
        rock=replace(cube.rock, after_failure=Fading(tau=TAU)),
        schedule=replace(cube.schedule, rows=40),
        output=Output(frames=0, movie=False, vtu=2),
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return simulate(scene(), out=tmp_path_factory.mktemp("fading"), threads=1)


def test_what_it_remembers_is_what_happened(run):
    """Age is the time since the particle's event, and faded energy is all that failure cost."""
    state, events = run.snapshot, run.events
    failed = state.failure_mode > 0
    assert 20 < failed.sum() == len(events) < len(failed), "some have failed and some have not"
    age, faded = state.history["age"], state.history["faded"]
    assert (age[~failed] == 0.0).all() and (faded[~failed] == 0.0).all()
    # the step of the event counts
    np.testing.assert_allclose(age[failed], state.time - state.failure_time[failed] + run.summary["dt_s"], rtol=1e-9)
    of_failure = (faded * 1e-3**2).sum()  # four particles in a cell of 2 mm
    assert 0.0 < of_failure <= run.history["energy_dissipated_J"][-1], "viscosity takes the rest"


def test_margin_sees_it(run):
    state = run.snapshot
    failed = state.failure_mode > 0
    np.testing.assert_allclose(state.damage[failed], 1.0 - np.exp(-state.history["age"][failed] / TAU), rtol=1e-12)
    assert (state.margin[failed] == 0.0).all() and (state.margin[~failed] > 0.0).all()


def test_vtu_holds_it(run):
    last = sorted(run.out.glob("particles_*.vtu"))[-1]
    data = meshio.read(last).point_data
    assert {"age", "faded"} <= set(data)
    assert (np.asarray(data["age"]) > 0.0).sum() == (np.asarray(data["failure_mode"]) > 0).sum() > 0


def test_checkpoint_keeps_it_and_a_run_goes_on_to_the_same_bits(run, tmp_path):
    def stop(progress):
        if progress.fraction > 0.8:
            os.kill(os.getpid(), signal.SIGTERM)

    first = simulate(scene(), out=tmp_path, threads=1, checkpoint_every=0.0, progress=stop)
    assert first.stopped and 0 < (first.snapshot.history["age"] > 0.0).sum()
    second = simulate(scene(), out=tmp_path, threads=1, resume=True)
    assert not second.stopped
    for name, values in run.snapshot.history.items():
        np.testing.assert_array_equal(second.snapshot.history[name], values)
    np.testing.assert_array_equal(second.snapshot.sigma, run.snapshot.sigma)
