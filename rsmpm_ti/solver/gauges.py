"""Gauges: the distance of two particles, as history columns."""

import numpy as np

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.records.tables import Column
from rsmpm_ti.spec.load_cell import Gauge


def gauge_columns(sim: Simulation) -> tuple[Column, ...]:
    """A history column for each gauge of the scene."""
    gauges = sim.scene.loading.cell.gauges
    return tuple(_column(gauge, Glued(sim, gauge)) for gauge in gauges)


def _column(gauge: Gauge, glued: "Glued") -> Column:
    about = f"gauge from {gauge.a} to {gauge.b} m, lengthening positive"
    unit = "1" if gauge.reads == "strain" else "m"
    return Column(name=gauge.column, unit=unit, about=about, value=lambda view: glued.read())


class Glued:
    """A gauge on the two particles that were seeded nearest to its points."""

    def __init__(self, sim: Simulation, gauge: Gauge):
        self._particles, self._strain = sim.particles, gauge.reads == "strain"
        reference, ids = sim.particles.reference.to_numpy(), sim.particles.id.to_numpy()
        # of equally near ones that of the smallest id, so that the order in memory does not choose
        order = np.argsort(ids, kind="stable")
        nearest = [int(np.argmin(np.linalg.norm(reference[order] - point, axis=1))) for point in (gauge.a, gauge.b)]
        self._ids = ids[order[nearest]]
        a, b = reference[order[nearest]].astype(np.float64)
        self._span, self._length = b - a, float(np.linalg.norm(b - a))

    def read(self) -> float:
        """Strain [1] or change of the distance [m]; NaN once one of the particles was dropped.

        |s + w| - |s| = (2 s.w + w.w) / (|s + w| + |s|) with the span s and the relative displacement w: the difference
        itself would lose the digits of a small strain.
        """
        ids = self._particles.id.to_numpy()
        rows = [int(np.flatnonzero(ids == one)[0]) for one in self._ids]
        if (self._particles.volume.to_numpy()[rows] == 0.0).any():
            return np.nan
        u = self._particles.u.to_numpy()[rows].astype(np.float64)
        s, w = self._span, u[1] - u[0]
        change = float((2.0 * s @ w + w @ w) / (np.linalg.norm(s + w) + self._length))
        return change / self._length if self._strain else change
