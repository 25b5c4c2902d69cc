"""Whether a slit's two faces really separate on the grid. It needs the particles but no kernel: NumPy and SciPy only.

A node that particles of both faces reach ties them together. How much it passes is found by statics: the strips of rock
along both faces, cut loose at the slit's ends and held two cells behind the faces, are moved apart by a unit, across
the slit and along it, and the nodes between them relax. The energy that this costs is that of springs across the slit.
Their stiffness kappa E'/dx per area holds up an opening crack: with the mean opening pi a sigma/E' of a sharp crack of
length 2a in a field sigma (Westergaard 1939, J. Appl. Mech. 6:A49), springs in parallel carry kappa pi a/dx of what the
crack still lets go. A light node between the faces may do so, as its gradient is not light.

A `Box` that is cut out is a slit, along the grid or turned. When it fails: it knows one slit at a time, and no removed
region of another kind; two bodies with a gap between them are tied in the same way, and are not checked.
"""

import itertools
import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.regions import Box, Slit, Turned, cuts_of
from rsmpm_ti.spec.seeding import Seeds

TIED_FRACTION = 0.03
"""Largest fraction of the stress that a slit should let go that its faces may still pass on.

The flaw opens by so much less than it should: less than what a cell at each of its ends is worth, dx/a (3 to 13 % of
the scenes), by which its length is known.
"""

TIP_FRACTION = 0.75
"""Largest stress of a particle beside the slit, over the mean stress in the cell ahead of a sharp tip.

That is sqrt(2a/dx) of the field (Irwin's singular field, averaged over dx). A tie pulls at few particles, the more at
one the fewer they are: at 1 the rock would break on the middle of the face as soon as at the tip. The rest is for what
a particle's own place does to its stress.
"""

HELD = 2.0
"""Cells behind the faces where the strips are held: farther away, the result changes by 1 %."""

POISSON = 0.2
"""Of the strips. The tie is that of a layer that cannot give way sideways: 0.22, 0.23 and 0.33 at 0, 0.2 and 0.4."""


@dataclass(frozen=True)
class Tie:
    """What ties the faces of a slit in a field of unit stress: the worse of pulling across and of shearing along it."""

    passed: float  # fraction of the stress that the faces pass on
    highest: float  # of a particle beside the slit, over the mean stress ahead of a sharp tip

    @property
    def parted(self) -> bool:
        return self.passed <= TIED_FRACTION and self.highest <= TIP_FRACTION


FREE = Tie(0.0, 0.0)


class Turn(NamedTuple):
    """How a turned grid lies: a node of it [m], [2], and the angle of its rows from +x [degrees]."""

    node: np.ndarray
    angle: float

    def back(self, seeds: Seeds, slit: Slit) -> tuple[Seeds, Slit]:
        """Both as the grid sees them, the node at the origin."""
        c, s = math.cos(math.radians(self.angle)), math.sin(math.radians(self.angle))
        rotation = np.array([[c, -s], [s, c]])
        centre = tuple(float(a) for a in (np.array(slit.centre[:2]) - self.node) @ rotation)
        turned = replace(slit, centre=centre, angle=slit.angle - self.angle)
        return Seeds((seeds.x - self.node) @ rotation, seeds.volume), turned


def slit_tie(seeds: Seeds, slit: Slit, shape, dx: float, origin: np.ndarray) -> Tie:
    """How much nodes that see both faces hold them together; `seeds` are the particles of the cut body, [n, 2]."""
    frame = slit.frame(seeds.x)
    straight = slit.length - (slit.width if slit.rounded else 0.0)  # what is beyond holds together as it should
    depth = 0.5 * slit.width + (HELD + 0.5 * shape.width) * dx
    beside = (np.abs(frame[:, 0]) < 0.5 * straight) & (np.abs(frame[:, 1]) < depth)
    upper = frame[beside, 1] > 0.0
    strips = _Strips(seeds.x[beside, :2], seeds.volume[beside] / dx**2, shape, dx, origin[:2])
    if not (strips.reached(upper) & strips.reached(~upper)).any():
        return FREE
    face = min(straight, float(np.ptp(frame[beside, 0])) + dx)  # shorter in a slit that reaches out of its body
    across = slit.frame(strips.nodes)[:, 1]
    held = np.abs(across) > 0.5 * slit.width + HELD * dx
    normal = np.array([-slit.direction[1], slit.direction[0]])
    sharp, passed, highest = 0.5 * (slit.length - straight + face) / dx, 0.0, 0.0  # a/dx
    for way in (normal, slit.direction):
        energy, stress = strips.moved(held, 0.5 * np.sign(across)[:, None] * way)
        springs = 2.0 * energy * dx / face * math.pi * sharp
        passed = max(passed, springs / (1.0 + springs))
        highest = max(highest, 4.0 * sharp * stress / (1.0 + springs) / math.sqrt(2.0 * sharp))
    return Tie(passed, highest)


