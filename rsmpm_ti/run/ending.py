"""How a run ends before its schedule does, and is a result all the same: its load has fallen, or its specimen burst."""

from rsmpm_ti.analysis.load_curve import FilteredLoad
from rsmpm_ti.errors import BrokenApart
from rsmpm_ti.method.time_step import HELD_STRAIN
from rsmpm_ti.solver.guard import EnergyBooks
from rsmpm_ti.solver.view import View

BURST_FAILURES = 0.01
"""Least failures of a specimen that has burst, over its particles: a crack of one cell through a hundred."""

BURST_LOAD = 0.5
"""A specimen that has burst carries less than this fraction of its peak; one that yields carries more."""

BURST_CREATED = 0.1
"""Largest fraction of a run's energy that may have come from nowhere when it bursts.

Failure is booked to second order in a step, 0.2 % of the work where a whole specimen bursts (docs/stability.md);
pieces that fly apart and cross cells add a few per cent. A run that flies apart by its numbers lives on energy from
nowhere, and all of it is.
"""


def fallen(load: FilteredLoad, view: View, drop: float | None) -> str:
    """Why the run ends here if the load has fallen by `drop` of its peak since something failed, else "".

    Before a failure it is the platens or a wave that take the load away.
    """
    failures = view.survey.failed_tension + view.survey.failed_shear
    if drop is None or not failures or not load.fraction < 1.0 - drop:
        return ""
    less = f", both less the confining pressure of {load.pressure / 1e6:g} MPa" if load.pressure else ""
    return f"stopped: the load fell to {load.fraction:.2g} of its peak of {_peak(load)}{less}, at {_now(view)}"


def squeezed(view: View) -> str:
    """Why the run ends here if a platen that a force moves has gone as far as steps bear, else "".

    Rock that has failed under a held force does not stop the platen, and neither does a gap.
    """
    grid = view.sim.grid
    axes = sorted({side.axis for side in grid.held})
    if not axes or min(grid.spacing(axis) for axis in axes) > (1.0 - HELD_STRAIN) * grid.dx:
        return ""
    return (
        f"stopped: a platen that a force moves has come {100.0 * HELD_STRAIN:g} % closer, at {_now(view)}; the "
        f"specimen has given way, or nothing was in the way"
    )


def burst(load: FilteredLoad, view: View, books: EnergyBooks, error: BrokenApart) -> str:
    """Why the run ends here if its specimen has burst, else "": then its numbers have.

    It has where rock has failed in numbers, the load fell from a peak, and the energy of it all is accounted for. A
    load that a force holds does not fall.
    """
    failures = view.survey.failed_tension + view.survey.failed_shear
    fraction, created = failures / view.sim.particles.count, books.created / max(books.turnover, 1e-300)
    held = bool(view.sim.grid.held)
    if fraction < BURST_FAILURES or not (held or load.fraction < BURST_LOAD) or not created <= BURST_CREATED:
        return ""
    what = str(error).partition("; likely cause")[0]
    fell = f"after the peak of {_peak(load)}; the load had fallen to {load.fraction:.2g} of it"
    if held:
        fell = f"under a held force, {_peak(load)}"
    return (
        f"burst: {what}, {fell}, with "
        f"{failures} failures of {view.sim.particles.count} particles, and {100.0 * max(0.0, created):.2g} % of the "
        f"energy came from nowhere; for more of the flight take domain.outside = drop or a larger domain"
    )


def _peak(load: FilteredLoad) -> str:
    return f"{load.peak / 1e6:.4g} MPa at a strain of {load.peak_strain:.4g}"


def _now(view: View) -> str:
    return f"step {view.step}, t = {view.time:.6g} s, strain {view.strain:.4g}"
