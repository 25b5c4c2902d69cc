"""What a run looks like from outside at one instant: plain NumPy, no Taichi."""

from dataclasses import dataclass, field

import numpy as np

HISTORY_COLUMNS = (
    "time_s",
    "axial_strain",
    "stress_top_Pa",
    "stress_bottom_Pa",
    "energy_kinetic_J",
    "energy_elastic_J",
    "energy_dissipated_J",
    "work_J",
    "failed_tension",
    "failed_shear",
    "dt_s",
)
"""Columns of `history.csv` and fields of the structured array `Result.history`, all float64.

Strain and the two stresses are compression positive, as tests report them; energies are per metre of thickness in 2D.
Under confinement stress is the whole axial stress, and strain and work count from the confined state.
"""

INTACT, TENSION, SHEAR = 0, 1, 2
"""Values of `failure_mode`."""

MODE_NAMES = ("intact", "tension", "shear")


@dataclass(frozen=True)
class Snapshot:
    """Particles at one instant, in the order of their ids, which is the order in which they were seeded.

    Those that have left the domain and were dropped are not among them.
    Shapes: n particles in dim dimensions. Stress is Cauchy, tension positive.
    """

    time: float  # [s]
    id: np.ndarray  # ascending, int [n]
    x: np.ndarray  # current positions [m], [n, dim]
    displacement: np.ndarray  # [m], [n, dim]
    velocity: np.ndarray  # [m/s], [n, dim]
    sigma: np.ndarray  # [Pa], [n, 3, 3]
    sigma_1: np.ndarray  # largest (most tensile) principal stress [Pa], [n]
    sigma_3: np.ndarray  # smallest principal stress [Pa], [n]
    volume: np.ndarray  # current volume [m^dim], [n]
    strength: np.ndarray  # factor on the rock's cohesion and tensile strength, 1 where uniform, [n]
    failure_mode: np.ndarray  # INTACT, TENSION or SHEAR, int8 [n]
    failure_time: np.ndarray  # [s], NaN where intact, [n]
    # how near to failure: 1 unloaded, or pressed from all sides; 0 at failure, and where failed or begun to crack;
    # below 0 where the mean stress exceeds the strength and a particle nearby, which exceeds it more, fails first; [n]
    margin: np.ndarray
    governs: np.ndarray  # which failure the margin is to, or which it was: TENSION, SHEAR, or 0 for none, int8 [n]
    damage: np.ndarray  # share of strength lost, 0 to 1, by the paper's laws 1 where failed, [n]
    aperture: np.ndarray  # opening of the crack in the particle [m], 0 by the paper's laws, [n]
    # of the normal of the crack in the particle, from +x [degrees, 0 to 180), NaN where it has none and by the paper's
    # laws; where it failed in shear, of sigma_1 then; [n]
    crack_angle: np.ndarray
    history: dict[str, np.ndarray] = field(default_factory=dict)  # what the law after failure remembers, by name
