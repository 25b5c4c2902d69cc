"""Whether a slit's two faces really separate on the grid. It needs the particles but no kernel: NumPy only."""

import itertools
import math
from dataclasses import replace

import numpy as np

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.regions import Slit
from rsmpm_ti.spec.seeding import Seeds

BRIDGE_LIMIT = 0.02
"""Largest fraction of a full node's mass that both faces of a slit may have in common.

A slit of two cells at 45 degrees on a lattice leaves 1/64 = 0.016 on its diagonal nodes with linear functions, which
a static solution shows to be a flaw (docs/references.md, section 15); one of one cell leaves 0.11 and is not.
"""


def slit_bridge(seeds: Seeds, slit: Slit, shape, dx: float, origin: np.ndarray) -> float:
    """Largest fraction of a full node's mass that both faces of a slit put on one node, away from the slit's ends.

    `seeds` are the particles of the cut body. 0 means that no node sees both faces.
    """
    x = seeds.x
    reach = (shape.width / 2.0) * dx
    frame = slit.frame(x)
    near = (np.abs(frame[:, 0]) < 0.5 * slit.length + 2.0 * reach) & (
        np.abs(frame[:, 1]) < 0.5 * slit.width + 2.0 * reach
    )
    x, side, mass_p = x[near, :2], frame[near, 1] > 0.0, seeds.volume[near] / dx ** x.shape[1]
    base = np.floor((x - origin[:2]) / dx - shape.shift).astype(int)
    n = tuple(base.max(axis=0) + shape.width) if len(base) else (1, 1)
    mass = np.zeros((2, *n))
    for offset in itertools.product(range(shape.width), repeat=2):
        node = base + np.array(offset)
        w = np.prod(shape.profile((x - origin[:2]) / dx - node), axis=1)
        np.add.at(mass, (side.astype(int), node[:, 0], node[:, 1]), w * mass_p)
    fraction = mass.min(axis=0)
    nodes = np.stack(np.meshgrid(*(np.arange(k) for k in n), indexing="ij"), axis=-1).reshape(-1, 2) * dx + origin[:2]
    inner = np.abs(slit.frame(nodes)[:, 0]) < 0.5 * slit.length - math.sqrt(2.0) * reach
    return float(fraction.ravel()[inner].max(initial=0.0))


def check_slit(region, slit: Slit, seeding, shape, dx: float, origin: np.ndarray) -> None:
    """Refuse a slit beside its body, or whose faces stay glued through shared nodes, naming a width that would do."""
    lower, upper = (bound[:2] for bound in region.bounds())
    low, high = slit.bounds()
    if np.any(low >= upper) or np.any(high <= lower):
        box = f"in its body, whose lower and upper corners are {lower.tolist()} and {upper.tolist()} m"
        raise refuse("slit.centre", slit.centre, box, "it cuts nothing where it is")
    bridge = _bridge_of_width(region, slit, slit.width, seeding, shape, dx, origin)
    if bridge <= BRIDGE_LIMIT:
        return
    for cells in np.arange(1.0, 6.01, 0.25):
        width = cells * dx
        if width > slit.width and _bridge_of_width(region, slit, width, seeding, shape, dx, origin) <= BRIDGE_LIMIT:
            raise SceneError(
                f"slit.width = {slit.width:.6g} m is refused: at {slit.angle:g} degrees its faces share grid nodes "
                f"({100 * bridge:.1f} % of a node's mass, at most {100 * BRIDGE_LIMIT:g} % allowed), so it would be a "
                f"weak inclusion and no flaw; use a width of at least {width:.6g} m ({cells:g} cells) or a finer dx"
            )
    raise SceneError(f"slit.width = {slit.width:.6g} m is refused: no width up to 6 cells separates its faces")


def _bridge_of_width(region, slit: Slit, width: float, seeding, shape, dx: float, origin: np.ndarray) -> float:
    """The bridge if this slit had another width, on a patch of intact material around it."""
    trial = replace(slit, width=min(width, slit.length))
    lower, upper = (b[:2] for b in region.bounds())
    low, high = trial.bounds()
    patch = _Patch(lower=np.maximum(lower, low - 4 * dx), upper=np.minimum(upper, high + 4 * dx), slit=trial)
    return slit_bridge(seeding.fill(patch, origin[:2], dx), trial, shape, dx, origin)


class _Patch:
    """Material around one slit in the x-y plane, bounded to keep the check cheap."""

    def __init__(self, *, lower: np.ndarray, upper: np.ndarray, slit: Slit):
        self._bounds, self._slit = (lower, upper), slit

    def bounds(self):
        return self._bounds

    def contains(self, x: np.ndarray) -> np.ndarray:
        lower, upper = self._bounds
        return np.all((x > lower) & (x < upper), axis=1) & ~self._slit.contains(x)
