"""Made-up bands of failed particles and tables of failures, for the tests of what is measured on them."""

from types import SimpleNamespace

import numpy as np
from snapshots import snapshot_of

from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.records.snapshot import Snapshot

SPACING = 0.25e-3


def lattice(lower, upper) -> np.ndarray:
    """Places at SPACING between two corners [m], [n, 2], lower corner plus half a spacing first."""
    axes = [np.arange(a + 0.5 * SPACING, b, SPACING) for a, b in zip(lower, upper, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)


def scattered(x: np.ndarray, seed: int = 0, amount: float = 0.1) -> np.ndarray:
    """The same places moved by up to `amount` spacings on each axis, as a jittered seeding moves them."""
    return x + np.random.default_rng(seed).uniform(-amount, amount, x.shape) * SPACING


def strip(angle: float, length: float, width: float, start=(0.0, 0.0), kept: float = 1.0, seed: int = 0) -> np.ndarray:
    """Lattice places in a straight strip from `start` [m], `angle` degrees from +x, in order along it.

    width in spacings; kept: fraction of the particles that failed, at random.
    """
    t = np.radians(angle)
    along = np.array([np.cos(t), np.sin(t)])
    x = lattice((-length, -length), (length, length))
    s, k = x @ along, x @ np.array([-along[1], along[0]])
    inside = (s > 0.0) & (s < length) & (np.abs(k) < 0.5 * width * SPACING)
    x = scattered(x[inside][np.argsort(s[inside], kind="stable")], seed)
    return x[np.random.default_rng(seed + 1).random(len(x)) < kept] + np.array(start)


def failures(x, time=None, mode=1, released=1e-5, ids=None):
    """A table of failures with the columns of EventTable, sorted by time."""
    n = len(x)
    time = np.arange(n) * 1e-6 if time is None else np.asarray(time, dtype=float)
    order = np.argsort(time, kind="stable")
    columns = {
        "time": time, "x": np.asarray(x, dtype=float), "mode": np.broadcast_to(mode, n),
        "released": np.broadcast_to(released, n), "id": np.arange(n) if ids is None else np.asarray(ids),
    }  # fmt: skip
    table = SimpleNamespace(**{name: column[order] for name, column in columns.items()})
    table.sigma_1, table.sigma_3 = np.full(n, 2e6), np.zeros(n)
    return Sized(table)


class Sized(SimpleNamespace):
    """What has columns of one length, as an EventTable."""

    def __init__(self, columns: SimpleNamespace):
        super().__init__(**vars(columns))

    crack_angle = None  # of cracks without a direction

    @property
    def true_time(self) -> np.ndarray:
        return self.time

    def __len__(self) -> int:
        return len(self.time)


def history(stress_rate: float = 1e9, strain_rate: float = 0.05, end: float = 1e-2, rows: int = 101) -> np.ndarray:
    """Rows of a test whose nominal stress and strain grow in proportion to time: a row's stress is the mean over the
    interval before it, as the solver records it; the two platens differ by a tenth either way."""
    table = np.zeros(rows, dtype=[(name, float) for name in HISTORY_COLUMNS])
    table["time_s"] = np.linspace(end / rows, end, rows)
    middle = table["time_s"] - 0.5 * np.diff(table["time_s"], prepend=0.0)
    table["stress_top_Pa"], table["stress_bottom_Pa"] = 1.1 * stress_rate * middle, 0.9 * stress_rate * middle
    table["axial_strain"] = strain_rate * table["time_s"]
    return table


def snapshot(x, mode=None, displacement=None, velocity=None, volume=None) -> Snapshot:
    """Particles at positions x [n, dim] of the volume that SPACING gives."""
    return snapshot_of(
        x,
        mode,
        displacement=np.zeros_like(x) if displacement is None else displacement,
        velocity=np.zeros_like(x) if velocity is None else velocity,
        volume=np.full(len(x), SPACING ** x.shape[1]) if volume is None else volume,
    )
