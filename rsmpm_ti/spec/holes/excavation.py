"""Rock that is excavated during a run: a tunnel, a shaft or a pit in ground under stress.

The particles of a region are taken out. A support takes their place on the nodes i of the wall: what holds the rock
that is left in balance, to the last bit and whatever its stress. It fades:

    f_i = (1 - 3 s^2 + 2 s^3) f_i(time),    s = (t - time)/relaxation

so that nothing moves at first, and the wall comes in without a shock. That is the unloading factor of the
convergence-confinement method: Panet (1995), Le calcul des tunnels par la methode convergence-confinement.
"""

import itertools
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval

from rsmpm_ti.checks import MAX_SIZE, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.drawings.answers import inside
from rsmpm_ti.spec.holes.pressure import Moment, around, pressures_of
from rsmpm_ti.spec.regions import Difference, Region
from rsmpm_ti.spec.seeding import Seeds
from rsmpm_ti.units import Time

FADING = 32
"""Pieces of the curve by which a support fades."""


@checked("excavation")
@dataclass(frozen=True, kw_only=True)
class Excavation:
    """The rock of a region is taken out at a time [s], and its support fades during `relaxation` [s].

    The region is that of the rock as it is drawn, and goes with it; bodies are seeded apart within it and outside, so
    that a fitted seeding follows the wall. When it fails: a relaxation shorter than a few wave transits shakes the
    rock, and 0 is a blast. Good values: `loading.settle` before it, ten transits of the hole's distance to the sides.
    """

    region: Region
    time: Moment
    relaxation: Annotated[Time, Interval(ge=0.0, le=MAX_SIZE)] = 0.0

    @property
    def table(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """Times [s], from 0 on, and the part of the support that is left."""
        if self.relaxation == 0.0:
            return (0.0,), (0.0,)
        parts = [k / FADING for k in range(FADING + 1)]
        fading = [1.0 - s * s * (3.0 - 2.0 * s) for s in parts]
        times = [self.time + s * self.relaxation for s in parts]
        before = [0.0] if self.time > 0.0 else []
        return (*before, *times), (*(1.0 for _ in before), *fading)


def excavations_of(scene) -> list[tuple[int, Excavation]]:
    """(its place in loading.holes, excavation) of all."""
    return [(k, hole) for k, hole in enumerate(scene.loading.holes) if isinstance(hole, Excavation)]


def _parts(scene, body) -> list[Seeds]:
    """What stays of a body, and what each excavation takes of it."""
    origin, dx = np.array(scene.domain.lower, dtype=float), scene.domain.dx
    taken = tuple(hole.region for _, hole in excavations_of(scene))
    if not taken:
        return [body.seeding.fill(body.region, origin, dx)]
    inner = [Difference(whole=part, removed=(Difference(whole=part, removed=(body.region,)),)) for part in taken]
    regions = [Difference(whole=body.region, removed=taken), *inner]
    return [body.seeding.fill(region, origin, dx) for region in regions]


def filled(scene, body) -> Seeds:
    """Particles of a body, those that are to be excavated last."""
    parts = _parts(scene, body)
    return Seeds(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def marks(scene) -> np.ndarray:
    """The place in loading.holes of what takes out each particle, by id, [n]; -1 for those that stay."""
    places = [-1, *(k for k, _ in excavations_of(scene))]
    of_body = ([len(part.x) for part in _parts(scene, body)] for body in scene.bodies)
    return np.concatenate([np.repeat(places, counts) for counts in of_body])


def check_excavations(scene, seeds: list[Seeds]) -> None:
    """Refuse an excavation of nothing, of everything, two in one place, and of a wall that is pressed by a hole or by a
    platen that a force moves."""
    found = excavations_of(scene)
    if not found:
        return
    mark = marks(scene)
    for k, hole in found:
        if not np.any(mark == k):
            remedy = "there is no rock to take out"
            raise refuse(f"holes[{k}].region", hole.region, "a region of a body, larger than a particle", remedy)
        for boundary in scene.loading.boundaries:
            if getattr(boundary, "held", False) and _touches(hole.region, boundary, scene.domain.dx):
                remedy = "give it a speed: its force would be left without the rock that bore it"
                raise refuse(f"holes[{k}].region", hole.region, "apart from a platen that a force moves", remedy)
    if not np.any(mark == -1):
        raise refuse("loading.holes", scene.loading.holes, "such that some rock is left")
    x = np.concatenate([body.x for body in seeds])
    for (j, _), (k, hole) in itertools.permutations(found, 2):
        both = inside(hole.region, x[mark == j]).mean()
        if both > SHARED:
            allowed = f"apart from holes[{j}]: {100.0 * both:.3g} % of its rock lies in both"
            raise refuse(f"holes[{k}].region", hole.region, allowed)
    steps = np.concatenate([around(scene.dim, cells * scene.domain.dx) for cells in (0.5, 1.0, 1.5, 2.0)])
    for (k, hole), (j, pressed) in itertools.product(found, pressures_of(scene)):
        if any(inside(pressed.region, x[mark == k] + step).any() for step in steps):
            remedy = "its wall would go and the pressure on it stay"
            raise refuse(f"holes[{k}].region", hole.region, f"more than two cells from that of holes[{j}]", remedy)


def _touches(region, platen, dx: float) -> bool:
    """Whether a region reaches to within a cell of a platen."""
    low, high = (float(bound[platen.axis]) for bound in region.bounds())
    return high > platen.position - dx if platen.side == "upper" else low < platen.position + dx


SHARED = 0.05
"""Part of the particles of an excavation that may lie in another: those fitted to a common edge."""
