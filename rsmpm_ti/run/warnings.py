"""What the numbers of a run must not be taken for: sentences for summary.json and for the terminal. NumPy only."""

import numpy as np

from rsmpm_ti.fields.geometry import Geometry
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import INTACT, Snapshot
from rsmpm_ti.spec.boundaries import Absorbing, Platen
from rsmpm_ti.spec.drawings.answers import inside
from rsmpm_ti.spec.holes.pressure import around, pressures_of
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Disc
from rsmpm_ti.spec.scene import Scene

MAX_IMBALANCE = 0.01
"""Platen imbalance up to which a test is called quasi-static: a load is then known to a per cent."""

MAX_KINETIC = 0.05
"""Kinetic over stored energy after which a test is no longer called quasi-static: speeds then are a fifth of those at
which all that was stored is motion."""

MAX_FILTERED = 0.02
"""What the filter may take from a peak, as a fraction of it, before that is said: twice what `auto` allows inertia."""

NEAR_PLATEN = 1.5
"""Cells from a platen within which its row of nodes has a part in the stress: the reach of a B-spline."""

SAME_LOAD = 0.005
"""Fraction of the time to first failure within which failures count as first too: half a per cent of a steady load."""

MOST_MOVED = 0.5
"""Cells by which the wall of a hole may move before it is said: the pressure acts where it was."""

MIDDLE = 1.0 / 3.0
"""Part of a disc's loaded diameter, about its centre, on which a Brazilian test must break: there tension is within a
per cent of that in the middle (Hondros 1959), and farther out the wedges below the platens begin."""


def warnings_of(scene: Scene, numbers: dict, history: np.ndarray, events: EventTable) -> list[str]:
    """Sentences, most of them with a remedy; numbers: of summary.json so far."""
    found = [
        *([_beside_the_middle(scene, events), _near_platen(scene, events)] if len(events) else []),
        _settling(scene, events),
        _sudden_start(scene),
        _no_stress(scene),
        _imbalance(numbers),
        _motion(scene, numbers, history),
        _between_peaks(numbers),
        numbers.get("numerical_fracture") or "",
    ]
    return [sentence for sentence in found if sentence]


def _settling(scene: Scene, events: EventTable) -> str:
    """Failures before the clock started."""
    failed = int(np.count_nonzero(events.time == 0.0)) if scene.loading.settle else 0
    if not failed:
        return ""
    return (
        f"{failed} failures while the bodies settled, booked at time 0: the rock does not bear what loads it at the "
        f"start; lower that, or take it for the first result"
    )


def _sudden_start(scene: Scene) -> str:
    """Platens at full speed from the first step on a body at rest: rho c v runs through it as a wave."""
    moving = [b for b in scene.loading.boundaries if isinstance(b, Platen) and b.speed != 0.0]
    at_rest = all(body.velocity is None and body.spin == 0.0 for body in scene.bodies)
    if not moving or not at_rest or not isinstance(scene.loading.start, AtRest):
        return ""
    stress = scene.density * scene.wave_speed * max(abs(platen.speed) for platen in moving)
    return (
        f"platens move at full speed from the first step on a body at rest: a wave of rho c v = {stress / 1e6:.3g} MPa "
        f"runs through it; take start = Affine or Ramp for a static test"
    )


def _no_stress(scene: Scene) -> str:
    """Forces without the width by which they would be a stress: there is no load to draw."""
    cell = scene.loading.load_cell
    if cell is None or cell.width is not None:
        return ""
    return "loading.width is missing: forces of platens do not become stress, and no load curve is drawn; give it"


def _imbalance(numbers: dict) -> str:
    imbalance = numbers["platen_imbalance"]
    if imbalance is None or imbalance <= MAX_IMBALANCE:
        return ""
    return (
        f"platen imbalance {100.0 * imbalance:.2g} %: above {100.0 * MAX_IMBALANCE:g} % the loading is not "
        f"quasi-static; lower loading.time_scale or the speed"
    )


def kinetic_share_after(history: np.ndarray, first: float | None) -> float | None:
    """Largest kinetic energy after the first failure at a time [s], over the largest elastic energy so far."""
    if first is None:
        return None
    ratio, after = _kinetic_ratio(history), history["time_s"] >= first
    return float(ratio[after].max()) if after.any() else None


def _kinetic_ratio(history: np.ndarray) -> np.ndarray:
    stored = np.maximum.accumulate(history["energy_elastic_J"])
    return history["energy_kinetic_J"] / np.where(stored > 0.0, stored, np.inf)


