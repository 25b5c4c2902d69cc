"""fitted.toml, calibration.json and evaluations.csv: what a calibration leaves."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.calibrate.evaluations import Evaluation, Evaluations
from rsmpm_ti.calibrate.targets.measured import Curve, Wanted
from rsmpm_ti.calibrate.targets.parameter import own_value, with_values
from rsmpm_ti.calibrate.uncertainty import Uncertainty
from rsmpm_ti.records.files import complete, write_csv, write_json
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.rock.sheet.writing import text_of

FITTED, RECORD, TABLE = "fitted.toml", "calibration.json", "evaluations.csv"


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What came of it. ended: why it ended; uncertainty: None where the budget had no differences left."""

    wanted: Wanted
    sheet: DataSheet
    best: Evaluation
    ended: str
    uncertainty: Uncertainty | None

    def shares(self) -> list[float]:
        """Of each target how far it is off, in its errors: |got - value|, of a curve the root mean square."""
        return [float(np.linalg.norm(target.residuals(self.best.found))) for target in self.wanted.targets]

    @property
    def met(self) -> bool:
        """Whether every target is within its error."""
        return all(share <= 1.0 for share in self.shares())

    def fitted(self) -> DataSheet:
        return with_values(self.sheet, self.best.values, why=self._why())

    def _why(self) -> str:
        said = ", ".join(target.said() for target in self.wanted.targets)
        return f"calibrated to {said}, by quick runs of rsmpm_ti {__version__}"


def write_records(out: Path, calibration: Calibration, evaluations: Evaluations, command: str) -> None:
    with complete(out / FITTED) as part:
        part.write_text(text_of(calibration.fitted()), encoding="utf-8")
    write_json(out / RECORD, record_of(calibration, evaluations, command))


def record_of(calibration: Calibration, evaluations: Evaluations, command: str) -> dict:
    """All that calibration.json holds; numbers in SI and degrees, those of targets in the unit beside them."""
    wanted, best, known = calibration.wanted, calibration.best, calibration.uncertainty
    return {
        "rsmpm_ti": __version__,
        "command": command,
        "rock": calibration.sheet.name,
        "ended": calibration.ended,
        "met": calibration.met,
        "budget": {"runs": wanted.runs, "seeds": wanted.seeds},
        "evaluations": len(evaluations.done),
        "failed": [{"number": one.number, "problem": one.problem} for one in evaluations.done.values() if one.problem],
        "best": {"number": best.number, "misfit": best.misfit, "values": best.values},
        "targets": [_target(target, share, best) for target, share in
                    zip(wanted.targets, calibration.shares(), strict=True)],
        "parameters": [_parameter(calibration, k) for k in range(len(wanted.parameters))],
        "confinements_Pa": {test: list(pressures) for test, pressures in wanted.confinements.items()},
        "singular_values": None if known is None else known.singular.tolist(),
        "combinations": None if known is None else [dict(zip((p.key for p in wanted.parameters), row, strict=True))
                                                    for row in known.directions.tolist()],
        "not_told_apart": None if known is None else list(known.unseen),
    }  # fmt: skip


def _target(target, share: float, best: Evaluation) -> dict:
    said = {"target": target.label, "unit": target.unit, "error": target.error, "error_assumed": target.assumed,
            "off_in_errors": share, "met": share <= 1.0}  # fmt: skip
    if isinstance(target, Curve):
        return said | {"file": target.file, "points": len(target.strain), "rms": target.got(best.found)}
    return said | {"value": target.value, "got": target.got(best.found)}


def _parameter(calibration: Calibration, k: int) -> dict:
    parameter = calibration.wanted.parameters[k]
    interval = None if calibration.uncertainty is None else calibration.uncertainty.intervals[parameter.key]
    return {
        "key": parameter.key, "unit": parameter.unit, "lower": parameter.lower, "upper": parameter.upper,
        "logarithmic": parameter.logarithmic, "own": own_value(calibration.sheet, parameter.key),
        "fitted": calibration.best.values[parameter.key],
        "lower_95": None if interval is None else interval.lower,
        "upper_95": None if interval is None else interval.upper,
        "identifiable": None if interval is None else interval.identifiable,
        "why": "" if interval is None else interval.why,
    }  # fmt: skip


def write_table(out: Path, evaluations: Evaluations) -> None:
    """evaluations.csv: a row each, as it stands after every one of them."""
    wanted = evaluations.wanted
    header = ["number", "before", "seconds", "misfit", *(f"{p.key} [{p.unit}]" for p in wanted.parameters),
              *(f"{t.label} [{t.unit}]" for t in wanted.targets), "problem"]  # fmt: skip
    rows = []
    for one in evaluations.done.values():
        got = [np.nan if one.problem else target.got(one.found) for target in wanted.targets]
        rows.append([one.number, int(one.before), one.found.seconds, one.misfit, *one.values.values(), *got,
                     one.problem])  # fmt: skip
    write_csv(out / TABLE, header, rows)
