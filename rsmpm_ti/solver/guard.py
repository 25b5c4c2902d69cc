"""The guard that stops a run whose numbers mean nothing any more."""

import numpy as np

from rsmpm_ti.errors import UnstableRun
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.mpm.clock import Clock
from rsmpm_ti.solver.survey import Survey

J_BOUNDS = (0.05, 20.0)
"""A particle squeezed or stretched beyond these is no longer rock; the run has become unstable."""


CREATED_FRACTION = 0.5
"""Fraction of a run's energy that may have come from nowhere: beyond it the run has become unstable.

Runs of rock create up to 0.5 % (docs/stability.md). Velocity and stress are half a step apart, so that the energy of a
wave beats by sin(w dt/2): 0.3 for one of ten cells at CFL 1. In an unstable run the fraction tends to 1, since its
energy grows exponentially, whatever was put into it.
"""


QUIET_STRAIN = 1e-6
"""Below the energy of so much strain throughout, a hundredth of what breaks rock, round-off may make energy."""


def guard(sim: Simulation, clock: Clock, survey: Survey) -> None:
    """Stop a run whose numbers mean nothing any more, with step, position, likely cause and remedy."""
    where = ""
    if survey.sick:
        reference = sim.particles.reference.to_numpy()[np.flatnonzero(sim.particles.id.to_numpy() == survey.sick_id)[0]]
        where = f" (one started at {np.array2string(1e3 * reference, precision=3)} mm)"
    at = f"at step {clock.step}, t = {clock.time:.6g} s"
    if survey.failed_tension + survey.failed_shear > sim.events.capacity:
        law = sim.rock.after_failure
        raise UnstableRun(
            f"{type(law).__name__} made more than max_events = {law.max_events} events of a particle {at}; likely "
            f"cause: its failed_mode changes back, or max_events is too small"
        )
    if survey.sick:
        raise UnstableRun(
            f"{survey.sick} particles are not finite or left the domain {at}{where}; likely cause: a time step too "
            f"long for this loading, or fragments flying off; lower schedule.cfl, enlarge the domain, or take "
            f"domain.outside = drop or grow"
        )
    if survey.J_min < J_BOUNDS[0] or survey.J_max > J_BOUNDS[1]:
        raise UnstableRun(
            f"a particle has J = {survey.J_min:.3g} .. {survey.J_max:.3g} {at}, outside {J_BOUNDS}; likely cause: "
            f"an unstable step or a collapse beyond the law; lower schedule.cfl or end the run earlier"
        )


def quiet_energy(sim: Simulation) -> float:
    """What round-off may make [J]."""
    volume = sim.particles.volume.to_numpy().sum(dtype=np.float64)
    return float(0.5 * sim.density * sim.wave_speed**2 * QUIET_STRAIN**2 * volume)


def guard_energy(sim: Simulation, clock: Clock, survey: Survey, energy_start: float, quiet: float) -> None:
    """Stop a run that makes energy: kinetic + elastic + dissipated exceed what it started with and the work since.

    It is for a history, not for `guard`, which also sees states that were changed by hand on the way. quiet: [J].
    """
    present = survey.kinetic + survey.elastic + survey.dissipated
    created = present - survey.work - energy_start
    if not created <= CREATED_FRACTION * present + quiet:
        velocity, position = sim.particles.v.to_numpy(), sim.particles.reference.to_numpy() + sim.particles.u.to_numpy()
        fastest = int(np.argmax(np.linalg.norm(velocity, axis=1)))
        raise UnstableRun(
            f"{100.0 * created / present:.0f} % of the energy of {present:.3g} J came from nowhere at step "
            f"{clock.step}, t = {clock.time:.6g} s; the fastest particle, {survey.speed:.3g} m/s, is at "
            f"{np.array2string(1e3 * position[fastest], precision=3)} mm; likely cause: a time step too long for this "
            f"shape function and transfer, or particles that cross cells with linear functions; lower schedule.cfl, or "
            f"take QuadraticBSpline"
        )
