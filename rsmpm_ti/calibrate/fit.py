"""The least sum of squares by a Gauss-Newton method in a trust region, from differences of evaluations.

scipy's `least_squares` (trf: Branch, Coleman & Li 1999, SIAM J. Sci. Comput. 21:1) with differences of our own. It
takes no derivative of the simulation. Where Nelder and Mead's simplex sees one number of an evaluation, it sees every
target's residual: for four parameters and five targets in closed form it needs 15 to 30 evaluations and a simplex 75 to
176; where numbers are rough by 0.3 %, a simplex got stuck in 5 of 12 cases. (COBYQA, made for few evaluations, sees one
number too, and came with scipy 1.14; 1.13 is supported.) Differences are over a twentieth of the bounds, so that the
roughness of simulations, which a step of round-off size would read as a slope, hardly counts.
"""

import numpy as np

from rsmpm_ti.calibrate.evaluations import Evaluation, Evaluations, Spent

STEP = 0.05
"""Of a difference, over the width of the bounds."""

CLOSE = 0.1
"""Root mean square of the residuals, in errors, at which nothing more is to be gained."""

FEWEST_GAIN, SHORTEST_STEP = 1e-2, 2e-3
"""Relative gain of a step, and its length over that of the bounds, below which the search ends."""

EDGE = 0.02
"""Places nearer to a bound than this are no start: the first trust region would be as small."""

TRIES = 8
"""Starts that are tried where the rock's own one fails."""


class Close(Exception):
    """The targets are met far within their errors."""


def start_of(evaluations: Evaluations, own: np.ndarray) -> Evaluation | None:
    """The rock's own place, or the first that works of the middle and a few spread between the bounds; None: none does.

    own: [parameters]; brought within the bounds.
    """
    from scipy.stats import qmc

    spread = qmc.Halton(len(own), scramble=False).random(TRIES)[1:]
    for place in (np.clip(own, EDGE, 1.0 - EDGE), np.full(len(own), 0.5), *spread):
        try:
            one = evaluations.at(np.clip(place, EDGE, 1.0 - EDGE))
        except Spent:
            return None
        if not one.problem:
            return one
    return None


def slopes(evaluations: Evaluations, place: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Jacobian of the residuals by the place, [rows, parameters], and parameters whose column is not known, and 0.

    Forward differences, backward at the upper bound and where a point failed. Raises Spent.
    """
    here = evaluations.at(place)
    columns = [_column(evaluations, here, k) for k in range(len(here.place))]
    unknown = [p.key for p, column in zip(evaluations.wanted.parameters, columns, strict=True) if column is None]
    known = [np.zeros(len(here.residuals)) if column is None else column for column in columns]
    return np.stack(known, axis=1), unknown


def _column(evaluations: Evaluations, here: Evaluation, k: int) -> np.ndarray | None:
    """Slopes of the residuals by parameter k, [rows]; None where both sides failed."""
    for step in (STEP, -STEP):
        other = here.place.copy()
        other[k] += step
        if not 0.0 <= other[k] <= 1.0:
            continue
        there = evaluations.at(other)
        if not there.problem and there.place[k] != here.place[k]:
            return (there.residuals - here.residuals) / (there.place[k] - here.place[k])
    return None


def fit(evaluations: Evaluations, start: Evaluation) -> str:
    """Search from a start until the targets are met, nothing is gained, or the budget is spent but for the differences
    at the end. Returns which of them it was; the best is `evaluations.best`."""
    from scipy.optimize import least_squares

    count = len(evaluations.wanted.parameters)

    def residuals(shifted: np.ndarray) -> np.ndarray:
        one = evaluations.at(shifted - 1.0)
        if one.misfit <= CLOSE**2 * len(one.residuals):
            raise Close
        return one.residuals

    def jacobian(shifted: np.ndarray) -> np.ndarray:
        return slopes(evaluations, shifted - 1.0)[0]

    whole, evaluations.limit = evaluations.limit, evaluations.limit - count
    try:
        # from 1 to 2, as the first trust region and the shortest step are measured by the distance from 0
        found = least_squares(
            residuals, np.clip(start.place, 0.0, 1.0) + 1.0, jac=jacobian, bounds=(1.0, 2.0), method="trf",
            ftol=FEWEST_GAIN, xtol=SHORTEST_STEP, gtol=None,
        )  # fmt: skip
    except Spent:
        return f"the budget of {whole} evaluations is spent"
    except Close:
        return "the targets are met within a tenth of their errors"
    finally:
        evaluations.limit = whole
    return {2: "a further step gains less than a hundredth", 0: "too many steps"}.get(
        found.status, "a further step is too short to count"
    )