class _Strips:
    """Linear elasticity of particles on their grid, in plane strain: lengths in cells, stresses over E'."""

    def __init__(self, x: np.ndarray, volume: np.ndarray, shape, dx: float, origin: np.ndarray):
        xi = (x - origin) / dx
        base = np.floor(xi - shape.shift).astype(int)
        first = base.min(axis=0, initial=2**62)
        counts = tuple((base - first).max(axis=0, initial=0) + shape.width)
        self.volume, self._size, self._shape = volume, math.prod(counts), shape
        self.nodes = np.stack(np.unravel_index(np.arange(self._size), counts), axis=1) * dx + first * dx + origin
        self._ids, self._gradients, reach = [], [], 1e-6  # half a step: exact for parabolas
        for offset in itertools.product(range(shape.width), repeat=2):
            d = xi - base - np.array(offset)
            w, slope = shape.profile(d), (shape.profile(d + reach) - shape.profile(d - reach)) / (2.0 * reach)
            self._ids.append(np.ravel_multi_index((base - first + np.array(offset)).T, counts))
            self._gradients.append((w, slope))

    def reached(self, which: np.ndarray) -> np.ndarray:
        """Nodes that some of the particles give mass to, bool [nodes]."""
        mass = np.zeros(self._size)
        for node, (w, _) in zip(self._ids, self._gradients, strict=True):
            np.add.at(mass, node[which], np.prod(w, axis=1)[which])
        return mass > 1e-12

    def moved(self, held: np.ndarray, u: np.ndarray) -> tuple[float, float]:
        """Energy, and largest principal stress of a particle without sign, where nodes that are held have moved by u
        [nodes, 2] and all others have found their equilibrium."""
        from scipy import sparse  # a tenth of a second, for scenes whose slit has nodes between its faces
        from scipy.sparse.linalg import spsolve

        p, entries = 3 * np.arange(len(self.volume)), []
        for node, (w, slope) in zip(self._ids, self._gradients, strict=True):
            gx, gy = slope[:, 0] * w[:, 1], w[:, 0] * slope[:, 1]
            entries += [(p, 2 * node, gx), (p + 1, 2 * node + 1, gy), (p + 2, 2 * node, gy), (p + 2, 2 * node + 1, gx)]
        rows, columns, values = (np.concatenate(parts) for parts in zip(*entries, strict=True))
        strain = sparse.coo_array((values, (rows, columns)), shape=(3 * len(p), 2 * self._size)).tocsr()
        young, shear = 1.0 - POISSON**2, 0.5 * (1.0 - POISSON)  # E and G over E'
        lame = young * POISSON / ((1.0 + POISSON) * (1.0 - 2.0 * POISSON))
        hooke = np.array([[lame + 2.0 * shear, lame, 0.0], [lame, lame + 2.0 * shear, 0.0], [0.0, 0.0, shear]])
        stiffness = (strain.T @ sparse.kron(sparse.diags_array(self.volume), hooke) @ strain).tocsr()
        used, given = stiffness.diagonal() > 0.0, np.repeat(held, 2)
        free, known = np.flatnonzero(used & ~given), np.flatnonzero(used & given)
        moved = np.where(given, u.ravel(), 0.0)
        # nodes that nothing but a particle's null space holds would make the matrix singular
        soft = 1e-9 * sparse.eye_array(len(free))
        load = -(stiffness[free][:, known] @ moved[known])
        moved[free] = spsolve((stiffness[free][:, free] + soft).tocsc(), load)
        xx, yy, xy = hooke @ (strain @ moved).reshape(-1, 3).T
        largest = np.abs(0.5 * (xx + yy)) + np.hypot(0.5 * (xx - yy), xy)
        return 0.5 * float(moved @ (stiffness @ moved)), float(largest.max(initial=0.0))


