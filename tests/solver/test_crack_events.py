"""When a particle that softens counts as failed, what it has lost by then, and that an open crack is no instability."""

import math

import numpy as np
import pytest
import taichi as ti

from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.failure.stress_update import check_failure, update_stress
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.output.files import write_events
from rsmpm_ti.rock.after_failure import Clipped, CompressionOnly
from rsmpm_ti.rock.broken.crack_return import MIN_CRACK_STRAIN
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import Local, Nonlocal
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.smeared_crack import Directional
from rsmpm_ti.rock.softening import Brittle, LinearSoftening
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.guard import guard
from rsmpm_ti.solver.readout import read_events
from rsmpm_ti.solver.survey import survey
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

pytestmark = pytest.mark.usefixtures("taichi_f64")

DX, E, NU, TENSILE, G_F = 1e-3, 17e9, 0.14, 2e6, 10.0
M = E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU))
STEP = 1e-6
"""Strain of the slowest particle in a step: 0.9 % of what the rock bears."""


def cell(after_failure, rule=Local()) -> Simulation:  # noqa: B008
    """Four particles in one cell; the band of a crack is one cell with linear functions."""
    scene = Scene(
        title="cell",
        domain=Domain(lower=(0.0, 0.0), upper=(DX, DX), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(DX, DX))),),
        rock=Rock(
            density=2600.0,
            elasticity=Hooke(E=E, nu=NU),
            criterion=MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=TENSILE),
            viscosity=NoViscosity(),
            after_failure=after_failure,
            nonlocal_mean=rule,
        ),
        loading=Loading(),
        schedule=Schedule(t_end=1e-6),
        shape=Linear(),
    )
    sim = Simulation(scene, scene.particles())
    sort_particles(sim)
    return sim


@ti.kernel
def pull(sim: ti.template(), steps: int, size: float):
    """Strain every particle along y, each 10 % faster than the one before, with the number of the step as time."""
    for p in range(sim.particles.count):
        for k in range(steps):
            L = size * (1.0 + 0.1 * p) * ti.Matrix([[0.0, 0.0], [0.0, 1.0]])
            sim.particles.L[p] = L
            update_stress(sim, p, L, 1.0)
            check_failure(sim, p, 1.0, ti.cast(k + 1, ti.f64), 0)


RATES = STEP * (1.0 + 0.1 * np.arange(4))


def test_softening_particle_fails_when_half_of_its_strength_is_lost_and_begins_before():
    """Linear softening: f (1 - w f/(2 G)), so half is lost at w = G/f, when strain is w/h + f/(2 M)."""
    sim = cell(Directional(softening=LinearSoftening(G_f_I=G_F, G_f_II=100.0)))
    pull(sim, 6000, STEP)
    events, opening = read_events(sim), G_F / TENSILE / DX
    assert len(events) == 4 and (events.mode == 1).all()
    begins = math.ceil(TENSILE / M / RATES.max())
    assert sim.events.onset[None] == pytest.approx(begins, abs=1.0)  # a step: strain is that of the mid-step increments
    expected = (opening + 0.5 * TENSILE / M) / RATES[sim.particles.id.to_numpy().argsort()[events.id]]
    assert begins < 0.1 * expected.min()
    # traction lags one step behind the opening; strain is logarithmic, half of 5e-3 of itself less
    assert events.time == pytest.approx(expected, rel=0.004, abs=2.0)


def test_brittle_particle_fails_when_it_begins_to():
    sim = cell(Directional(softening=Brittle()))
    pull(sim, 200, STEP)
    events = read_events(sim)
    assert len(events) == 4
    assert sim.events.onset[None] == events.time.min() == math.ceil(TENSILE / M / RATES.max())


@pytest.mark.parametrize("softening", [Brittle(), LinearSoftening(G_f_I=G_F, G_f_II=100.0)])
def test_ledger_is_the_sum_of_what_particles_have_lost(softening):
    sim = cell(Directional(softening=softening))
    pull(sim, 12_000, STEP)
    lost = sim.particles.history.dissipated.to_numpy() * sim.particles.volume.to_numpy()
    assert (lost > 0.0).all()
    booked = sim.ledger.released.to_numpy().sum()
    if isinstance(softening, LinearSoftening):
        assert booked == pytest.approx(lost.sum(), rel=1e-12)
        # all strength is gone at w = 2 G/f, strain 1e-2: each has lost G per area of crack, so G/h per volume; by then
        # rock is 1 % longer, and a step's lag costs half of its load times strain
        assert lost == pytest.approx(G_F / DX * (0.5 * DX) ** 2, rel=0.02)
    else:  # what was stored: f^2/(2 M), or of the step that exceeds it; half of a step of it is not booked
        assert 0.0 < lost.sum() - booked <= 1.01 * RATES.max() * M / TENSILE * lost.sum()
        assert lost == pytest.approx(0.5 * TENSILE**2 / M * (0.5 * DX) ** 2, rel=2.5 * RATES.max() * M / TENSILE)