def _motion(scene: Scene, numbers: dict, history: np.ndarray) -> str:
    """A collapse that sets the specimen in motion is no quasi-static test any more, and knows of its mass. Where
    bodies fly or fall it was none before."""
    share = numbers["kinetic_share_after"]
    dynamic = scene.loading.force_field is not None or any(body.velocity or body.spin for body in scene.bodies)
    dynamic = dynamic or any(isinstance(boundary, Absorbing) for boundary in scene.loading.boundaries)
    if share is None or share <= MAX_KINETIC or dynamic:
        return ""
    over = _kinetic_ratio(history) > MAX_KINETIC
    over &= history["time_s"] >= numbers["first_failure_time_s"]
    strain, peak = float(history["axial_strain"][over.argmax()]), numbers["peak_filtered_strain"]
    where = "" if peak is None else ", after the peak" if abs(strain) >= abs(peak) else ", before the peak"
    remedy = "" if scene.servo is not None or scene.loading.platens is None else "; loading.servo = Servo slows platens"
    at = f"from a strain of {strain:.3g} on{where}" if np.isfinite(strain) else "after the first failure"
    return (
        f"kinetic energy reaches {100.0 * share:.2g} % of the largest elastic energy, more than "
        f"{100.0 * MAX_KINETIC:g} % {at}: the test is not quasi-static there, and its load depends on the speed and "
        f"the mass scaling{remedy}"
    )


def _between_peaks(numbers: dict) -> str:
    """A load that breaks off within the width of the filter: its median takes the end of the rise away."""
    filtered, largest = numbers["peak_filtered_Pa"], numbers["largest_stress_Pa"]
    if filtered is None or largest is None or abs(largest) - abs(filtered) <= MAX_FILTERED * abs(filtered):
        return ""
    below = 100.0 * (1.0 - abs(filtered) / abs(largest))
    return (
        f"the peak as a running median, {filtered / 1e6:.4g} MPa, is {below:.2g} % below that of one row, "
        f"{largest / 1e6:.4g} MPa: the strength lies between; a lower loading.time_scale brings them together"
    )


def _near_platen(scene: Scene, events: EventTable) -> str:
    """The first failures, against where the platens are then, after the travel of a steady speed at most.

    Where all rock is as near to failure, as in an intact specimen, it fails everywhere at almost one load, and that the
    first of all is beside a platen says nothing.
    """
    first = events.time <= (1.0 + SAME_LOAD) * events.time[0]
    x, time, dx = events.x[first].astype(float), events.time[first], scene.domain.dx
    for platen in scene.loading.boundaries:
        if not isinstance(platen, Platen):
            continue
        inward = 1.0 if platen.side == "lower" else -1.0
        travel = np.maximum(0.0, inward * platen.speed * time)
        distance = (inward * (x[:, platen.axis] - platen.position) - travel) / dx
        if distance[0] < NEAR_PLATEN and np.mean(distance < NEAR_PLATEN) > 0.5:
            return (
                f"the first failure is {max(0.0, float(distance[0])):.2g} cells from the platen at "
                f"{1e3 * platen.position:g} mm: within {NEAR_PLATEN:g} cells stress is that of the contact and the "
                f"grid; the load at first failure is no strength of the rock"
            )
    return ""


def _beside_the_middle(scene: Scene, events: EventTable) -> str:
    """A whole disc between platens that does not break from its middle."""
    regions = [body.region for body in scene.bodies]
    if scene.dim != 2 or len(regions) != 1 or not isinstance(regions[0], Disc) or scene.loading.platens is None:
        return ""
    disc, axis = regions[0], scene.loading.platens[0].axis
    offset = np.abs(events.x[0].astype(float) - np.array(disc.centre))
    if offset.max() <= MIDDLE * disc.radius:
        return ""
    position = ", ".join(f"{1e3 * c:.2f}" for c in events.x[0])
    return (
        f"the first failure, at ({position}) mm, is {offset[axis] / disc.radius:.2g} R along and "
        f"{offset[1 - axis] / disc.radius:.2g} R beside the loaded diameter from the centre, not in its middle third: "
        f"neither its load nor the peak is a strength; for one take rock with a fracture energy (disc_lab) and an "
        f"arc of some 10 degrees"
    )


def walls_moved(scene: Scene, snapshot: Snapshot, frame: np.ndarray) -> list[str]:
    """Holes whose wall of intact rock has moved too far for the pressure to be on it; frame: of the grid, now."""
    said, geometry = [], Geometry(scene)
    start = snapshot.x - snapshot.displacement
    for k, hole in pressures_of(scene):
        near = np.any([inside(hole.region, start + step) for step in around(scene.dim, scene.domain.dx)], axis=0)
        near &= snapshot.failure_mode == INTACT
        moved = geometry.coordinates_at(snapshot.x[near], frame) - geometry.coordinates_at(start[near])
        most = float(np.linalg.norm(moved, axis=1).max(initial=0.0))
        if most > MOST_MOVED:
            said.append(
                f"the wall of holes[{k}] has moved by {most:.2g} cells: its pressure acts where the wall was at the "
                f"start, and is right up to {MOST_MOVED:g}; take a larger dx, a lower pressure or an earlier end"
            )
    return said
