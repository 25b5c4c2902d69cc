"""How the search went: the misfit and the parameters over the evaluations."""

from pathlib import Path

import numpy as np

from rsmpm_ti.calibrate.evaluations import Evaluations
from rsmpm_ti.calibrate.record import Calibration
from rsmpm_ti.paint.words import drawable
from rsmpm_ti.records.files import complete

FILE = "convergence.png"


def draw(out: Path, calibration: Calibration, evaluations: Evaluations) -> None:
    from matplotlib.figure import Figure
    from matplotlib.ticker import MaxNLocator

    wanted, done = calibration.wanted, list(evaluations.done.values())
    number = np.array([one.number for one in done])
    rms = np.sqrt([one.misfit / len(one.residuals) for one in done])
    figure = Figure(figsize=(9.0, 7.0), dpi=120, layout="constrained")
    above, below = figure.subplots(2, 1, sharex=True)
    known = np.isfinite(rms)
    above.semilogy(number[known], np.maximum(rms[known], 1e-6), "o", color="0.6", label="evaluation")
    best = np.minimum.accumulate(np.where(known, rms, np.inf))
    above.semilogy(number, np.where(np.isfinite(best), np.maximum(best, 1e-6), np.nan), "-k", label="best so far")
    for k in number[~known]:
        above.axvline(k, color="tab:red", linewidth=1.0)
    above.axhline(1.0, color="0.8", linestyle="--", label="the errors of the targets")
    above.set_ylabel("rms of the residuals [errors]")
    above.legend(frameon=False)
    above.set_title(drawable(f"{calibration.sheet.name}: {calibration.ended}"))
    places = np.array([one.place for one in done])
    for k, parameter in enumerate(wanted.parameters):
        (line,) = below.plot(number, places[:, k], "o-", markersize=3.0, linewidth=0.8, label=parameter.key)
        if calibration.uncertainty is not None:
            interval = calibration.uncertainty.intervals[parameter.key]
            ends = [parameter.place(interval.lower), parameter.place(interval.upper)]
            x = number[-1] + 1.0 + 0.5 * k
            below.plot([x, x], ends, color=line.get_color(), linewidth=3.0 if interval.identifiable else 1.0)
            below.plot(x, parameter.place(calibration.best.values[parameter.key]), "s", color=line.get_color())
    below.set_xlabel("evaluation (at the right: the best, with 95 % intervals)")
    below.set_ylabel("place between the bounds")
    below.set_ylim(-0.03, 1.03)
    below.legend(frameon=False, ncols=len(wanted.parameters), loc="upper center")
    below.xaxis.set_major_locator(MaxNLocator(integer=True))
    with complete(out / FILE) as part:
        figure.savefig(part)
