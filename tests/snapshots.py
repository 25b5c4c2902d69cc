"""A Snapshot of particles for tests that look at few of its fields."""

import dataclasses

import numpy as np

from rsmpm_ti.records.snapshot import Snapshot


def snapshot_of(x: np.ndarray, mode=None, **fields) -> Snapshot:
    """Unloaded particles of 1 mm^dim at rest at x [n, dim], failed by `mode` [n], with other fields as given."""
    n, dim = x.shape
    mode = np.zeros(n, dtype=np.int8) if mode is None else np.asarray(mode, dtype=np.int8)
    unloaded = Snapshot(
        time=1e-3,
        id=np.arange(n),
        x=x,
        displacement=np.zeros_like(x),
        velocity=np.zeros_like(x),
        sigma=np.zeros((n, 3, 3)),
        sigma_1=np.zeros(n),
        sigma_3=np.zeros(n),
        volume=np.full(n, 1e-3**dim),
        strength=np.ones(n),
        failure_mode=mode,
        failure_time=np.where(mode > 0, 0.0, np.nan),
        margin=np.where(mode > 0, 0.0, 1.0),
        governs=mode,
        damage=np.where(mode > 0, 1.0, 0.0),
        aperture=np.zeros(n),
        crack_angle=np.full(n, np.nan),
    )
    return dataclasses.replace(unloaded, **fields)
