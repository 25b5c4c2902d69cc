"""Planes of nodes that are held: what they do to a node's velocity.

A boundary holds every node on its plane and beyond it, known by where they were at the start: the grid goes with the
boundaries (`fields/grid.py`). `factor` is the start ramp, 0 to 1.

`project(v, speed, factor, squeeze)` takes the velocity that a node has after the forces of a step and gives the held
one and what the node then does, FREE, SLIDES or STICKS. speed: the boundary's own along its axis, now [m/s]; squeeze:
what the confining pressure alone would take from the node [m/s].
`keep(v, speed, factor, state)` holds a velocity that is mapped to the node in the same step without forces, as
`project` did.
`unilateral`: whether it acts only on rock that touches the plane (`mpm/contact.py`).
"""

from dataclasses import dataclass
from typing import Annotated, Literal

import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Coordinate, Finite, Remedy, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.units import ForceOrLineLoad, Pressure, Velocity

MAX_FRICTION = 1e3
"""Largest friction coefficient: nothing slips long before."""

Axis = Annotated[int, Interval(ge=0, le=2)]
Side = Literal["lower", "upper"]


@ti.func
def beyond(x, dx, axis: ti.template(), side: ti.template(), position):
    """Whether a node lies on the plane or beyond it; a quarter cell absorbs round-off."""
    outward = ti.static(1.0 if side == "upper" else -1.0)
    return outward * (x[axis] - position) >= -0.25 * dx


FREE, SLIDES, STICKS = 0, 1, 2
"""What a node does at a boundary that pushes: nothing, slip along it, or stay where it is on it."""


@ti.data_oriented
@checked("platen")
@dataclass(frozen=True, kw_only=True)
class Platen:
    """A rigid plate: prescribed normal velocity `speed` [m/s], signed along +axis.

    It pushes and does not pull: rock that comes back leaves it, and rock that lies off it is met where it is. `pulls`
    holds rock in tension too, as a glued plate does that leaves lateral motion free. Lateral motion is free (default),
    limited by Coulomb `friction` on what presses, the confining pressure included, or none: `bonded` holds both ways
    and in every direction. `span` limits the plate to an interval [m] of the first lateral axis: the arc of a
    Brazilian test.

    With a `force` [N] (per metre of thickness in 2D) or a nominal `stress` [Pa], the force over `loading.width`, in
    place of a speed it is pushed towards the bodies by `factor` times as much and goes as fast as they let it
    (`fields/side_motion.py`). Confinement is not part of it. With pulls or bonded it may be negative, and pull.
    """

    axis: Axis
    side: Side
    position: Coordinate
    speed: Annotated[Velocity, Finite] = 0.0
    force: Annotated[ForceOrLineLoad, Finite] | None = None
    stress: Annotated[Pressure, Finite] | None = None
    friction: Annotated[float, Interval(ge=0.0, le=MAX_FRICTION), Remedy("or set bonded")] = 0.0
    bonded: bool = False
    pulls: bool = False
    span: tuple[Coordinate, Coordinate] | None = None

    def __post_init__(self):
        if self.span is not None and not self.span[0] < self.span[1]:
            raise refuse("platen.span", self.span, "an interval with its lower end first, in metres")
        given = {name: getattr(self, name) for name in ("force", "stress") if getattr(self, name) is not None}
        if len(given) + (self.speed != 0.0) > 1:
            one = "a platen has a speed, a force or a stress"
            if self.speed:
                allowed = f"0 beside a {next(iter(given))}"
                remedy = f"{one}: set speed = 0, and since no strain need come, strain_end = none and t_end"
                raise refuse("platen.speed", self.speed, allowed, remedy)
            raise refuse("platen.stress", self.stress, "none beside a force", f"{one}: set one of them to none")
        for name, value in given.items():
            if value < 0.0 and self.unilateral:
                remedy = "it only pushes: set pulls = True or bonded = True"
                raise refuse(f"platen.{name}", value, "positive: it presses on the bodies", remedy)

    @property
    def limited(self) -> bool:
        return self.span is not None

    @property
    def held(self) -> bool:
        """Whether a force moves it."""
        return self.force is not None or self.stress is not None

    @property
    def unilateral(self) -> bool:
        """Whether it only pushes."""
        return not (self.bonded or self.pulls)

    @ti.func
    def holds(self, x, dx):
        held = beyond(x, dx, self.axis, self.side, self.position)
        if ti.static(self.limited):
            lateral = x[ti.static(1 if self.axis == 0 else 0)]
            held = held and lateral >= self.span[0] - 0.25 * dx and lateral <= self.span[1] + 0.25 * dx
        return held

    @ti.func
    def project(self, v, speed, factor, squeeze):
        held, state = v, FREE
        outward = ti.static(1.0 if self.side == "upper" else -1.0)
        pressing = outward * (v[self.axis] - speed) + squeeze  # impulse by which the platen pushes, over the mass
        if ti.static(self.bonded):
            held, state = ti.Vector.zero(float, v.n), STICKS
        elif ti.static(self.pulls) or pressing > 0.0:
            state = SLIDES
            if ti.static(self.friction > 0.0):
                # Coulomb on impulses: the tangential velocity change is at most friction x the normal one
                tangent, limit = v, self.friction * ti.max(pressing, 0.0)
                tangent[self.axis] = 0.0
                slip = tangent.norm(1e-30)
                if slip <= limit:
                    state = STICKS
                held -= tangent * ti.min(1.0, limit / slip)
        if state != FREE:
            held[self.axis] = speed
        return held, state

    @ti.func
    def keep(self, v, speed, factor, state):
        held = v
        if ti.static(self.bonded):
            held = ti.Vector.zero(float, v.n)
        if ti.static(self.friction > 0.0):
            if state == STICKS:
                held = ti.Vector.zero(float, v.n)
        if ti.static(not self.unilateral) or state != FREE:
            held[self.axis] = speed
        return held


