"""What moves the sides of the grid: boundaries with a speed, and platens that a force moves."""

from typing import NamedTuple

import numpy as np

from rsmpm_ti.spec.scene import Scene


class HeldSide(NamedTuple):
    """A side of an axis, 0 lower and 1 upper, that the force [N] of a boundary moves, along +axis, and its mass."""

    axis: int
    side: int
    boundary: int
    force: float
    mass: float


def side_speeds(scene: Scene) -> tuple[tuple[float, float], ...]:
    """Speed [m/s] of what bounds each axis below and above; of a side without boundary, the other's."""

    def of_side(axis: int, side: str) -> set[float]:
        return {float(b.speed) for b in scene.loading.boundaries if (b.axis, b.side) == (axis, side)}

    found = []
    for axis in range(scene.dim):
        lower, upper = of_side(axis, "lower"), of_side(axis, "upper")
        found.append((next(iter(lower or upper or {0.0})), next(iter(upper or lower or {0.0}))))
    return tuple(found)


def held_sides(scene: Scene) -> tuple[HeldSide, ...]:
    """Sides that a force moves.

    Their platen has the mass of two rows of cells of rock, as wide as the bodies that it may meet: light beside the
    specimen, and yet heavier than the rock of its nodes, since what they give back is known only after each step.
    """
    found, width = [], scene.loading.width
    for k, boundary in enumerate(scene.loading.boundaries):
        if boundary.held:
            inward = 1.0 if boundary.side == "lower" else -1.0
            force = boundary.force if boundary.force is not None else boundary.stress * width
            mass = 2.0 * scene.density * scene.domain.dx * _extent(scene, boundary.axis)
            found.append(HeldSide(boundary.axis, 0 if inward > 0.0 else 1, k, inward * force, mass))
    return tuple(found)


def _extent(scene: Scene, axis: int) -> float:
    """Of all bodies across an axis: a length [m], in 3D an area [m^2]."""
    low, high = np.array([body.region.bounds() for body in scene.bodies]).transpose(1, 0, 2)
    return float(np.prod(np.delete(high.max(axis=0) - low.min(axis=0), axis)))
