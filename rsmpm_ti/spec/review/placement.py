"""Whether what a scene puts somewhere is where it does something: flaws, bodies and platens. NumPy only.

What may be meant is said; what cannot be is refused: see `sentences.py` and `Scene.particles`.
"""

import itertools
import math

import numpy as np

from rsmpm_ti.errors import SceneError, refuse
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.drawings.answers import inside
from rsmpm_ti.spec.drawings.mask import Mask
from rsmpm_ti.spec.drawings.mesh import Mesh
from rsmpm_ti.spec.drawings.polygon import Polygon
from rsmpm_ti.spec.regions import Box, Disc, Slit, Turned, parts_of, removals_of, taken_apart
from rsmpm_ti.spec.seeding import Seeds

SHARED_FRACTION = 1e-3
"""Fraction of the smaller of two bodies that may lie in the other: particles fitted to a common curved edge sit at
centroids, which may be beyond it."""

BEYOND = 0.5
"""Cells by which a body may reach beyond a platen: what lies between its plane and the next node feels the platen."""

AWAY = 1.0
"""Cells between a platen and the nearest particle's edge from which on it touches nothing: stencils reach so far."""

AREA_ERROR = 0.005
"""Error of the particles' area (volume in 3D) above which it is said: by as much loads and masses are wrong."""

SAMPLES = 2**17
"""Points by which a region is measured. A Kronecker sequence errs by some 1e-5 for a disc, 1e-4 for a ball."""


MAX_PARTS = 50
"""Regions in a region, and bodies of such regions, that are measured by counting: 10 ms each."""


def check_overlap(scene, seeds: list[Seeds]) -> None:
    """Refuse two bodies in one place: there would be two rocks in it, twice as stiff, heavy and strong."""
    bounds = np.array([body.region.bounds() for body in scene.bodies])
    slack = 1e-9 * scene.domain.dx
    for k in range(1, len(bounds)):
        meets = np.all((bounds[:k, 1] > bounds[k, 0] + slack) & (bounds[:k, 0] < bounds[k, 1] - slack), axis=1)
        for j in map(int, np.flatnonzero(meets)):
            both = max(_inside(scene, seeds, k, j), _inside(scene, seeds, j, k))
            smaller = min(seeds[j].volume.sum(), seeds[k].volume.sum())
            if both > SHARED_FRACTION * smaller:
                raise SceneError(
                    f"bodies[{k}].region overlaps bodies[{j}].region: {100.0 * both / smaller:.3g} % of the smaller "
                    f"one lies in the other, so that there would be two rocks in one place; move one, cut it by "
                    f"Difference, or make them one body, Union(parts=(...))"
                )


def _inside(scene, seeds: list[Seeds], mine: int, other: int) -> float:
    """Volume of the particles of a body that lie in the region of another [m^dim]."""
    x, region = seeds[mine].x, scene.bodies[other].region
    low, high = region.bounds()
    near = np.flatnonzero(np.all((x > low) & (x < high), axis=1))
    return float(seeds[mine].volume[near][inside(region, x[near])].sum()) if len(near) else 0.0


def outside_fraction(whole, slit: Slit) -> float:
    """Fraction of a slit's area that lies out of what it is cut from; in 3D, at every depth."""
    s = (np.arange(64) + 0.5) / 64.0 - 0.5
    along, across = np.meshgrid(slit.length * s, slit.width * s[::8], indexing="ij")
    t = slit.direction
    points = np.array(slit.centre[:2]) + along.reshape(-1, 1) * t + across.reshape(-1, 1) * np.array([-t[1], t[0]])
    points = points[slit.contains(points)]
    low, high = whole.bounds()
    depths = [low[2] + f * (high[2] - low[2]) for f in (0.05, 0.275, 0.5, 0.725, 0.95)] if len(low) == 3 else [None]
    held = np.zeros(len(points), dtype=bool)
    for z in depths:
        held |= inside(whole, points if z is None else np.column_stack([points, np.full(len(points), z)]))
    return 1.0 - float(held.mean()) if held.any() else 1.0 - _inside_fraction(whole, slit)