@ti.data_oriented
@checked("wall")
@dataclass(frozen=True, kw_only=True)
class Wall:
    """A mirror plane: normal velocity 0, no friction. It holds both ways; a wall that pushes alone is a `Platen` of
    speed 0."""

    axis: Axis
    side: Side
    position: Coordinate

    speed = 0.0
    held = unilateral = False

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, speed, factor, squeeze):
        return self.keep(v, speed, factor, STICKS), STICKS

    @ti.func
    def keep(self, v, speed, factor, state):
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
    held = unilateral = False

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, speed, factor, squeeze):
        return 0.0 * v, STICKS

    @ti.func
    def keep(self, v, speed, factor, state):
        return 0.0 * v


@ti.data_oriented
@checked("absorbing")
@dataclass(frozen=True, kw_only=True)
class Absorbing:
    """A plane through rock that goes on beyond it: waves leave there, by dashpots on its nodes.

        sigma_n = -rho c_p v_n,    sigma_t = -rho c_s v_t

    Lysmer & Kuhlemeyer (1969), J. Eng. Mech. Div. ASCE 95:859, eq. 1 and 2 with a = b = 1. Implicit in the node's new
    velocity, so stable for every step. Plane waves that arrive square are taken whole but for what the grid makes of
    them; when it fails: of a P wave at 60 degrees from the normal some 10 % come back, and at grazing incidence all. It
    carries no load at rest: rock under stress drifts through it. Good values: as far away as a few wave lengths.
    """

    axis: Axis
    side: Side
    position: Coordinate

    speed = 0.0
    held = unilateral = False
    absorbs = True

    @ti.func
    def holds(self, x, dx):
        return beyond(x, dx, self.axis, self.side, self.position)

    @ti.func
    def project(self, v, speed, factor, squeeze):
        return v, FREE

    @ti.func
    def absorb(self, v, normal, tangential):
        """Velocity of a node after a step of both dashpots; normal, tangential: dt rho c A/m of P and S waves."""
        held = v / (1.0 + tangential)
        held[self.axis] = v[self.axis] / (1.0 + normal)
        return held

    @ti.func
    def keep(self, v, speed, factor, state):
        return v
