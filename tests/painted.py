"""Particles, load curves and painters for the tests of pictures."""

import numpy as np
from snapshots import snapshot_of

from rsmpm_ti.paint.figure import FramePainter
from rsmpm_ti.records.history_table import HISTORY_COLUMNS

LIMIT = 2e6


def lattice(nx=40, ny=20, spacing=1e-3, lower=(0.0, 0.0)):
    x, y = np.meshgrid((np.arange(nx) + 0.5) * spacing, (np.arange(ny) + 0.5) * spacing, indexing="ij")
    return np.column_stack([x.ravel(), y.ravel()]) + lower


def snapshot(x, sigma_1=0.0, mode=None, volume=1e-6, displacement=None, time=1e-3):
    displacement = np.zeros_like(x) if displacement is None else displacement
    fields = {"sigma_1": np.full(len(x), sigma_1), "volume": np.full(len(x), volume), "displacement": displacement}
    return snapshot_of(x, mode, time=time, **fields)


def history(rows, loaded=True):
    table = np.zeros(rows, dtype=[(name, float) for name in HISTORY_COLUMNS])
    table["time_s"] = np.linspace(0.0, 1e-3, rows)
    table["axial_strain"] = np.linspace(0.0, 0.004, rows) if loaded else np.nan
    table["stress_top_Pa"] = np.linspace(0.0, 60e6, rows) if loaded else np.nan
    table["stress_bottom_Pa"] = np.linspace(0.0, 50e6, rows) if loaded else np.nan
    table["failed_tension"] = np.linspace(0.0, 80.0, rows)
    return table


def frame_painter(kind="cracks", **changes):
    options = {"lower": (0.0, 0.0), "upper": (0.05, 0.1), "stress_limit": LIMIT, "strain_limit": 5e-3}
    return FramePainter(kind=kind, **{**options, "load_limit": 80e6, **changes})