def test_strength_is_lost_by_the_mean_opening_and_a_particle_fails_by_its_own():
    """The particle's own opening costs f w at full strength; half of that would be given back on closing."""
    sim = cell(Directional(softening=LinearSoftening(G_f_I=G_F, G_f_II=100.0)), Nonlocal(length=2.0 * DX))
    particles, half = sim.particles, G_F / TENSILE / DX  # the strain at which half of the strength is lost
    particles.mode.fill(1)
    particles.history.crack_normal.fill(ti.Vector([0.0, 1.0]))
    particles.history.crack_strain_max.fill(MIN_CRACK_STRAIN)
    particles.crack_strain_max_nonlocal.fill(MIN_CRACK_STRAIN)
    pull(sim, 3000, STEP)
    assert particles.sigma.to_numpy()[:, 1] == pytest.approx(np.full(4, TENSILE), rel=1e-6)
    assert sim.events.count[None] == 0
    pull(sim, 3000, STEP)
    opening = particles.history.crack_strain.to_numpy()[:, 0]
    assert (opening > half).all() and sim.events.count[None] == 4  # of its own, though nothing is lost yet
    J, volume = particles.J.to_numpy(), particles.volume.to_numpy()
    assert particles.history.dissipated.to_numpy() == pytest.approx(0.5 * TENSILE * opening * J, rel=0.01)
    for mean, left in ((half, 0.5), (0.5 * half, 0.5), (3.0 * half, 0.0)):  # what is lost does not come back
        particles.crack_strain_nonlocal.fill(mean)
        pull(sim, 2, STEP)
        assert particles.sigma.to_numpy()[:, 1] == pytest.approx(np.full(4, left * TENSILE), abs=1.0)
    # what had been left to give back, half of f w, is lost with the strength
    dissipated = particles.history.dissipated.to_numpy()
    assert dissipated == pytest.approx(TENSILE * opening * J, rel=0.01)
    assert sim.ledger.released.to_numpy().sum() == pytest.approx((dissipated * volume).sum(), rel=1e-12)


@pytest.mark.parametrize("mode", [1, 2])
def test_gaping_crack_does_not_stop_a_run_and_rock_stretched_as_far_does(mode):
    """Pieces may part as far as they like: J of a particle between them is then a distance, not a deformation."""
    sim = cell(Directional())
    clock, J = Clock(sim), np.ones(4)
    J[2] = 30.0
    sim.particles.J.from_numpy(J)
    failed = np.zeros(4, dtype=np.int32)
    failed[2] = mode
    sim.particles.mode.from_numpy(failed)
    state = survey(sim)
    assert state.J_max == 1.0
    guard(sim, clock, state)
    sim.particles.mode.from_numpy(np.roll(failed, 1))  # another particle has failed
    with pytest.raises(UnstableRun, match=r"J = 1 \.\. 30 at step 0"):
        guard(sim, clock, survey(sim))
    sim.particles.mode.from_numpy(failed)
    sim.particles.J.from_numpy(np.where(failed > 0, 0.01, 1.0))  # collapse is collapse, cracked or not
    with pytest.raises(UnstableRun, match=r"J = 0\.01 \.\. 1 at step 0"):
        guard(sim, clock, survey(sim))


@pytest.mark.parametrize("law", [CompressionOnly(), Clipped(tension_limit=1e6, compression_limit=1e9)], ids=str)
def test_failed_particle_that_gapes_stops_a_run_only_if_it_still_pulls(law):
    """Fragments fly apart with failed rock between them, which carries nothing at any J above 1; a clipped law does."""
    sim = cell(law)
    sim.particles.J.fill(30.0)
    sim.particles.mode.fill(1)
    if isinstance(law, CompressionOnly):
        guard(sim, Clock(sim), survey(sim))
        sim.particles.mode.fill(0)
    with pytest.raises(UnstableRun, match="J = 30"):
        guard(sim, Clock(sim), survey(sim))


def test_events_name_the_normal_of_their_crack(tmp_path):
    """Pulled along y, cracks have their normal at 90 degrees, in the table and in the file; the paper's have none."""
    sim = cell(Directional(softening=Brittle()))
    pull(sim, 200, STEP)
    events = read_events(sim)
    assert np.abs(np.sin(events.crack_angle)) == pytest.approx(np.ones(4), abs=1e-9)
    write_events(tmp_path / "events.csv", events)
    header, *rows = (tmp_path / "events.csv").read_text().splitlines()
    assert header.endswith(",crack_normal_deg") and len(rows) == 4
    assert all(abs(float(row.split(",")[-1])) == pytest.approx(90.0) for row in rows)
    assert read_events(cell(CompressionOnly())).crack_angle is None
