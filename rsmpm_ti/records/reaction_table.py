"""The forces of boundaries on the bodies, row by row: reactions.csv."""

from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti.records.tables import AXES, Column, Table


@dataclass(frozen=True)
class Reaction:
    """Of one boundary, in r rows, [N], in 2D per metre of thickness.

    force: on the bodies, a mean over the steps since the row before, [r, dim]; displacement: of the boundary along its
    axis [m], [r]; axis: across its plane; side: lower or upper.
    """

    force: np.ndarray
    displacement: np.ndarray
    axis: int
    side: str

    @property
    def normal(self) -> np.ndarray:
        """Pressing positive: a lower plane presses along +axis, an upper one along -axis."""
        return self.force[:, self.axis] * (1.0 if self.side == "lower" else -1.0)

    @property
    def tangential(self) -> np.ndarray:
        """Size of the force along the plane."""
        return np.linalg.norm(np.delete(self.force, self.axis, axis=1), axis=1)


@dataclass(frozen=True)
class Reactions:
    """Of all boundaries of a run; time: of the rows [s], [r]; of_boundary: a `Reaction` by the boundary's name."""

    time: np.ndarray
    of_boundary: dict[str, Reaction]

    def table(self, dim: int) -> np.ndarray:
        """Structured array of the rows, a float64 field for each column of the file."""
        found = by_boundary(self).filled(self, dim)
        table = np.empty(len(self.time), dtype=[(name, np.float64) for name in found])
        for name, entries in found.items():
            table[name] = entries
        return table


def boundary_name(index: int, kind: str, axis: int, side: str) -> str:
    """Index in `loading.boundaries`, kind, axis and side in one word: b0_platen_y_lower."""
    return f"b{index}_{kind.lower()}_{AXES[axis]}_{side}"


REACTIONS = Table(
    file="reactions.csv",
    about=(
        "Forces of the boundaries on the bodies, one row per row of the history; no file where a scene has no "
        "boundaries. `{boundary}` stands for each of them, by its index in `loading.boundaries`, its kind, axis and "
        "side: `b0_platen_y_lower`. Forces are means over the steps since the row before, per metre of thickness in "
        "2D, without the confining pressure. `Result.reactions` is the same as a structured NumPy array."
    ),
    columns=(
        Column(name="time_s", unit="s", about="time of the row, that of the history", value=lambda all_: all_.time),
        Column(
            name="{boundary}_force_{axis}_N", unit="N", about="force on the bodies along each axis, its sign that of "
            "the axis",
            value=lambda one: one.force,
        ),
        Column(
            name="{boundary}_normal_N", unit="N", about="its part across the plane of the boundary, pressing positive",
            value=lambda one: one.normal,
        ),
        Column(
            name="{boundary}_tangential_N", unit="N", about="size of its part along the plane: friction, or what holds "
            "a bonded or fixed plane",
            value=lambda one: one.tangential,
        ),
        Column(
            name="{boundary}_displacement_m", unit="m", about="how far the boundary has gone along its axis since the "
            "start, its sign that of the axis",
            value=lambda one: one.displacement,
        ),
    ),
)  # fmt: skip


def by_boundary(reactions: Reactions) -> Table:
    """REACTIONS with the columns of a boundary once for each."""
    of_all = [column for column in REACTIONS.columns if "{boundary}" not in column.name]
    of_one = [column for column in REACTIONS.columns if column not in of_all]
    each = [_of(column, name) for name in reactions.of_boundary for column in of_one]
    return replace(REACTIONS, columns=(*of_all, *each))


def _of(column: Column, boundary: str) -> Column:
    make = column.value
    assert make is not None
    return replace(
        column,
        name=column.name.replace("{boundary}", boundary),
        value=lambda reactions: make(reactions.of_boundary[boundary]),
    )
