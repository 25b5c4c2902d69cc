"""Numerical fracture: unbroken neighbours that have moved too far apart for their shape functions. NumPy only.

Two particles hold on to each other through nodes that both reach. A shape function of crack band b cells guarantees
such a node up to a distance of b dx, wherever they are in their cells; beyond it rock parts that no law has broken.
"""

import numpy as np

from rsmpm_ti.analysis.neighbours import pairs_within
from rsmpm_ti.records.snapshot import INTACT, Snapshot
from rsmpm_ti.spec.scene import Scene

NEIGHBOURS = 1.25
"""Particles that started within so many spacings are neighbours: jittered ones too, those across a corner not."""


def parted(scene: Scene, snapshot: Snapshot) -> np.ndarray:
    """Positions [m], [k, dim], in the middle of unbroken neighbours that nothing holds together any more.

    The widest gap comes first.
    """
    spacing = max(scene.domain.dx / body.seeding.particles_per_axis for body in scene.bodies)
    bridge, near = scene.shape.crack_band * scene.domain.dx, NEIGHBOURS * spacing
    finite = np.isfinite(snapshot.x).all(axis=1)  # not so at the end of a run that became unstable
    whole = np.flatnonzero((snapshot.failure_mode == INTACT) & (snapshot.damage == 0.0) & finite)
    x, u = snapshot.x[whole], snapshot.displacement[whole]
    nowhere = np.zeros((0, scene.dim))
    if len(whole) < 2 or np.linalg.norm(np.ptp(u, axis=0)) < bridge - near:  # as in every run of rock that is sound
        return nowhere
    a, b = pairs_within(x - u, near)
    distance = np.linalg.norm(x[a] - x[b], axis=1)
    wide = np.argsort(-distance)[: np.count_nonzero(distance > bridge)]
    return 0.5 * (x[a] + x[b])[wide]


def parting_warning(scene: Scene, snapshot: Snapshot) -> str:
    """One line about numerical fracture at the end of a run, or nothing."""
    positions = parted(scene, snapshot)
    if not len(positions):
        return ""
    return (
        f"{len(positions)} pairs of unbroken neighbours are farther apart than {scene.shape.crack_band:g} cells, what "
        f"{type(scene.shape).__name__} bridges, the widest at {np.array2string(1e3 * positions[0], precision=3)} mm: "
        f"the rock there has parted by its discretisation, not by its strength; end the run earlier, or take a wider "
        f"shape function"
    )
