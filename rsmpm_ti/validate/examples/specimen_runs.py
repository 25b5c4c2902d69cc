"""A flawed specimen loaded to its peak, and the few numbers that an experiment on it would tell."""

import math
from dataclasses import dataclass, replace

import numpy as np

from rsmpm_ti import load_scene, simulate
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.records.snapshot import SHEAR, TENSION
from rsmpm_ti.spec.regions import slits_of
from rsmpm_ti.spec.scene import Scene

QUICK = {"dx": 1e-3, "length": 2e-3}
FINE = {"dx": 0.5e-3, "length": 2e-3}
"""Cells of a half and of a quarter of the same length of the mean: one rock."""

END = 2.0e-3
"""Strain at the end, unless the load has fallen by half before [1]: beyond that at which intact rock breaks."""


@dataclass(frozen=True)
class Told:
    """onset, peak: nominal stress at the first failure, and the largest of the filtered load [Pa], NaN for none.

    shear_onset: at the first failure in shear [Pa]; tensile: whether the first failure is; along: distance of the first
    failure from its flaw's middle, along the flaw, over half its length; residual: mean stress of the last tenth of the
    rows [Pa].
    """

    onset: float
    peak: float
    shear_onset: float
    tensile: bool
    along: float
    residual: float


def to_the_peak(name: str, **overrides) -> Scene:
    """A scene that ships, loaded until its load has fallen."""
    scene = load_scene(name, strain_end=END, **overrides)
    return replace(scene, schedule=replace(scene.schedule, stop_after_drop=0.5))


def tell(scene: Scene) -> Told:
    """Run it."""
    result = simulate(scene, threads=1)
    summary, events = result.summary, result.events
    time, stress = result.history["time_s"], nominal_stress(result.history)
    onset, peak = (summary.get(key) for key in ("first_failure_stress_Pa", "peak_filtered_Pa"))
    sheared = events.time[events.mode == SHEAR]
    first = int(np.argmin(events.time)) if len(events) else 0
    slits, along = slits_of(scene.bodies[0].region), math.nan
    if slits and len(events):
        frames = [slit.frame(events.x[[first]])[0] for slit in slits]
        nearest = min(zip(frames, slits, strict=True), key=lambda pair: float(np.hypot(*pair[0])))
        along = abs(float(nearest[0][0])) / (0.5 * nearest[1].length)
    return Told(
        onset=math.nan if onset is None else float(onset),
        peak=math.nan if peak is None else float(peak),
        shear_onset=float(np.interp(sheared.min(), time, stress)) if len(sheared) else math.nan,
        tensile=len(events) > 0 and int(events.mode[first]) == TENSION,
        along=along,
        residual=float(stress[-max(1, len(stress) // 10) :].mean()),
    )
