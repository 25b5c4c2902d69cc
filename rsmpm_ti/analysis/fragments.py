"""The pieces into which a specimen has broken: connected sets of intact particles. NumPy and SciPy only."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.neighbours import components, pairs_within
from rsmpm_ti.records.snapshot import INTACT, Snapshot

JOIN = 1.5
"""Intact particles are joined up to this many current spacings: across the diagonal of a lattice, not across a failed
particle."""

DUST = 4
"""Pieces of fewer particles than this are dust."""


@dataclass(frozen=True, kw_only=True)
class Fragment:
    """One piece, or all dust together. Mass per metre of thickness in 2D."""

    particles: int
    mass: float  # [kg], [kg/m] in 2D
    diameter: float  # of the disc (2D) or ball of its volume [m]; NaN for dust
    centroid: np.ndarray  # [m], [dim]
    velocity: np.ndarray  # of its mass centre [m/s], [dim]


@dataclass(frozen=True, kw_only=True)
class Fragments:
    """Fragments by falling mass; dust apart, None where there is none; mass of all particles, failed ones too [kg]."""

    pieces: tuple[Fragment, ...]
    dust: Fragment | None
    total_mass: float

    @property
    def largest_fraction(self) -> float | None:
        """Mass of the largest fragment over that of the whole specimen."""
        return self.pieces[0].mass / self.total_mass if self.pieces and self.total_mass > 0.0 else None


def find_fragments(snapshot: Snapshot, density: float | np.ndarray) -> Fragments:
    """Connected components of the intact particles at one instant; density: the rock's own, unscaled [kg/m^3], of all
    particles or of each, [n].

    A particle's mass is density times its current volume: intact rock has its initial volume to a part in a thousand.
    Particles that are not finite, after an unstable run, are left out.
    """
    sound = np.isfinite(snapshot.x).all(axis=1) & np.isfinite(snapshot.velocity).all(axis=1) & (snapshot.volume > 0.0)
    kept = sound & (snapshot.failure_mode == INTACT)
    x, velocity = snapshot.x[kept], snapshot.velocity[kept]
    masses = density * snapshot.volume
    mass, volume = masses[kept], snapshot.volume[kept]
    dim = snapshot.x.shape[1]
    labels = _components(x, volume ** (1.0 / dim))
    count = np.bincount(labels)
    total, area = np.bincount(labels, mass), np.bincount(labels, volume)
    small = count < DUST

    def piece(particles: int, whole: float, member_mass, member_x, member_v, diameter: float) -> Fragment:
        return Fragment(
            particles=particles, mass=whole, diameter=diameter,
            centroid=member_mass @ member_x / whole, velocity=member_mass @ member_v / whole,
        )  # fmt: skip

    order = np.argsort(labels, kind="stable")
    members = np.split(order, np.cumsum(count)[:-1]) if len(count) else []
    pieces = []
    for k in np.lexsort((np.arange(len(count)), -total)):
        if not small[k]:
            m = members[k]
            pieces.append(piece(int(count[k]), float(total[k]), mass[m], x[m], velocity[m], _diameter(area[k], dim)))
    dust = None
    if small.any():
        m = small[labels]
        dust = piece(int(m.sum()), float(mass[m].sum()), mass[m], x[m], velocity[m], np.nan)
    everything = float(masses[sound].sum())
    return Fragments(pieces=tuple(pieces), dust=dust, total_mass=everything)


def _components(x: np.ndarray, spacing: np.ndarray) -> np.ndarray:
    """Component of each particle, [n]; a pair is joined within JOIN times the mean of its two spacings."""
    if len(x) == 0:
        return np.zeros(0, dtype=int)
    # one swollen particle must not make every search wide
    farthest = JOIN * min(spacing.max(), 2.0 * np.median(spacing))
    a, b = pairs_within(x, farthest)
    close = np.linalg.norm(x[a] - x[b], axis=1) <= 0.5 * JOIN * (spacing[a] + spacing[b])
    return components(len(x), a[close], b[close])


def _diameter(volume: float, dim: int) -> float:
    """Of the disc or ball of this area [m^2] or volume [m^3]."""
    return float(2.0 * np.sqrt(volume / np.pi) if dim == 2 else np.cbrt(6.0 * volume / np.pi))