def _inside_fraction(whole, slit: Slit) -> float:
    """Fraction of a slit's area in a region, by counting points where both may be: of a slit so much larger than its
    region that points of the slit miss it."""
    low, high = (np.array(bound, dtype=float) for bound in whole.bounds())
    first, last = slit.bounds()
    low[:2], high[:2] = np.maximum(low[:2], first), np.minimum(high[:2], last)
    if np.any(high <= low):
        return 0.0
    x = low + _kronecker(SAMPLES, len(low)) * (high - low)
    both = float(np.mean(slit.contains(x) & inside(whole, x)))
    return both * float(np.prod((high - low)[:2])) / (slit.length * slit.width)


def _flaws(scene):
    """(body, what was cut, its slits with the fraction of each that is outside) for every slit and set of them."""
    for k, body in enumerate(scene.bodies):
        for whole, part in removals_of(body.region):
            slits = [piece for piece in taken_apart(part) if isinstance(piece, Slit)]
            if slits:
                yield k, part, [(slit, outside_fraction(whole, slit)) for slit in slits]


def check_flaws(scene) -> None:
    """Refuse a slit that is all outside, and a set of which all are."""
    for k, part, slits in _flaws(scene):
        if all(outside == 1.0 for _, outside in slits):
            lower, upper = (bound.tolist() for bound in scene.bodies[k].region.bounds())
            box = f"in its body, bodies[{k}], whose lower and upper corners are {lower} and {upper} m"
            name = "slit.centre" if len(slits) == 1 else "segments.traces"
            value = slits[0][0].centre if len(slits) == 1 else part
            raise refuse(name, value, box, "it cuts nothing where it is")


def round_end(slit: Slit) -> float:
    """Fraction of a slit's area in one of its round ends, and what `outside_fraction` may add to that; 0 if square."""
    area = slit.width * (slit.length - slit.width) + 0.25 * math.pi * slit.width**2
    return math.pi * slit.width**2 / (8.0 * area) + 1.0 / 64.0 if slit.rounded else 0.0


def flaws_said(scene) -> list[str]:
    """A flaw that reaches out of its body is a notch, or cuts the body in two; of a set only how many do. One of which
    a round end alone lies outside is a notch that was meant."""
    said = []
    for k, _, slits in _flaws(scene):
        reaching = [(slit, outside) for slit, outside in slits if outside > round_end(slit)]
        if len(slits) > 1 and reaching:
            said.append(
                f"{len(reaching)} of the {len(slits)} flaws of a set reach out of bodies[{k}], so they are notches, or "
                f"cut it in two, or cut nothing"
            )
        elif reaching:
            slit, outside = reaching[0]
            said.append(
                f"the slit at {slit.centre} m, {slit.length:g} m long, reaches out of bodies[{k}]: "
                f"{100.0 * outside:.2g} % of it lies outside, so it is a notch or cuts the body in two"
            )
    return said


def _rooms(scene, seeds: list[Seeds]):
    """(its place in the list, platen, distance from its plane to the nearest body [m], which body) of every platen;
    negative where a body reaches beyond it."""
    for k, platen in enumerate(scene.loading.boundaries):
        if isinstance(platen, Platen):
            rooms = [_room(scene, platen, body, s) for body, s in zip(scene.bodies, seeds, strict=True)]
            yield k, platen, min(rooms), int(np.argmin(rooms))


def check_platens(scene, seeds: list[Seeds]) -> None:
    """Refuse a platen in the middle of a body: it would hold the rock beyond its plane."""
    for k, platen, room, nearest in _rooms(scene, seeds):
        if room < -BEYOND * scene.domain.dx:
            end = platen.position + (room if platen.side == "lower" else -room)
            allowed = f"at the end of the bodies: bodies[{nearest}] reaches {-room:.3g} m beyond this platen"
            raise refuse(f"boundaries[{k}].position", platen.position, allowed, f"its end is at {end:.4g} m")


