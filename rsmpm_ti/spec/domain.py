"""The background grid of a scene: how far it reaches, how it lies, how fine it is, what becomes of what leaves it."""

import math
from dataclasses import dataclass
from typing import Annotated, Literal

from annotated_types import Interval

from rsmpm_ti.checks import MAX_COORDINATE, Position, Remedy, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.method.time_step import MAX_COUNT
from rsmpm_ti.units import Angle, Length

MIN_DX = 1e-9
"""Smallest cell [m]: below it rock is no continuum."""

MIN_DX_FRACTION = 1e-9
"""Smallest cell over the largest coordinate: round-off of a particle's place is then 1e-7 of a cell."""

MARGIN = 3
"""Cells of empty grid around the domain, so that no stencil leaves the arrays."""

GROWTH = 4
"""Lengths of a domain's longest edge by which it may grow on every side: each asks for pointers to empty blocks."""


@checked("domain")
@dataclass(frozen=True, kw_only=True)
class Domain:
    """The background grid: a box of cells of edge dx [m]; `grid` is 'dense', 'sparse' or 'auto' (by occupancy).

    A particle that flies more than two cells beyond it ends the run; with outside = 'drop' it is taken out of it; with
    'grow' the grid, which must then be sparse, grows to where particles are, up to GROWTH domain lengths on every side.

    `turn`: angle by which the grid lies turned against the box, about its middle, counter-clockwise [degrees], in 2D.
    Everything else stays along the axes. Rows and columns of cells are then no way for a crack: it grows where the
    stress sends it. The grid reaches to the corners of the box, and platens press by their position (`pressed`).
    """

    lower: Position
    upper: Position
    dx: Annotated[Length, Interval(ge=MIN_DX, le=MAX_COORDINATE)]
    grid: Literal["dense", "sparse", "auto"] = "dense"
    outside: Literal["stop", "drop", "grow"] = "stop"
    turn: Annotated[Angle, Interval(ge=-45.0, le=45.0), Remedy("a grid looks the same after 90 degrees")] = 0.0

    def __post_init__(self):
        if len(self.lower) != len(self.upper):
            raise refuse("domain.upper", self.upper, "as many coordinates as domain.lower")
        edges = [float(b) - float(a) for a, b in zip(self.lower, self.upper, strict=True)]
        if not all(edge >= self.dx for edge in edges):
            allowed = f"at least one cell, dx = {self.dx}, above domain.lower = {self.lower}"
            raise refuse("domain.upper", self.upper, allowed)
        if self.outside == "grow" and self.grid == "dense":
            allowed, remedy = "'stop' or 'drop' with a dense grid", "set domain.grid = 'sparse' to let it grow"
            raise refuse("domain.outside", self.outside, allowed, remedy)
        if self.turn and len(self.lower) != 2:
            raise refuse("domain.turn", self.turn, "0 in 3D")
        far = self.farthest
        if not self.dx >= MIN_DX_FRACTION * far:
            allowed = f"at least {MIN_DX_FRACTION * far:.4g} m, {MIN_DX_FRACTION:g} of the largest coordinate"
            raise refuse("domain.dx", self.dx, allowed, "move the domain to the origin: places are lost to round-off")
        nodes = math.prod(edge / float(self.dx) + 1.0 for edge in edges)
        if nodes > MAX_COUNT:
            raise refuse("domain.dx", self.dx, f"such that the grid has at most {MAX_COUNT:.3g} nodes, not {nodes:.3g}")

    @property
    def dim(self) -> int:
        return len(self.lower)

    @property
    def room(self) -> int:
        """Cells beyond the domain, on every side, into which the grid may grow: as many as 32-bit numbers count."""
        if self.outside != "grow":
            return 0
        edges = [(b - a) / self.dx for a, b in zip(self.lower, self.upper, strict=True)]
        room = math.ceil(GROWTH * max(edges))
        while room and math.prod(edge + 2.0 * room + 10.0 for edge in edges) > MAX_COUNT:
            room //= 2
        return room

    @property
    def node_counts(self) -> tuple[int, ...]:
        """Nodes of the background grid along each axis, those around the domain included."""
        edges = [(b - a) / self.dx for a, b in zip(self.lower, self.upper, strict=True)]
        beyond = MARGIN + self.room
        if self.turn:  # around the turned box, with a node in its middle
            (c, s), half = self.direction, [0.5 * edge + beyond for edge in edges]
            across = (abs(c) * half[0] + abs(s) * half[1], abs(s) * half[0] + abs(c) * half[1])
            return tuple(2 * math.ceil(edge - 1e-6) + 1 for edge in across)
        return tuple(math.ceil(edge - 1e-6) + 2 * beyond + 1 for edge in edges)

    @property
    def direction(self) -> tuple[float, float]:
        """Unit vector of the grid's first axis."""
        return math.cos(math.radians(self.turn)), math.sin(math.radians(self.turn))

    @property
    def middle(self) -> tuple[float, ...]:
        """Of the box [m]."""
        return tuple(0.5 * (a + b) for a, b in zip(self.lower, self.upper, strict=True))

    @property
    def pressed(self) -> float:
        """Depth of rock along a platen whose nodes go with it [m]: none in a grid that is not turned.

        As far as a node inside may have rock on one side only: its force would miss the platen's. See mpm/nodes.py.
        """
        return 1.5 * sum(map(abs, self.direction)) * self.dx if self.turn else 0.0

    @property
    def farthest(self) -> float:
        """Largest coordinate that a particle may have [m]."""
        return max(map(abs, (*self.lower, *self.upper))) + self.room * self.dx