def check_cuts(body, shape, dx: float, origin: np.ndarray, turn: Turn | None = None) -> None:
    """Refuse a `Body` with a slit, or a box cut out of it like one, whose faces are tied; turn: of the grid."""
    for whole, part in cuts_of(body.region):
        if isinstance(part, Slit):
            check_slit(body.region, part, body.seeding, shape, dx, origin, turn=turn)
        elif isinstance(part, Box) and (slit := _as_slit(whole, part)) is not None:
            name = f"box.upper = {part.upper}: its width"
            check_slit(body.region, slit, body.seeding, shape, dx, origin, name, turn)
        elif isinstance(part, Turned) and isinstance(part.region, Box) and (slit := _as_slit(whole, part.region)):
            name = f"box.upper = {part.region.upper} (turned by {part.angle:g} degrees): its width"
            check_slit(body.region, part.carry(slit), body.seeding, shape, dx, origin, name, turn)


def _as_slit(whole, box: Box) -> Slit | None:
    """A box that goes through the thickness as a slit of the same outline."""
    low, high = whole.bounds()
    if np.any(np.array(box.lower[2:]) > low[2:]) or np.any(np.array(box.upper[2:]) < high[2:]):
        return None
    edges = [b - a for a, b in zip(box.lower[:2], box.upper[:2], strict=True)]
    centre = tuple(0.5 * (a + b) for a, b in zip(box.lower[:2], box.upper[:2], strict=True))
    return Slit(centre=centre, length=max(edges), width=min(edges), angle=0.0 if edges[0] >= edges[1] else 90.0)


def check_slit(
    region,
    slit: Slit,
    seeding,
    shape,
    dx: float,
    origin: np.ndarray,
    name: str = "slit.width",
    turn: Turn | None = None,
) -> None:
    """Refuse a slit whose faces stay tied through shared nodes, naming a width that would do."""
    tie = _tie_of_width(region, slit, slit.width, seeding, shape, dx, origin, turn)
    if tie.parted:
        return
    for cells in np.arange(1.0, 6.01, 0.25):
        width = cells * dx
        if width > slit.width and _tie_of_width(region, slit, width, seeding, shape, dx, origin, turn).parted:
            raise SceneError(
                f"{name} = {slit.width:.6g} m is refused: at {slit.angle:g} degrees its faces share nodes, which "
                f"pass on {100.0 * tie.passed:.2g} % of the stress (at most {100.0 * TIED_FRACTION:g} %) and load the "
                f"faces by {tie.highest:.2g} of the tips' stress (at most {TIP_FRACTION:g}): it would be a weak "
                f"inclusion and no flaw; use a width of at least {width:.6g} m ({cells:g} cells) or a finer dx"
            )
    raise SceneError(f"{name} = {slit.width:.6g} m is refused: no width up to 6 cells separates its faces")


def _tie_of_width(region, slit: Slit, width: float, seeding, shape, dx: float, origin: np.ndarray, turn) -> Tie:
    """The tie if this slit had another width, in a patch of intact material around it."""
    trial = replace(slit, width=min(width, slit.length))
    lower, upper = (b[:2] for b in region.bounds())
    low, high = trial.bounds()
    patch = _Patch(lower=np.maximum(lower, low - 5 * dx), upper=np.minimum(upper, high + 5 * dx), slit=trial)
    seeds = seeding.fill(patch, origin[:2], dx)
    if turn is not None:
        seeds, trial = turn.back(seeds, trial)
        return slit_tie(seeds, trial, shape, dx, np.zeros(2))
    return slit_tie(seeds, trial, shape, dx, origin)


class _Patch:
    """Material around one slit in the x-y plane, bounded to keep the check cheap."""

    def __init__(self, *, lower: np.ndarray, upper: np.ndarray, slit: Slit):
        self._bounds, self._slit = (lower, upper), slit

    def bounds(self):
        return self._bounds

    def contains(self, x: np.ndarray) -> np.ndarray:
        lower, upper = self._bounds
        return np.all((x > lower) & (x < upper), axis=1) & ~self._slit.contains(x)
