"""Rows of reactions.csv: what every boundary of a scene does to the bodies, and how far it has gone."""

import numpy as np

from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.records.reaction_table import Reaction, Reactions, boundary_name


class ReactionRows:
    """One for each row of the history, which hands over the forces."""

    def __init__(self, sim: Simulation):
        self._sim, self._boundaries = sim, sim.scene.loading.boundaries
        self._rows: list[np.ndarray] = []

    def see(self, time: float, forces: np.ndarray) -> None:
        """Add a row. forces: of each boundary on the bodies, means since the row before [N], [boundaries, dim]."""
        if self._boundaries:
            gone = self._sim.grid.gone()
            way = [gone[b.axis, 0 if b.side == "lower" else 1] for b in self._boundaries]
            self._rows.append(np.concatenate(([time], *np.column_stack((forces, way)))))

    def table(self) -> np.ndarray | None:
        """Structured array of the rows so far; None without boundaries."""
        if not self._boundaries:
            return None
        dim, rows = self._sim.dim, self._array()
        of_each = rows[:, 1:].reshape(len(rows), len(self._boundaries), dim + 1)
        found = {
            boundary_name(k, type(b).__name__, b.axis, b.side): Reaction(
                force=of_each[:, k, :dim], displacement=of_each[:, k, dim], axis=b.axis, side=b.side
            )
            for k, b in enumerate(self._boundaries)
        }
        return Reactions(rows[:, 0], found).table(dim)

    def _array(self) -> np.ndarray:
        return np.array(self._rows).reshape(-1, 1 + len(self._boundaries) * (self._sim.dim + 1))

    def state(self) -> dict[str, np.ndarray]:
        return {"reactions": self._array()}

    def resume(self, state: dict[str, np.ndarray]) -> None:
        self._rows = list(state["reactions"])
