"""Planes of nodes that are held: what they do to a node's velocity.

A boundary holds every node on its plane and beyond it. `factor` is the start ramp, 0 to 1.
"""

from dataclasses import dataclass

import taichi as ti

from rsmpm_ti.checks import check_kinds, check_size
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.regions import FARTHEST

ROUGHEST = 1e3
"""Largest friction coefficient: nothing slips long before."""


def _check_plane(owner: str, boundary) -> None:
    check_kinds(owner, boundary)
    if boundary.axis not in (0, 1, 2):
        raise refuse(f"{owner}.axis", boundary.axis, "0, 1 or 2")
    if boundary.side not in ("lower", "upper"):
        raise refuse(f"{owner}.side", boundary.side, "'lower' or 'upper'")
    check_size(f"{owner}.position", (boundary.position,), "a coordinate in metres", FARTHEST)


@ti.func
def beyond(x, dx, axis: ti.template(), side: ti.template(), position):
    """Whether a node lies on the plane or beyond it; a quarter cell absorbs round-off."""
    outward = ti.static(1.0 if side == "upper" else -1.0)
    return outward * (x[axis] - position) >= -0.25 * dx


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Platen:
    """A rigid plate: prescribed normal velocity `speed` [m/s], signed along +axis.

    Lateral motion is free (default), limited by Coulomb `friction`, or `bonded`. `span` limits the plate to an
    interval [m] of the first lateral axis: the arc of a Brazilian test.
    """

    axis: int
    side: str
    position: float
    speed: float
    friction: float = 0.0
    bonded: bool = False
    span: tuple[float, float] | None = None

    def __post_init__(self):
        _check_plane("platen", self)
        check_size("platen.speed", (self.speed,), "a velocity in m/s")
        if not 0.0 <= self.friction <= ROUGHEST:
            raise refuse("platen.friction", self.friction, f"a coefficient in [0, {ROUGHEST:g}]", "or set bonded")
        if self.span is not None:
            check_size("platen.span", self.span, "a finite interval (lower, upper) in metres", FARTHEST)
            if not self.span[0] < self.span[1]:
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
@dataclass(frozen=True, kw_only=True)
class Wall:
    """A fixed frictionless plane: normal velocity 0."""

    axis: int
    side: str
    position: float

    speed = 0.0

    def __post_init__(self):
        _check_plane("wall", self)

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, factor):
        held = v
        held[self.axis] = 0.0
        return held


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Fixed:
    """A clamped plane: velocity 0."""

    axis: int
    side: str
    position: float

    speed = 0.0

    def __post_init__(self):
        _check_plane("fixed", self)

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, factor):
        return 0.0 * v
