"""A calibration from its start to its records."""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from rsmpm_ti.calibrate.evaluations import Evaluation, Evaluations, Spent
from rsmpm_ti.calibrate.experiment import Laboratory
from rsmpm_ti.calibrate.fit import fit, slopes, start_of
from rsmpm_ti.calibrate.picture import draw
from rsmpm_ti.calibrate.record import Calibration, write_records, write_table
from rsmpm_ti.calibrate.targets.measured import Wanted
from rsmpm_ti.calibrate.targets.parameter import own_value
from rsmpm_ti.calibrate.uncertainty import Uncertainty, uncertainty_of
from rsmpm_ti.output.lock import Lock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet


def calibrate(
    sheet: DataSheet,
    wanted: Wanted,
    *,
    measure: Laboratory,
    out: Path,
    command: str = "",
    say: Callable[[Evaluation], None] = lambda one: None,
) -> Calibration | None:
    """Fit the wanted parameters of a sheet; None where no evaluation came to an end. Writes the records to `out`.

    measure: the laboratory, or what stands in for it; what it found before is kept in `out` and used again.
    Raises SceneError where files cannot be used, or another process has the folder.
    """  # fmt: skip
    out.mkdir(parents=True, exist_ok=True)
    with Lock(out):
        return _calibrate(sheet, wanted, measure, out, command, say)


def _calibrate(sheet, wanted: Wanted, measure: Laboratory, out: Path, command: str, say) -> Calibration | None:

    def told(one: Evaluation) -> None:
        write_table(out, evaluations)
        say(one)

    evaluations = Evaluations(wanted, sheet, measure, out, told)
    own = np.array([p.place(own_value(sheet, p.key)) for p in wanted.parameters])
    start = start_of(evaluations, own)
    if start is None:
        return None
    ended = fit(evaluations, start)
    best = evaluations.best
    assert best is not None
    found = Calibration(wanted=wanted, sheet=sheet, best=best, ended=ended, uncertainty=_uncertainty(evaluations, best))
    write_table(out, evaluations)
    write_records(out, found, evaluations, command)
    draw(out, found, evaluations)
    return found


def _uncertainty(evaluations: Evaluations, best: Evaluation) -> Uncertainty | None:
    try:
        jacobian, unknown = slopes(evaluations, best.place)
    except Spent:
        return None
    return uncertainty_of(evaluations.wanted, best.place, jacobian, unknown)