def platens_said(scene, seeds: list[Seeds]) -> list[str]:
    """Platens that touch nothing."""
    said = []
    for k, platen, room, nearest in _rooms(scene, seeds):
        if room > (AWAY + 1e-6) * scene.domain.dx:
            there = "no body lies before its span"
            if room < math.inf:
                there = f"the nearest body, bodies[{nearest}], is {room:.4g} m away"
            said.append(
                f"boundaries[{k}], the platen at {platen.position:g} m along axis {platen.axis}, touches nothing: "
                f"{there}"
            )
    return said


def _room(scene, platen: Platen, body, seed: Seeds) -> float:
    """Distance from a platen's plane to the edge of the nearest particle before its span [m]; negative: beyond it."""
    half = 0.5 * scene.domain.dx / body.seeding.particles_per_axis
    x = seed.x
    if platen.span is not None:
        lateral = x[:, 1 if platen.axis == 0 else 0]
        x = x[(lateral > platen.span[0] - half) & (lateral < platen.span[1] + half)]
    inward = (x[:, platen.axis] - platen.position) * (1.0 if platen.side == "lower" else -1.0)
    return float(inward.min(initial=math.inf)) - half


def measure(region) -> float:
    """Area (volume in 3D) of a region: in closed form where it has one, else by counting points; NaN for one of so many
    parts that counting would take seconds."""
    known = _closed_form(region)
    if known is not None:
        return known
    if parts_of(region) > MAX_PARTS:
        return math.nan
    low, high = (np.asarray(bound, dtype=float) for bound in region.bounds())
    x = low + _kronecker(SAMPLES, len(low)) * (high - low)
    return math.prod(high - low) * np.count_nonzero(inside(region, x)) / SAMPLES


def _closed_form(region) -> float | None:
    if isinstance(region, Turned):
        return _closed_form(region.region)
    if isinstance(region, Box):
        return math.prod(np.subtract(region.upper, region.lower))
    if isinstance(region, Disc):
        return math.pi * region.radius**2 if len(region.centre) == 2 else 4.0 / 3.0 * math.pi * region.radius**3
    return region.area if isinstance(region, Polygon | Mask | Mesh) else None


def _kronecker(count: int, dim: int) -> np.ndarray:
    """Points of [0, 1)^dim that fill it evenly, [count, dim]: fractions of n (g^-1, g^-2, ...), g^(dim + 1) = g + 1."""
    g = 2.0
    for _ in range(60):
        g = (1.0 + g) ** (1.0 / (dim + 1))
    n = np.arange(1, count + 1)
    return np.stack([(0.5 + n * g ** -(d + 1.0)) % 1.0 for d in range(dim)], axis=1)


def area_errors(scene, seeds: list[Seeds]) -> list[float]:
    """Particles' area over that of their region, less 1, for each body; NaN where it is not known."""
    counted = sum(_closed_form(body.region) is None for body in scene.bodies)
    return [
        math.nan if counted > MAX_PARTS else s.volume.sum() / measure(body.region) - 1.0
        for body, s in zip(scene.bodies, seeds, strict=True)
    ]


def areas_said(scene, seeds: list[Seeds]) -> list[str]:
    what = "area" if scene.dim == 2 else "volume"
    wrong = [(k, error) for k, error in enumerate(area_errors(scene, seeds)) if abs(error) > AREA_ERROR]
    more = f" (and {len(wrong) - 3} bodies more)" if len(wrong) > 3 else ""
    return [
        f"bodies[{k}]: the {what} of its particles is {100.0 * error:+.2g} % off that of its region{more * (n == 2)}; "
        f"take a finer dx or seeding.fitted = true"
        for n, (k, error) in enumerate(itertools.islice(wrong, 3))
    ]
