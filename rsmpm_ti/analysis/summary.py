"""The numbers of a run that people quote: modulus, first failure, peak, initiation angles, and their trust."""

import bisect

import numpy as np

from rsmpm_ti.analysis.load_curve import FilteredLoad, loading_curve
from rsmpm_ti.analysis.wing_cracks import first_crack_angles, half_turn_mismatch, wings
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import MODE_NAMES, TENSION
from rsmpm_ti.spec.regions import slits_of
from rsmpm_ti.spec.scene import Scene

ELASTIC_RANGE = (0.2, 0.9)
"""Modulus and energy error are read between these fractions of the time to first failure."""

SYMMETRY_LENGTH = 15e-3
"""The two wings are compared over this length [m]."""


def summarise(scene: Scene, history: np.ndarray, events: EventTable, energy_start: float) -> dict:
    """The physical part of summary.json. Stresses [Pa], lengths [m], angles [degrees]; None where not defined.

    Onset: a particle first begins to lose strength; first failure, the first event: one has opened or slipped by what
    costs half of it. Without fracture energy they are one. Modulus and quasi-static measures are of what comes before
    onset.
    Under confinement axial stresses are whole ones, the pressure included, and strains count from the confined state;
    the modulus is still the slope. The platen imbalance is over what the platens add, the kinetic share over all the
    elastic energy, that of the confinement included.
    """
    middle, stress, strain = loading_curve(history)
    first = float(events.time[0]) if len(events) else np.inf
    onset = min(events.onset, first)
    before = history["time_s"] < onset
    out: dict = {
        "confinement_Pa": scene.loading.confinement,
        "onset_stress_Pa": None,
        "onset_strain": None,
        "first_failure_stress_Pa": None,
        "first_failure_strain": None,
        "first_failure_time_s": None,
        "first_failure_true_time_s": None,
        "first_failure_mode": None,
        "first_failure_position_m": None,
        "first_crack_angles_deg": [],
        "wing_reach_m": [],
        "half_turn_mismatch_m": None,
        "failed_tension": int(np.sum(events.mode == TENSION)),
        "failed_shear": int(np.sum(events.mode != TENSION)),
    }
    if len(events):
        out["first_failure_time_s"], out["first_failure_true_time_s"] = first, float(events.true_time[0])
        out["first_failure_mode"] = MODE_NAMES[events.mode[0]]
        out["first_failure_position_m"] = events.x[0].tolist()
    for name, time in (("onset", onset), ("first_failure", first)):
        out[f"{name}_stress_Pa"], out[f"{name}_strain"] = _load_at(time, history["time_s"], middle, stress, strain)
    out |= _stress_numbers(stress, strain, middle, before, history, scene.loading.confinement)
    out |= _peak_numbers(stress, FilteredLoad(scene).see_all(history))
    out |= _energy_numbers(history, before, energy_start)
    if scene.dim == 2:
        out |= _crack_numbers(scene, events)
    return out


def failures_by_rock(names: list[str], rock: np.ndarray, events: EventTable) -> list[dict]:
    """`by_rock` of summary.json. names: of the rocks; rock: which of them each particle is of, by its id, [n]."""
    of_event = rock[events.id]
    return [
        {
            "rock": name,
            "particles": int(np.count_nonzero(rock == k)),
            "failed_tension": int(np.count_nonzero(events.mode[of_event == k] == TENSION)),
            "failed_shear": int(np.count_nonzero(events.mode[of_event == k] != TENSION)),
        }
        for k, name in enumerate(names)
    ]


def _load_at(time: float, rows, middle, stress, strain) -> tuple[float | None, float | None]:
    """Stress and strain at a time, extrapolated from the last rows before it: the row that holds it has lost stress."""
    k = np.flatnonzero(rows < time)[-4:]
    if len(k) < 4 or not np.isfinite(time) or not np.isfinite(stress[k]).all():
        return None, None
    at = [float(np.polyval(np.polyfit(middle[k], values[k], 1), time)) for values in (stress, strain)]
    return at[0], at[1]


