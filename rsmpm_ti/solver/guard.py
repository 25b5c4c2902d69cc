"""The guard that stops a run whose numbers mean nothing any more."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti.errors import BrokenApart, UnstableRun
from rsmpm_ti.fields.records import most_events
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
    """Stop a run whose numbers mean nothing any more, with step, position, likely cause and remedy.

    Raises BrokenApart where all numbers are finite and all intact rock is within bounds, else UnstableRun.
    """
    whole = survey.not_finite == 0 and J_BOUNDS[0] <= survey.J_intact_min and survey.J_intact <= J_BOUNDS[1]
    kind = BrokenApart if whole else UnstableRun
    where, what = "", "have" if whole else "are not finite or"
    if survey.sick:
        reference = sim.particles.reference.to_numpy()[np.flatnonzero(sim.particles.id.to_numpy() == survey.sick_id)[0]]
        where = f" (one started at {np.array2string(1e3 * reference, precision=3)} mm)"
    at = f"at step {clock.step}, t = {clock.time:.6g} s"
    if survey.failed_tension + survey.failed_shear > sim.events.capacity:
        laws = {type(rock.after_failure).__name__: None for rock in sim.scene.rocks if rock.criterion.breaks}
        raise UnstableRun(
            f"{', '.join(laws)} made more than max_events = {most_events(sim.scene)} events of a particle {at}; likely "
            f"cause: its failed_mode changes back, or max_events is too small"
        )
    if survey.sick:
        raise kind(
            f"{survey.sick} particles {what} left the domain {at}{where}; likely cause: a time step too "
            f"long for this loading, or fragments flying off; lower schedule.cfl, enlarge the domain, or take "
            f"domain.outside = drop or grow"
        )
    if survey.J_min < J_BOUNDS[0] or survey.J_max > J_BOUNDS[1]:
        raise kind(
            f"a particle has J = {survey.J_min:.3g} .. {survey.J_max:.3g} {at}, outside {J_BOUNDS}; likely cause: "
            f"an unstable step or a collapse beyond the law; lower schedule.cfl or end the run earlier"
        )


def quiet_energy(sim: Simulation) -> float:
    """What round-off may make [J]."""
    volume = sim.particles.volume.to_numpy().sum(dtype=np.float64)
    return float(0.5 * sim.density * sim.wave_speed**2 * QUIET_STRAIN**2 * volume)


@dataclass(frozen=True, kw_only=True)
class EnergyBooks:
    """Energy [J] of a run, up to its latest history row.

    Errors are held against `turnover`, not against what is there at the moment: a specimen that is unloaded holds
    nothing, but what it has held has passed through it, and each time with an error of its own.
    """

    start: float  # kinetic and elastic, with which the run started
    quiet: float  # what round-off may make
    work: float = 0.0  # since the start
    exchanged: float = 0.0  # sum of |work| between rows, in either direction
    most: float = 0.0  # largest kinetic + elastic + dissipated of any row
    created: float = 0.0  # kinetic + elastic + dissipated beyond the start and the work

    def after(self, survey: Survey) -> "EnergyBooks":
        """With one more row."""
        present = survey.kinetic + survey.elastic + survey.dissipated
        return replace(
            self, work=survey.work, exchanged=self.exchanged + abs(survey.work - self.work),
            most=max(self.most, present), created=present - survey.work - self.start,
        )  # fmt: skip

    @property
    def turnover(self) -> float:
        """The most energy that the run has held, or that has passed through it."""
        return max(self.most, self.start + self.exchanged)

    @property
    def sound(self) -> bool:
        """Whether what came from nowhere is a small part of it; False for NaN."""
        return self.created <= CREATED_FRACTION * self.turnover + self.quiet


def guard_energy(sim: Simulation, clock: Clock, survey: Survey, books: EnergyBooks) -> None:
    """Stop a run that makes energy: kinetic + elastic + dissipated exceed what it started with and the work since.

    It is for a history, not for `guard`, which also sees states that were changed by hand on the way.
    """
    if not books.sound:
        velocity, position = sim.particles.v.to_numpy(), sim.particles.reference.to_numpy() + sim.particles.u.to_numpy()
        fastest = int(np.argmax(np.linalg.norm(velocity, axis=1)))
        raise UnstableRun(
            f"{books.created:.3g} J, {100.0 * books.created / books.turnover:.0f} % of the energy that the run has "
            f"held, came from nowhere at step {clock.step}, t = {clock.time:.6g} s; the fastest particle, "
            f"{survey.speed:.3g} m/s, is at {np.array2string(1e3 * position[fastest], precision=3)} mm; likely cause: "
            f"a time step too long for this shape function and transfer, or particles that cross cells with linear "
            f"functions; lower schedule.cfl, or take QuadraticBSpline"
        )
