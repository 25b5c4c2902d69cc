"""Which arrays the checkpoint of a run has, of which kind and shape: known from the scene alone."""

import numpy as np

from rsmpm_ti.fields.contacts import pushing_planes
from rsmpm_ti.fields.geometry import Geometry
from rsmpm_ti.fields.particles import stored
from rsmpm_ti.fields.records import event_capacity, has_normals
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.run.kept.reading import Header, need
from rsmpm_ti.run.settings import Settings
from rsmpm_ti.spec.scene import Scene

MOST_TEXT = 32 * 2**20
"""Characters of a checkpoint's text: settings, and what observers remember beside arrays."""

ROWS, EVENTS, SLOTS, WALLS = "rows", "events", "slots", "walls"
"""Lengths that the scene does not say: of the history, of events, of a ledger with a slot for each thread, of nodes at
the walls of holes."""

OBSERVERS = "observer_"
"""Names of arrays that observers remember begin so."""


def layout(scene: Scene, count: int, settings: Settings) -> dict[str, tuple[np.dtype, tuple]]:
    """Name -> kind and shape of every array but the text and those of observers. count: particles."""
    real, f64, i32 = (np.dtype(t) for t in (settings.kind, np.float64, np.int32))
    dim, geometry, boundaries = scene.dim, Geometry(scene), len(scene.loading.boundaries)
    found: dict[str, tuple[np.dtype, tuple]] = {}

    def add(kind, shape: tuple, *names: str) -> None:
        found.update(dict.fromkeys(names, (np.dtype(kind), shape)))

    fields = stored(scene)
    for kind, word in ((real, "real"), (i32, "whole")):
        size = sum(entry.size for entry in fields if entry.whole == (word == "whole"))
        add(kind, (count,), *(f"particle_{word}_{k}" for k in range(size)))
    add(i32, (count,), "particle_key")
    acting = max(1, boundaries)
    add(f64, (acting, dim), "ledger_impulse", "history_impulse")
    add(f64, (acting,), "ledger_work", "ledger_latest", "ledger_speed")
    add(f64, (SLOTS,), "ledger_body_work", "ledger_viscous", "ledger_released", "ledger_damped", "ledger_mixed")
    add(f64, (2,), "ledger_stopped")
    add(f64, (EVENTS,), "event_time")
    add(real, (EVENTS,), "event_sigma_1", "event_sigma_3", "event_released")
    add(real, (EVENTS, dim), "event_x", *["event_normal"] * has_normals(scene))
    add(i32, (EVENTS,), "event_mode", "event_id")
    add(i32, (3,), "event_by_mode")
    add(f64, (), "event_onset", "end", "clock_dt", "clock_since", "clock_pace", "clock_loaded")
    if scene.servo is not None:
        add(f64, (), "servo_pace", "servo_least", "servo_most_elastic", "servo_dissipated")
    add(f64, (dim, 2), "grid_travel", "grid_began", "grid_velocity", "grid_answered")
    add(f64, (dim, 3), "grid_frame")
    for k, plane in enumerate(pushing_planes(scene, geometry)[0]):
        add(real, plane.extent, f"seat_{k}")
        add(i32, plane.extent, f"contact_{k}")
    if scene.loading.holes:
        add(f64, (WALLS, dim), "wall_forces")
    columns = len(HISTORY_COLUMNS) + len(scene.loading.cell.gauges) + len(settings.columns)
    add(f64, (ROWS, columns), "history")
    add(f64, (columns,), "history_zero")
    energies = ("start", "quiet", "work", "exchanged", "most", "created")
    add(f64, (), "history_time", *(f"history_energy_{name}" for name in energies))
    add(f64, (ROWS if boundaries else 0, 1 + boundaries * (dim + 1)), "reactions")
    add(np.int64, (), "dropped_count", "clock_step", "clock_total", "clock_first")
    add(f64, (), "dropped_mass", "dropped_energy")
    add(f64, (dim,), "dropped_momentum")
    return found


def check_layout(headers: dict[str, Header], scene: Scene, count: int, settings: Settings) -> None:
    """Raises Damaged unless the arrays of a file are those of the scene's checkpoints."""
    wanted, lengths = layout(scene, count, settings), dict[str, int]()
    own = {name for name in headers if name != "text" and not name.startswith(OBSERVERS)}
    missing, odd = sorted(set(wanted) - own), sorted(own - set(wanted))
    need(not missing, f"array {missing[:1]} is missing")
    need(not odd, f"array {odd[:1]} belongs to no such run")
    for name, (kind, shape) in wanted.items():
        there = headers[name]
        need(there.dtype == kind, f"array {name} is of {there.dtype}, not {kind}")
        need(len(there.shape) == len(shape), f"array {name} has shape {there.shape}")
        for n, length in zip(there.shape, shape, strict=True):
            agreed = lengths.setdefault(length, n) if isinstance(length, str) else length
            need(n == agreed, f"array {name} has shape {there.shape}")
    most = event_capacity(scene, count) if scene.breaks else 0
    need(lengths[EVENTS] <= most, f"it has {lengths[EVENTS]} events, and {count} particles have at most {most}")
    need(lengths[SLOTS] >= 1, "its ledger is empty")
