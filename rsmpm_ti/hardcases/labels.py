"""The failure check where its arithmetic is delicate: repeated principal stresses, the apex, ties of both criteria."""

import numpy as np
import taichi as ti

from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most
from rsmpm_ti.hardcases.pieces import PAPER
from rsmpm_ti.rock.tensors import extreme_principals

INTACT, TENSION, SHEAR = 0, 1, 2


@ti.kernel
def _judge(criterion: ti.template(), length: ti.template(), sigma: ti.types.ndarray(), out: ti.types.ndarray()):
    for p in range(sigma.shape[0]):
        packed = ti.Vector.zero(float, length)
        for k in ti.static(range(length)):
            packed[k] = sigma[p, k]
        extremes = extreme_principals(packed)
        out[p, 0], out[p, 1] = extremes[0], extremes[1]
        out[p, 2] = criterion.mode(extremes[0], extremes[1])


def failure_labels(sigma: np.ndarray, kind) -> tuple[np.ndarray, np.ndarray]:
    """(extreme principal stresses [n, 2], label [n]) of packed stresses [n, 4 or 6], computed in float32 or float64."""
    out = np.zeros((len(sigma), 3), dtype=kind)
    _judge(PAPER, sigma.shape[1], np.ascontiguousarray(sigma, dtype=kind), out)
    return out[:, :2].astype(float), out[:, 2].astype(int)


def exact_extremes(sigma: np.ndarray) -> np.ndarray:
    """Largest and smallest eigenvalue [n, 2], by NumPy."""
    full = np.zeros((len(sigma), 3, 3))
    for k, (a, b) in enumerate(((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))[: sigma.shape[1]]):
        full[:, a, b] = full[:, b, a] = sigma[:, k]
    return np.linalg.eigvalsh(full)[:, [2, 0]]


def repeated(length: int, perturbation: float) -> np.ndarray:
    """Stresses with two or three equal principal values, from -50 to 7 MPa, each moved by a fraction of itself."""
    levels = 1e6 * np.array([-50.0, -16.0, -1.0, 0.0, 1.9, 2.0, 7.0])
    states = [[p, p, q, 0.0, 0.0, 0.0][:length] for p in levels for q in (p, 0.14 * 2.0 * p, 0.0, -p)]
    states = np.array(states)
    noise = np.random.default_rng(3).standard_normal(states.shape)
    return states + perturbation * np.abs(states).max(axis=1, keepdims=True) * noise


PROPORTIONAL = 400
"""Directions of stress along which the load rises."""


def turns(kind, length: int) -> int:
    """How often a label changes after the first failure, or comes back to intact, as the load factor rises."""
    directions = np.random.default_rng(4).standard_normal((PROPORTIONAL, length))
    extremes = exact_extremes(directions)
    size = np.maximum(extremes[:, 0] / 2e6, (extremes[:, 0] - extremes[:, 1]) / 25e6)
    factors = np.linspace(0.0, 4.0, 200)
    states = factors[:, None, None] * (directions / size[:, None])
    label = failure_labels(states.reshape(-1, length), kind)[1].reshape(states.shape[:2])
    return int(np.sum((label[:-1] != INTACT) & (label[1:] == INTACT)))


def _roots(kind, length: int) -> list[Row]:
    eps, where = float(np.finfo(kind).eps), f"{np.dtype(kind).name}, {'3D' if length == 6 else 'plane strain'}"
    worst, bad = 0.0, 0
    for perturbation in (0.0, 1e-12):
        states = repeated(length, perturbation)
        found, _ = failure_labels(states, kind)
        bad += int(np.sum(~np.isfinite(found)))
        scale = np.maximum(np.abs(states).max(axis=1, keepdims=True), 1.0)
        worst = max(worst, float(np.max(np.abs(found - exact_extremes(states.astype(kind).astype(float))) / scale)))
    if length == 4:
        limit, why = 8.0 * eps, "centre +- hypot: round-off of a few sums"
    else:
        limit, why = 8.0 * eps**0.5, "the cubic's double root: round-off becomes its square root"
    back = turns(kind, length)
    return [
        at_most(f"{where}: principal stresses that are not finite", bad, 0.0, "no division by what may vanish"),
        at_most(f"{where}: error at repeated roots over the stress", worst, limit, why),
        at_most(f"{where}: labels that go back as the load rises", back, 0.0, "both criteria are convex and hold 0"),
    ]


def _hydrostatic(kind) -> list[Row]:
    """Pressure never breaks, +2 MPa from all sides does, in tension."""
    pull = np.array([[p, p, p, 0.0] for p in (1.999e6, 2.0e6, 2.001e6, 7.09e6, 50e6, -50e6, 0.0)])
    wrong = int(np.sum(failure_labels(pull, kind)[1] != [INTACT, TENSION, TENSION, TENSION, TENSION, INTACT, INTACT]))
    why = "cut-off first: the apex at 7.09 MPa is never asked"
    return [at_most(f"{np.dtype(kind).name}: wrong labels under equal stress from all sides", wrong, 0.0, why)]


def _ties(kind) -> list[Row]:
    """The corner where cut-off and Mohr-Coulomb meet, (+2, -16.322) MPa, and just beside it; 1000 copies each."""
    phi = np.radians(40.0)
    low = (2e6 * (1.0 + np.sin(phi)) - 2.0 * 5.95e6 * np.cos(phi)) / (1.0 - np.sin(phi))
    beside = 64.0 * float(np.finfo(kind).eps)
    states = [
        (2e6, low, TENSION),
        (2e6 * (1.0 + beside), low, TENSION),
        (2e6 * (1.0 + beside), low * (1.0 + beside), TENSION),
        (2e6 * (1.0 - beside), low * (1.0 + beside), SHEAR),
        (2e6 * (1.0 - beside), low * (1.0 - beside), INTACT),
    ]
    sigma = np.repeat([[s1, s3, 0.0, 0.0] for s1, s3, _ in states], 1000, axis=0)
    expected = np.repeat([label for _, _, label in states], 1000)
    wrong = int(np.sum(failure_labels(sigma, kind)[1] != expected))
    why = "tension is asked first, and nothing depends on threads"
    return [at_most(f"{np.dtype(kind).name}: wrong labels at the corner, of 5000", wrong, 0.0, why)]


def _in_both_precisions(rows_of) -> Outcome:
    rows = []
    for name, kind in (("f32", np.float32), ("f64", np.float64)):
        start_taichi(name, "cpu", 1)
        rows += rows_of(kind)
    return Outcome(tuple(rows))


def repeated_roots(full: bool) -> Outcome:
    """10: equal principal stresses, and perturbations of 1e-12 of them."""
    return _in_both_precisions(lambda kind: [*_roots(kind, 4), *_roots(kind, 6), *_hydrostatic(kind)])


def ties(full: bool) -> Outcome:
    """11: a stress that reaches both criteria at once."""
    return _in_both_precisions(_ties)


CASES = (
    Case("repeated_roots", "10: equal principal stresses, the apex, 1e-12 beside them", repeated_roots),
    Case("ties", "11: a stress that reaches tension and Mohr-Coulomb at once", ties),
)
