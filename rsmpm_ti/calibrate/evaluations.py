"""Every set of parameters that was tried, with what it gave; each is run once and then kept."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.calibrate.experiment import Laboratory
from rsmpm_ti.calibrate.kept import FOLDER, code, keep, kept, key_of
from rsmpm_ti.calibrate.targets.measured import Found, Number, Wanted
from rsmpm_ti.calibrate.targets.parameter import with_values
from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.sheet.data_sheet import DataSheet

RUNS = "runs"
"""Folder of the runs that evaluations were made of."""

PENALTY = 1e3
"""Every residual of a point that failed, in errors: no step to it is taken."""


class Spent(Exception):
    """The budget has no evaluation left."""


@dataclass(frozen=True, kw_only=True)
class Evaluation:
    """number: from 1; place: of the parameters between their bounds, [parameters] in [0, 1]; values [SI, degrees];
    residuals: of all targets, in errors, [rows]; problem: "" where all are known; before: whether it was kept."""

    number: int
    place: np.ndarray
    values: dict[str, float]
    found: Found
    residuals: np.ndarray
    problem: str
    before: bool

    @property
    def misfit(self) -> float:
        """Sum of the squares of the residuals; inf where it failed."""
        return np.inf if self.problem else float(self.residuals @ self.residuals)


class Evaluations:
    """All of one calibration. folder: where they are kept; say: told of each as it is there."""

    def __init__(
        self, wanted: Wanted, sheet: DataSheet, measure: Laboratory, folder: Path,
        say: Callable[[Evaluation], None] = lambda one: None,
    ):  # fmt: skip
        self.wanted, self.sheet, self.measure, self.folder, self.say = wanted, sheet, measure, folder, say
        self.limit = wanted.runs
        self.done: dict[tuple[float, ...], Evaluation] = {}
        self._code = code()
        (folder / FOLDER).mkdir(parents=True, exist_ok=True)  # by it the folder is known again, whenever a kill comes

    def at(self, place: np.ndarray) -> Evaluation:
        """That of a place, [parameters] in [0, 1]. Raises Spent where it would be one beyond `limit`."""
        parameters = self.wanted.parameters
        values = {p.key: p.at(float(u)) for p, u in zip(parameters, place, strict=True)}
        known = self.done.get(tuple(values.values()))
        if known is not None:
            return known
        if len(self.done) >= self.limit:
            raise Spent
        found, before = self._found(values)
        problem, residuals = self._residuals(found)
        place = np.array([p.place(values[p.key]) for p in parameters])
        one = Evaluation(number=len(self.done) + 1, place=place, values=values, found=found, residuals=residuals,
                         problem=problem, before=before)  # fmt: skip
        self.done[tuple(values.values())] = one
        self.say(one)
        return one

    def _found(self, values: dict[str, float]) -> tuple[Found, bool]:
        try:
            rock = with_values(self.sheet, values)
        except SceneError as error:
            return Found(problem=str(error)), False
        key = key_of(rock, self.wanted, self._code)
        found = kept(self.folder / FOLDER, key)
        if found is not None:
            return found, True
        found = self.measure(rock, self.folder / RUNS / key)
        keep(self.folder / FOLDER, key, values, found)
        return found, False

    def _residuals(self, found: Found) -> tuple[str, np.ndarray]:
        """Why a point counts as failed, and its residuals, which then are the penalty."""
        try:
            residuals = self.wanted.residuals(found)
        except KeyError as error:
            raise SceneError(f"the laboratory's reports hold no {error}, which is a target") from None
        problem = found.problem
        if not problem and not np.isfinite(residuals).all():
            unknown = [t.label for t in self.wanted.targets if isinstance(t, Number) and not np.isfinite(t.got(found))]
            problem = f"{', '.join(unknown) or 'a curve'} is not defined"
        return problem, np.full(self.wanted.rows, PENALTY) if problem else residuals

    @property
    def best(self) -> Evaluation | None:
        """That of the least misfit; None where all failed."""
        sound = [one for one in self.done.values() if not one.problem]
        return min(sound, key=lambda one: one.misfit, default=None)
