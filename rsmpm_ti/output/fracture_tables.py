"""cracks.csv, fragments.csv and acoustic.csv."""

from pathlib import Path

import numpy as np

from rsmpm_ti.analysis.fracture import Fracture
from rsmpm_ti.analysis.fragments import Fragment
from rsmpm_ti.analysis.load_curve import load_at
from rsmpm_ti.output.files import write_table
from rsmpm_ti.records.snapshot import MODE_NAMES

AXES = "xyz"


def write_fracture(out: Path, fracture: Fracture, history: np.ndarray) -> None:
    """cracks.csv, fragments.csv and acoustic.csv; with nothing in them, their headers."""
    axes = AXES[: fracture.dim]
    rows = (_crack_row(fracture, k, history) for k in range(len(fracture.cracks)))
    write_table(out / "cracks.csv", _crack_columns(axes), rows)

    header = ("fragment", "particles", "mass_kg", "diameter_m", *(f"{a}_m" for a in axes), *(f"v{a}_m_s" for a in axes))
    pieces: list[tuple[int | str, Fragment]] = [*enumerate(fracture.fragments.pieces)]
    if fracture.fragments.dust is not None:
        pieces.append(("dust", fracture.fragments.dust))
    rows = ((name, f.particles, f.mass, f.diameter, *f.centroid, *f.velocity) for name, f in pieces)
    write_table(out / "fragments.csv", header, rows)

    header = (
        "time_s", *(f"{a}_m" for a in axes), "energy_J", "magnitude", "failures", "particles", "shear_share",
        "nominal_stress_Pa", "cumulative",
    )  # fmt: skip
    c = fracture.acoustic
    stress = load_at(history, c.time)[0]
    columns = (c.time, *c.place.T, c.energy, c.magnitude, c.failures, c.particles, c.shear_share, stress)
    write_table(out / "acoustic.csv", header, ((*row, k + 1) for k, row in enumerate(zip(*columns, strict=True))))


def _crack_columns(axes: str) -> tuple[str, ...]:
    """growth_m is the furthest distance within the band from where the crack began; tip_speed the largest over
    `crack_path.WINDOW`, in the run's own time; slip the faces' sliding on each other, dextral positive."""
    return (
        "crack", "particles", "tension_failures", "shear_failures", "shear_share", "shear_energy_share",
        "released_energy_J", "initiation_time_s", "initiation_stress_Pa", "initiation_strain",
        *(f"initiation_{a}_m" for a in axes), "initiation_mode", "flaw_tip", "leaving_angle_deg",
        "growth_m", "tip_speed_m_s", "tip_speed_over_rayleigh", "length_m", "tortuosity", "direction_deg", "width_m",
        "aperture_mean_m", "aperture_max_m", "slip_mean_m",
    )  # fmt: skip


def _crack_row(fracture: Fracture, k: int, history: np.ndarray) -> tuple:
    crack = fracture.cracks[k]
    origin, course = crack.origin, crack.course
    stress, strain = load_at(history, origin.time)
    speed = float(crack.speed_at.max())
    line = (None,) * 7
    if course is not None:
        opening, slip = fracture.openings[k].T
        known = np.isfinite(opening)
        jump = (opening[known].mean(), opening[known].max(), slip[known].mean()) if known.any() else (None,) * 3
        line = (course.length, course.tortuosity, course.direction, course.width, *jump)
    return (
        k, crack.particles, crack.tension, crack.shear, crack.shear / (crack.tension + crack.shear),
        crack.shear_energy / crack.released if crack.released > 0.0 else None,
        crack.released, origin.time, float(stress), float(strain),
        *origin.place, MODE_NAMES[origin.mode], origin.tip, origin.angle,
        crack.length_at[-1], speed, speed / fracture.rayleigh_speed, *line,
    )  # fmt: skip
