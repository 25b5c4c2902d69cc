"""Acoustic emission: failures gathered into events as a laboratory's sensors would, their magnitudes and b-value."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.crack_path import REACH
from rsmpm_ti.analysis.neighbours import components, pairs_within
from rsmpm_ti.records.snapshot import TENSION

BIN = 0.1
"""Width dM of the magnitude bins in which the completeness magnitude is looked for."""

MIN_PARTICLES = 20
"""Fewer acoustic events than this above completeness give no b-value."""


@dataclass(frozen=True, kw_only=True)
class Catalogue:
    """Acoustic events in the order of time, shapes [a]; energies per metre of thickness in 2D."""

    time: np.ndarray  # of the first failure [s]
    position: np.ndarray  # of the first failure, the hypocentre [m], [a, dim]
    energy: np.ndarray  # released by all its failures [J]
    magnitude: np.ndarray  # (2/3) log10(energy / 1 J); NaN where no energy was released
    failures: np.ndarray  # failure events in it
    particles: np.ndarray  # particles in it: one that fails twice counts once
    shear_fraction: np.ndarray  # of its failures, by count

    def __len__(self) -> int:
        return len(self.time)


def gather(events, spacing: float, shear_speed: float) -> Catalogue:
    """Acoustic events from failures (an EventTable): connected sets of failures near each other in space and time.

    Two failures are joined when within r = REACH initial spacings [m] and within r/c_s, the time in which one can have
    set off the other; shear_speed: c_s of the rock as run, mass scaling included [m/s]. M = (2/3) log10(E / 1 J) after
    Hanks & Kanamori (1979), with the released energy in place of the seismic moment: its zero is a convention, the
    differences are not.
    """
    e, reach = len(events), REACH * spacing
    # largest difference over all axes first, from the tree; the ball in space is cut out of that box
    a, b = pairs_within(np.column_stack([events.x, shear_speed * events.time]), reach, p=np.inf)
    close = np.linalg.norm(events.x[a] - events.x[b], axis=1) <= reach
    labels = components(e, a[close], b[close])
    # failures come in the order of time, so the first of each label is its first in time
    names, first, labels = np.unique(labels, return_index=True, return_inverse=True)
    order = np.argsort(first)
    failures = np.bincount(labels, minlength=len(names))[order]
    energy = np.bincount(labels, events.released, minlength=len(names))[order]
    shear = np.bincount(labels, events.mode != TENSION, minlength=len(names))[order]
    distinct = np.unique(np.column_stack([labels, events.id]), axis=0)[:, 0]
    magnitude = np.full(len(names), np.nan)
    np.log10(energy, out=magnitude, where=energy > 0.0)
    return Catalogue(
        time=events.time[first[order]],
        position=events.x[first[order]],
        energy=energy,
        magnitude=2.0 / 3.0 * magnitude,
        failures=failures,
        particles=np.bincount(distinct, minlength=len(names))[order],
        shear_fraction=shear / np.maximum(failures, 1),
    )


@dataclass(frozen=True, kw_only=True)
class BValue:
    """Slope b of log10 N(>= M) = a - b M, its standard error, completeness magnitude and the events used."""

    b: float
    error: float
    completeness: float
    events: int


def b_value(magnitude: np.ndarray) -> BValue | None:
    """Maximum-likelihood b of magnitudes [a]; None for fewer than MIN_PARTICLES of them at or above completeness.

    b = log10(e) / (mean(M) - (M_c - dM/2)) (Aki 1965, Utsu 1965), M_c the middle of the fullest bin of width dM, the
    maximum of the curvature of N(>= M) (Wiemer & Wyss 2000); error 2.30 b^2 sqrt(sum (M - mean)^2 / (n (n - 1))) (Shi &
    Bolt 1982). Bins start at the smallest magnitude: one cut by the catalogue's end would move M_c - dM/2 below it.
    """
    magnitude = magnitude[np.isfinite(magnitude)]
    if len(magnitude) < MIN_PARTICLES:
        return None
    counts = np.bincount(((magnitude - magnitude.min()) / BIN).astype(int))
    least = magnitude.min() + BIN * int(np.argmax(counts))  # M_c - dM/2
    used = magnitude[magnitude >= least]
    n, mean = len(used), used.mean()
    if n < MIN_PARTICLES or mean == least:
        return None
    b = float(np.log10(np.e) / (mean - least))
    error = float(2.30 * b**2 * np.sqrt(np.sum((used - mean) ** 2) / (n * (n - 1))))
    return BValue(b=b, error=error, completeness=float(least + 0.5 * BIN), events=n)
