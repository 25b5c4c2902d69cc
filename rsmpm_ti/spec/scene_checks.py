"""Whether the parts of a scene fit each other: bodies, loading and what moves at the start.

Everything is arithmetic on the parts; nothing is seeded. Each check raises SceneError, in one line.
"""

import itertools
import math

import numpy as np

from rsmpm_ti.errors import SceneError, refuse, shown
from rsmpm_ti.method.shape import Gimp
from rsmpm_ti.method.time_step import MAX_COUNT
from rsmpm_ti.rock.after_failure import check_law
from rsmpm_ti.spec.boundaries import Absorbing, Platen
from rsmpm_ti.spec.drawings.answers import inside
from rsmpm_ti.spec.ground.gravity import Gravity
from rsmpm_ti.spec.loading_start import Affine, Press, Program, Ramp
from rsmpm_ti.spec.mass_scaling import MIN_TRANSITS

MAX_TRAVEL = 0.4
"""Largest way of a body or a boundary in one step [cells]: what a step may do to a particle (`advance.SAFE_CELLS`)."""

SINGLE_FRACTION = 1e-5
"""Smallest cell over the largest coordinate in single precision: places are then rounded to 0.6 % of a cell."""


def check_bodies(scene) -> None:
    lower, upper = np.array(scene.domain.lower), np.array(scene.domain.upper)
    count = 0.0
    for k, body in enumerate(scene.bodies):
        low, high = body.region.bounds()
        if len(low) != scene.dim:
            raise SceneError(f"bodies[{k}].region has {len(low)} dimensions, domain has {scene.dim}")
        slack = 1e-9 * (upper - lower)
        if np.any(low < lower - slack) or np.any(high > upper + slack):
            raise SceneError(
                f"bodies[{k}].region from {low.tolist()} to {high.tolist()} m lies outside the domain from "
                f"{list(scene.domain.lower)} to {list(scene.domain.upper)} m; enlarge the domain or move the body, "
                f"{shown(body.region)}"
            )
        count += math.prod((high - low) / scene.domain.dx * body.seeding.particles_per_axis)
        if body.velocity is not None and len(body.velocity) != scene.dim:
            raise refuse(f"bodies[{k}].velocity", body.velocity, f"{scene.dim} components in m/s")
        if isinstance(scene.shape, Gimp) and not math.isclose(
            scene.shape.half_width, 0.5 / body.seeding.particles_per_axis
        ):
            fitting = f"{0.5 / body.seeding.particles_per_axis} for this seeding"
            remedy = "particle domains would overlap or leave gaps"
            raise refuse("shape.half_width", scene.shape.half_width, fitting, remedy)
    if count > MAX_COUNT:
        most = f"such that bodies have at most {MAX_COUNT:.3g} particles, not {count:.3g}"
        raise refuse("domain.dx", scene.domain.dx, most)


def check_precision(scene, precision: str) -> None:
    """Refuse single precision where it cannot tell places within a cell: it rounds them to 6e-8 of a coordinate."""
    far = scene.domain.farthest
    if precision == "f32" and not scene.domain.dx >= SINGLE_FRACTION * far:
        allowed = f"'f64' where dx is less than {SINGLE_FRACTION:g} of the largest coordinate, {far:g} m"
        raise refuse("precision", precision, allowed, "or move the domain to the origin")


