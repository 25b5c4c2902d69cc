"""What broke in a run: its cracks, fragments and acoustic events together, as tables and as numbers of summary.json."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.cracks.bands import Crack, find_bands, measure_cracks, openings
from rsmpm_ti.cracks.emission import BValue, Catalogue, b_value, gather
from rsmpm_ti.cracks.fragments import Fragments, find_fragments
from rsmpm_ti.cracks.growth import rayleigh_speed
from rsmpm_ti.cracks.tips import flaw_tips, initiations
from rsmpm_ti.nominal import load_at
from rsmpm_ti.observe import EventTable
from rsmpm_ti.output import write_table
from rsmpm_ti.parting import parting_warning
from rsmpm_ti.regions import slits_of
from rsmpm_ti.snapshot import MODE_NAMES, Snapshot
from rsmpm_ti.spec import Scene

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class Fracture:
    """Everything measured of what broke; lists of one length belong to each other."""

    cracks: list[Crack]
    openings: list[np.ndarray]  # opening and slip along each crack's path, [k, 2] [m]; no entries in 3D
    initiation: list[dict]  # one per flaw tip, see `tips.initiations`; empty in 3D
    fragments: Fragments
    acoustic: Catalogue
    b: BValue | None
    rayleigh_speed: float  # of the rock as run, mass scaling included [m/s]
    dim: int
    warning: str = ""  # numerical fracture, see `parting.py`

    def numbers(self) -> dict:
        """The part of summary.json that counts what broke, and warns of parting; None where not defined."""
        plane = self.dim == 2
        return {
            "cracks": len(self.cracks),
            "crack_length_m": float(sum(crack.course.length for crack in self.cracks)) if plane else None,
            "fragments": len(self.fragments.pieces),
            "largest_fragment_share": self.fragments.largest_share,
            "acoustic_events": len(self.acoustic),
            "b_value": self.b.b if self.b else None,
            "b_value_error": self.b.error if self.b else None,
            "initiation": self.initiation,
            "numerical_fracture": self.warning or None,
        }

    @property
    def paths(self) -> list[np.ndarray]:
        """The cracks' lines, to be drawn, list of [k, 2] [m]; none in 3D."""
        return [crack.course.path for crack in self.cracks if crack.course is not None]


def measure_fracture(scene: Scene, history: np.ndarray, events: EventTable, snapshot: Snapshot) -> Fracture:
    """Cracks, fragments and acoustic events of a run from its history, failures and last state.

    With mass scaling every speed of a run is that of the scaled rock, so acoustic events and tip speeds use its waves.
    """
    spacing = max(scene.domain.dx / body.seeding.particles_per_axis for body in scene.bodies)
    shear_speed = float(np.sqrt(scene.rock.elasticity.mu / scene.density))
    tips = ()
    if scene.dim == 2:
        tips = flaw_tips(tuple(slit for body in scene.bodies for slit in slits_of(body.region)))
    bands, graph = find_bands(events, spacing)
    cracks = measure_cracks(events, bands, graph, tips, spacing, scene.time_scale)
    acoustic = gather(events, spacing, shear_speed)
    return Fracture(
        cracks=cracks,
        openings=openings(cracks, events, snapshot, scene.domain.dx) if scene.dim == 2 else [],
        initiation=initiations(events, bands, tips, history),
        fragments=find_fragments(snapshot, scene.rock.density),
        acoustic=acoustic,
        b=b_value(acoustic.magnitude),
        rayleigh_speed=rayleigh_speed(shear_speed, scene.wave_speed),
        dim=scene.dim,
        warning=parting_warning(scene, snapshot),
    )


def write_fracture(out: Path, fracture: Fracture, history: np.ndarray) -> None:
    """cracks.csv, fragments.csv and acoustic.csv; with nothing in them, their headers."""
    axes = AXES[: fracture.dim]
    rows = (_crack_row(fracture, k, history) for k in range(len(fracture.cracks)))
    write_table(out / "cracks.csv", _crack_columns(axes), rows)

    header = ("fragment", "particles", "mass_kg", "diameter_m", *(f"{a}_m" for a in axes), *(f"v{a}_m_s" for a in axes))
    pieces = [*enumerate(fracture.fragments.pieces)]
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
    `growth.WINDOW`, in the run's own time; slip the faces' sliding on each other, dextral positive."""
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