def _stress_numbers(stress, strain, middle, before, history, confinement) -> dict:
    names = ("apparent_modulus_Pa", "platen_imbalance", "platen_imbalance_max", "kinetic_share")
    out = dict.fromkeys(names)
    if len(stress) < 2 or not np.isfinite(stress).all():
        return out
    end = middle[before][-1] if before.any() else 0.0
    elastic = before & (middle > ELASTIC_RANGE[0] * end) & (middle < ELASTIC_RANGE[1] * end)
    if elastic.sum() >= 3 and np.ptp(strain[elastic]) > 0.0:  # not of platens that stand still
        out["apparent_modulus_Pa"] = float(np.polyfit(strain[elastic], stress[elastic], 1)[0])
    difference = np.abs(history["stress_top_Pa"] - history["stress_bottom_Pa"])
    added = np.abs(stress - confinement)
    if before.any() and added[before].mean() > 0.0:
        # with the Affine start both platens feel the same by symmetry, so the imbalance alone proves little: this
        # measure sees motion inside the specimen too
        out["kinetic_share"] = float(history["energy_kinetic_J"][before][-1] / history["energy_elastic_J"][before][-1])
        if not np.isfinite(difference[before]).all():
            return out  # a load cell that reads one side
        out["platen_imbalance"] = float(difference[before].mean() / added[before].mean())
        loaded = before & (added > 0.1 * added[before].max())
        out["platen_imbalance_max"] = float((difference[loaded] / added[loaded]).max())
    return out


def _peak_numbers(stress: np.ndarray, load: FilteredLoad) -> dict:
    """The largest stress, which is a peak only where the load has fallen after it."""
    out: dict = dict.fromkeys(("largest_stress_Pa", "peak_stress_Pa", "peak_filtered_Pa", "peak_filtered_strain"))
    if len(stress) and np.isfinite(stress).all():
        out["largest_stress_Pa"] = float(stress[np.abs(stress).argmax()])
    if load.passed:
        out |= {
            "peak_stress_Pa": out["largest_stress_Pa"],
            "peak_filtered_Pa": load.peak,
            "peak_filtered_strain": load.peak_strain,
        }
    return out


def _energy_numbers(history, before, energy_start) -> dict:
    """Residual kinetic + elastic + dissipated - work over work, in the elastic part and over the whole run."""
    residual = (
        history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
        - history["work_J"] - energy_start
    )  # fmt: skip
    work = np.abs(history["work_J"]) + energy_start  # of rock that starts with stress, little work may be done
    out: dict = {"energy_balance_error": None, "energy_balance_error_elastic": None}
    if len(work) and work.max() > 0.0:
        # a row early in the run divides a start-up residual by almost no work; it says nothing
        over = np.divide(np.abs(residual), work, out=np.zeros_like(work), where=work > 0.0)
        counted = work > ELASTIC_RANGE[0] ** 2 * (work[before].max() if before.any() else work.max())
        out["energy_balance_error"] = float(over[counted].max())
        if (counted & before).any():
            out["energy_balance_error_elastic"] = float(over[counted & before].max())
    return out


def _crack_numbers(scene: Scene, events: EventTable) -> dict:
    slits = [(slit, body) for body in scene.bodies for slit in slits_of(body.region)]
    if len(slits) != 1 or not len(events):
        return {}
    slit, body = slits[0]
    spacing = scene.domain.dx / body.seeding.particles_per_axis
    pair = wings(events.x[events.mode == TENSION], slit, spacing)
    out: dict = {}
    if events.crack_angle is not None:
        tension = events.mode == TENSION
        angles = first_crack_angles(events.x[tension].astype(float), events.crack_angle[tension].astype(float), slit)
        out["first_crack_angles_deg"] = [None if np.isnan(angle) else angle for angle in angles]
    platens = scene.loading.platens
    if platens:
        axis, centre = platens[0].axis, slit.centre
        planes = [platens[int(w is not None and w.tip[axis] > centre[axis])].position for w in pair]
        out["wing_reach_m"] = [
            None if w is None else float(np.abs(w.points[:, axis] - plane).min())
            for w, plane in zip(pair, planes, strict=True)
        ]
        pair = _young_wings(events.x[events.mode == TENSION], slit, spacing, axis)
        mismatch = half_turn_mismatch(pair, slit, axis, SYMMETRY_LENGTH, 2.0 * scene.domain.dx)
        out["half_turn_mismatch_m"] = None if np.isnan(mismatch) else mismatch
    return out


def _young_wings(x: np.ndarray, slit, spacing: float, axis: int) -> list:
    """The wings as they are when the shorter has grown to SYMMETRY_LENGTH: later failures belong to other cracks too.

    x: places of tension failures in order of time.
    """

    def grown(count: int) -> bool:
        pair = wings(x[:count], slit, spacing)
        return all(w is not None and np.ptp(w.points[:, axis]) >= SYMMETRY_LENGTH for w in pair)

    count = bisect.bisect_left(range(len(x)), True, key=grown)
    return wings(x[: count + 1], slit, spacing)