def check_loading(scene) -> None:
    loading, domain = scene.loading, scene.domain
    if loading.body_force is not None and len(loading.body_force) != scene.dim:
        raise refuse("loading.body_force", loading.body_force, f"{scene.dim} components in m/s^2")
    for k, boundary in enumerate(loading.boundaries):
        if boundary.axis >= scene.dim:
            raise refuse(f"boundaries[{k}].axis", boundary.axis, f"below the dimension {scene.dim}")
        lower, upper = domain.lower[boundary.axis], domain.upper[boundary.axis]
        slack = 0.5 * domain.dx
        if not lower - slack <= boundary.position <= upper + slack:
            allowed = f"in the domain, along axis {boundary.axis} in [{lower}, {upper}] m"
            raise refuse(f"boundaries[{k}].position", boundary.position, allowed)
        span = getattr(boundary, "span", None)
        if span is not None:
            across = 1 if boundary.axis == 0 else 0
            if not (span[0] < domain.upper[across] and span[1] > domain.lower[across]):
                edges = f"[{domain.lower[across]}, {domain.upper[across]}] m"
                raise refuse(f"boundaries[{k}].span", span, f"an interval that meets the domain, {edges}")
        cells = (boundary.position - domain.lower[boundary.axis]) / domain.dx
        if abs(cells - round(cells)) > 1e-3 and not domain.turn:
            allowed = f"on a plane of grid nodes along axis {boundary.axis}"
            nearest = f"the nearest is {domain.lower[boundary.axis] + round(cells) * domain.dx:.9g} m"
            raise refuse(f"boundaries[{k}].position", boundary.position, allowed, nearest)
    _check_absorbing(loading)
    _check_turned(scene)
    _check_load_cell(scene)
    if scene.schedule.strain_end is not None or isinstance(loading.start, Affine):
        if loading.platens is None:
            needed = "two platens that face each other in loading.boundaries"
            raise SceneError(f"strain_end and the Affine start need {needed}; give t_end")
        if loading.load_cell.width is None:
            raise SceneError("loading.width is missing: platen forces need a loaded width to become stress")
    if loading.ends and not loading.height > 0.5 * domain.dx:  # planes of nodes: the same one, or crossed
        upper = loading.boundaries.index(loading.ends[1])
        raise refuse(f"boundaries[{upper}].position", loading.ends[1].position, "above that of the lower one it faces")
    _check_held(scene)
    if scene.schedule.strain_end is not None and not loading.strain_rate * scene.schedule.strain_end > 0.0:
        sign = f"of the sign of the platens' strain rate, lower speed less upper speed, {loading.strain_rate:.6g} 1/s"
        raise refuse("schedule.strain_end", scene.schedule.strain_end, sign)
    if isinstance(loading.start, (Press, Program)) and scene.schedule.strain_end is not None:
        name = type(loading.start).__name__
        raise SceneError(f"start = {name} stops the platens itself: give t_end, hold included, no strain_end")
    if isinstance(loading.start, (Ramp, Press)) and loading.platens:
        transits = loading.start.time * scene.wave_speed / loading.height
        if transits < MIN_TRANSITS * (1.0 - 1e-9):
            least = f"at least {MIN_TRANSITS * loading.height / scene.wave_speed:.4g} s, 5 wave transits"
            raise refuse("start.time", loading.start.time, least)
    _check_sides(loading)


def _check_absorbing(loading) -> None:
    """Dashpots bear nothing at rest."""
    loads = {"initial_stress": loading.initial_stress, "body_force": loading.body_force, "settle": loading.settle}
    loads["force_field"] = isinstance(loading.force_field, Gravity)
    given = next((name for name, value in loads.items() if value), None)
    for k, boundary in enumerate(loading.boundaries):
        if isinstance(boundary, Absorbing) and given:
            remedy = "it carries no load at rest: take a Wall, further away"
            raise refuse(f"boundaries[{k}]", boundary, f"one that does not absorb beside loading.{given}", remedy)


def _check_turned(scene) -> None:
    """A turned grid has no planes of nodes for what touches and leaves, rubs, or gives way."""
    boundaries = scene.loading.boundaries
    if not scene.domain.turn or not boundaries:
        return
    remedy = "set domain.turn = 0"
    if len(boundaries) != 2 or scene.loading.platens is None:
        raise refuse("domain.turn", scene.domain.turn, "0 but for two platens that face each other, alone", remedy)
    for k, platen in enumerate(boundaries):
        if not isinstance(platen, Platen) or platen.unilateral or platen.bonded:
            raise refuse(f"boundaries[{k}]", platen, "a Platen with pulls = True on a turned grid", remedy)
        if platen.held or platen.friction or platen.span is not None:
            raise refuse(
                f"boundaries[{k}]", platen, "one of a speed, smooth and without a span on a turned grid", remedy
            )


def _check_sides(loading) -> None:
    """The grid follows what bounds it, and it can follow one motion of one plane on a side of an axis."""
    for k, boundary in enumerate(loading.boundaries):
        beside = [b for b in loading.boundaries[:k] if (b.axis, b.side) == (boundary.axis, boundary.side)]
        for other in beside:
            if other.held or boundary.held:
                allowed = "alone on its side"
                raise refuse(f"boundaries[{k}]", boundary, allowed, "a force moves a whole side, the grid with it")
            if other.speed != boundary.speed:
                allowed = f"{other.speed} m/s, that of the boundary beside it on the {boundary.side} side"
                remedy = "the grid goes with the platens: one side, one motion; leave a gap in place of one at rest"
                raise refuse(f"boundaries[{k}].speed", boundary.speed, allowed, remedy)
            if boundary.speed and other.position != boundary.position:
                allowed = f"{other.position} m, that of the boundary beside it, which moves with it"
                raise refuse(f"boundaries[{k}].position", boundary.position, allowed, "or let the other side move")
        if _pulls_away(loading, boundary):
            remedy = "it only pushes: set pulls = True (glued, free to move laterally) or bonded = True"
            raise refuse(f"boundaries[{k}].speed", boundary.speed, "towards the other platen", remedy)


def _check_held(scene) -> None:
    loading = scene.loading
    for k, boundary in enumerate(loading.boundaries):
        if boundary.held and boundary.stress is not None and loading.width is None:
            raise SceneError(f"loading.width is missing: the force of boundaries[{k}] is its stress over that width")
        if boundary.held and scene.schedule.strain_end is not None:
            ends = "give t_end, and set strain_end = none"
            raise SceneError(f"boundaries[{k}] is moved by a force, so strain_end may never come: {ends}")


