"""How well the targets fix the parameters, by a straight model of the residuals near the best.

With residuals r in errors and places u between the bounds, J = dr/du at the best. Errors of the targets, independent
and normal, then give u the covariance (J^T J)^-1 (Press et al. 2007, Numerical Recipes, 3rd ed., 15.6). With
J = U S V^T a step of length 1, the width of the bounds, along a column of V moves the residuals by its singular value.
"""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.calibrate.targets.measured import Wanted

NORMAL = 1.96
"""Half of a 95 % interval, in standard deviations."""

LEAST = 2.0 * NORMAL
"""Singular value below which a combination is not identifiable: its 95 % interval is as wide as the bounds."""

MOST = 0.8
"""Part of the bounds that a 95 % interval covers from which on a parameter is not identifiable."""

NAMED = 0.2
"""Share of a combination from which on a parameter is named."""

ALONE = 0.95
"""Share from which on a combination is of one parameter alone."""

SMALLEST = 1e-9
"""Of a singular value, in place of 0."""


@dataclass(frozen=True, kw_only=True)
class Interval:
    """lower, upper: of 95 %, cut off at the bounds [SI, degrees]; identifiable: whether the targets fix the parameter;
    why: where they do not."""

    lower: float
    upper: float
    identifiable: bool
    why: str = ""


@dataclass(frozen=True, kw_only=True)
class Uncertainty:
    """intervals: by key; singular: of J, largest first; directions: rows, of V^T; unseen: sentences about combinations
    that the targets do not tell apart."""

    intervals: dict[str, Interval]
    singular: np.ndarray
    directions: np.ndarray
    unseen: tuple[str, ...]


def uncertainty_of(wanted: Wanted, place: np.ndarray, jacobian: np.ndarray, unknown: list[str]) -> Uncertainty:
    """place: the best, [parameters]; jacobian: [rows, parameters]; unknown: keys whose column could not be had."""
    _, found, directions = np.linalg.svd(jacobian, full_matrices=True)
    singular = np.zeros(len(place))
    singular[: len(found)] = found
    scaled = directions.T / np.maximum(singular, SMALLEST)
    half = NORMAL * np.sqrt((scaled**2).sum(axis=1))
    lower, upper = np.clip(place - half, 0.0, 1.0), np.clip(place + half, 0.0, 1.0)
    keys = [p.key for p in wanted.parameters]
    unseen = {k: _sentence(keys, directions[k]) for k in range(len(keys)) if singular[k] < LEAST}
    involved = {key for k in unseen for key, share in zip(keys, directions[k], strict=True) if abs(share) >= NAMED}
    intervals = {}
    for k, parameter in enumerate(wanted.parameters):
        why = ""
        if parameter.key in unknown:
            why = "differences by it failed, or the budget had none left"
        elif parameter.key in involved:
            why = "part of a combination that the targets do not tell apart"
        elif upper[k] - lower[k] >= MOST:
            why = f"its 95 % interval covers {100.0 * (upper[k] - lower[k]):.0f} % of its bounds"
        intervals[parameter.key] = Interval(
            lower=parameter.at(lower[k]), upper=parameter.at(upper[k]), identifiable=not why, why=why
        )
    return Uncertainty(intervals=intervals, singular=singular, directions=directions, unseen=tuple(unseen.values()))


def _sentence(keys: list[str], direction: np.ndarray) -> str:
    """A combination in words: `+0.71 E with -0.71 nu`, in widths of their bounds."""
    order = np.argsort(-np.abs(direction))
    direction = direction * np.sign(direction[order[0]])
    if direction[order[0]] >= ALONE:
        return f"the targets hardly depend on {keys[order[0]]} within its bounds"
    parts = [f"{direction[k]:+.2f} {keys[k]}" for k in order if abs(direction[k]) >= NAMED]
    return f"the targets do not tell apart {' with '.join(parts)}, in widths of their bounds"
