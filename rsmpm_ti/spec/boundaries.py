"""Planes of nodes that are held: what they do to a node's velocity.

A boundary holds every node on its plane and beyond it. `factor` is the start ramp, 0 to 1.
"""

from dataclasses import dataclass
from typing import Annotated, Literal

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Finite, Remedy, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.regions import Coordinate
from rsmpm_ti.units import Velocity

MAX_FRICTION = 1e3
"""Largest friction coefficient: nothing slips long before."""

Axis = Annotated[int, Interval(ge=0, le=2)]
Side = Literal["lower", "upper"]


@ti.func
def beyond(x, dx, axis: ti.template(), side: ti.template(), position):
    """Whether a node lies on the plane or beyond it; a quarter cell absorbs round-off."""
    outward = ti.static(1.0 if side == "upper" else -1.0)
    return outward * (x[axis] - position) >= -0.25 * dx


@ti.data_oriented
@checked("platen")
@dataclass(frozen=True, kw_only=True)
class Platen:
    """A rigid plate: prescribed normal velocity `speed` [m/s], signed along +axis.

    Lateral motion is free (default), limited by Coulomb `friction`, or `bonded`. `span` limits the plate to an
    interval [m] of the first lateral axis: the arc of a Brazilian test.
    """

    axis: Axis
    side: Side
    position: Coordinate
    speed: Annotated[Velocity, Finite]
    friction: Annotated[float, Interval(ge=0.0, le=MAX_FRICTION), Remedy("or set bonded")] = 0.0
    bonded: bool = False
    span: tuple[Coordinate, Coordinate] | None = None

    def __post_init__(self):
        if self.span is not None and not self.span[0] < self.span[1]:
            raise refuse("platen.span", self.span, "an interval with its lower end first, in metres")

    @property
    def limited(self) -> bool:
        return self.span is not None

    @ti.func
    def holds(self, x, dx):
        held = beyond(x, dx, self.axis, self.side, self.position)
        if ti.static(self.limited):
            lateral = x[ti.static(1 if self.axis == 0 else 0)]
            held = held and lateral >= self.span[0] - 0.25 * dx and lateral <= self.span[1] + 0.25 * dx
        return held

    @ti.func
    def project(self, v, factor):
        held, normal = v, self.speed * factor
        if ti.static(self.bonded):
            held = ti.Vector.zero(float, v.n)
        elif ti.static(self.friction > 0.0):
            # Coulomb on impulses: the tangential velocity change is at most friction x the normal one
            tangent = v
            tangent[self.axis] = 0.0
            slip = tangent.norm(1e-30)
            held -= tangent * ti.min(1.0, self.friction * abs(normal - v[self.axis]) / slip)
        held[self.axis] = normal
        return held


@ti.data_oriented
@checked("wall")
@dataclass(frozen=True, kw_only=True)
class Wall:
    """A fixed frictionless plane: normal velocity 0."""

    axis: Axis
    side: Side
    position: Coordinate

    speed = 0.0

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, factor):
        held = v
        held[self.axis] = 0.0
        return held


@ti.data_oriented
@checked("fixed")
@dataclass(frozen=True, kw_only=True)
class Fixed:
    """A clamped plane: velocity 0."""

    axis: Axis
    side: Side
    position: Coordinate

    speed = 0.0

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, factor):
        return 0.0 * v