def _pulls_away(loading, boundary) -> bool:
    """Whether a platen that only pushes leaves the specimen from the start on."""
    pair = loading.platens
    return pair is not None and boundary in pair and boundary.unilateral and loading.strain_rate < 0.0


def _check_load_cell(scene) -> None:
    """What is measured must be there: boundaries on their side of the axis, and rock at the ends of a gauge."""
    given, cell = scene.loading.cell, scene.loading.load_cell
    if given.axis is not None and given.axis >= scene.dim:
        raise refuse("cell.axis", given.axis, f"below the dimension {scene.dim}")
    if cell is None and (given.lower is not None or given.upper is not None):
        raise refuse("cell.axis", None, "given where no two platens face each other", "say along which axis it reads")
    if given.axis is not None and not cell.lower and not cell.upper:
        raise refuse("cell.axis", given.axis, "an axis along which platens press", "name boundaries by lower, upper")
    for side in ("lower", "upper"):
        for k in getattr(given, side) or ():
            boundaries = scene.loading.boundaries
            if k >= len(boundaries) or (boundaries[k].axis, boundaries[k].side) != (cell.axis, side):
                allowed = f"indices of loading.boundaries with axis = {cell.axis} and side = {side!r}"
                raise refuse(f"cell.{side}", getattr(given, side), allowed)
    for gauge in given.gauges:
        for name in ("a", "b"):
            point = getattr(gauge, name)
            if len(point) != scene.dim:
                raise refuse(f"gauge.{name}", point, f"{scene.dim} coordinates in metres")
            if not _near_rock(scene, point):
                raise refuse(
                    f"gauge.{name}", point, "within a cell of a body", f"gauge {gauge.name!r} hangs in the air"
                )
        if gauge.length < scene.domain.dx:
            allowed = f"at least a cell, {scene.domain.dx:g} m, away from gauge.a"
            raise refuse("gauge.b", gauge.b, allowed, "both ends would be glued to the same particle")


def check_stop(scene) -> None:
    """A run that ends by its load must have one."""
    cell, drop = scene.loading.load_cell, scene.schedule.stop_after_drop
    if drop is not None and (cell is None or not (cell.lower or cell.upper) or cell.width is None):
        remedy = "give two platens that face each other and loading.width, or a loading.cell"
        raise refuse("schedule.stop_after_drop", drop, "None where no load is measured", remedy)


def _near_rock(scene, point: tuple[float, ...]) -> bool:
    """Whether a point, or one a cell from it along axes or between them, lies in a body; surfaces belong to no body."""
    around = np.array(point) + scene.domain.dx * np.array(list(itertools.product((-1.0, 0.0, 1.0), repeat=scene.dim)))
    return any(inside(body.region, around).any() for body in scene.bodies)


def check_motion(scene) -> None:
    """Nothing may start faster than a step can follow."""
    most = MAX_TRAVEL * scene.domain.dx / scene.dt
    allowed = f"such that a step of {scene.dt:.4g} s moves nothing by more than {MAX_TRAVEL:g} cells, {most:.4g} m/s"
    for k, boundary in enumerate(scene.loading.boundaries):
        if not abs(boundary.speed) <= most:
            raise refuse(f"boundaries[{k}].speed", boundary.speed, allowed)
    for k, body in enumerate(scene.bodies):
        low, high = body.region.bounds()
        flight, rim = math.hypot(*(body.velocity or ())), abs(body.spin) * 0.5 * math.hypot(*(high - low)[:2])
        if not flight + rim <= most:
            name = "velocity" if flight >= rim else "spin"
            raise refuse(f"bodies[{k}].{name}", getattr(body, name), allowed)
    pull = math.hypot(*(scene.loading.body_force or ())) / scene.time_scale**2
    if not pull * scene.dt <= most:
        raise refuse("loading.body_force", scene.loading.body_force, allowed)


def check_cracks(rock, shape, dim: int, dx: float) -> None:
    """Refuse rock that this grid (shape functions, dimension, cell size dx [m]) cannot break as its laws say."""
    law = rock.after_failure
    check_law(law)
    if dim not in law.dimensions or (law.oriented and dim != 2):
        raise refuse("rock.after_failure", law, f"isotropic in {dim}D", "use CompressionOnly, Void or Clipped")
    if rock.nonlocal_mean.acts:
        if not law.oriented:
            remedy = "use Local() or after_failure = Directional(...)"
            raise refuse("rock.nonlocal_mean", rock.nonlocal_mean, "Local with the paper's laws after failure", remedy)
        rock.nonlocal_mean.check(dx)
    if rock.criterion.breaks:
        law.check(rock, shape, dx)
