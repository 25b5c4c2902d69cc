"""What broke in a run: its cracks, fragments and acoustic events together, as tables and as numbers of summary.json."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.analysis.acoustic_emission import BValue, Catalogue, b_value, gather
from rsmpm_ti.analysis.crack_bands import (
    Course,
    Crack,
    carried,
    course_of,
    find_bands,
    measure_cracks,
    openings,
)
from rsmpm_ti.analysis.crack_path import rayleigh_speed
from rsmpm_ti.analysis.flaw_tips import FlawTip, flaw_tips, initiations
from rsmpm_ti.analysis.fragments import Fragments, find_fragments
from rsmpm_ti.analysis.numerical_fracture import parting_warning
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import Pattern, Snapshot
from rsmpm_ti.spec.regions import slits_of
from rsmpm_ti.spec.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Fracture:
    """Everything measured of what broke; lists of one length belong to each other."""

    cracks: list[Crack]
    openings: list[np.ndarray]  # opening and slip along each crack's path, [k, 2] [m]; no entries in 3D
    initiation: list[dict]  # one per flaw tip, see `flaw_tips.initiations`; empty in 3D
    fragments: Fragments
    acoustic: Catalogue
    b: BValue | None
    rayleigh_speed: float  # of the rock as run, mass scaling included [m/s]
    dim: int
    lines: list[np.ndarray]  # of the cracks, to be drawn where the rock is at the end, [k, 2] [m]; none in 3D
    time_scale: float = 1.0
    warning: str = ""  # numerical fracture, see `numerical_fracture.py`

    def numbers(self) -> dict:
        """The part of summary.json that counts what broke, and warns of parting; None where not defined."""
        plane, courses = self.dim == 2, [crack.course for crack in self.cracks if crack.course is not None]
        return {
            "cracks": len(self.cracks),
            "crack_length_m": float(sum(course.length for course in courses)) if plane else None,
            "fragments": len(self.fragments.pieces),
            "largest_fragment_share": self.fragments.largest_fraction,
            "acoustic_events": len(self.acoustic),
            "b_value": self.b.b if self.b else None,
            "b_value_error": self.b.error if self.b else None,
            # of one flaw; of more the list below tells them apart
            "initiation_angles_deg": [tip["angle_deg"] for tip in self.initiation] if len(self.initiation) == 2 else [],
            "initiation": self.initiation,
            "numerical_fracture": self.warning or None,
        }


def crack_lines(scene: Scene, events: EventTable, pattern: Snapshot | Pattern) -> list[np.ndarray]:
    """The lines of the cracks that there are at one instant, where the rock is then, list of [k, 2] [m]; none in 3D."""
    if scene.dim != 2:
        return []
    spacing, events = spacing_of(scene), events.until(pattern.time)
    bands, graph = find_bands(events, spacing)
    courses = [
        course_of(events.x[band], len(np.unique(events.id[band])), graph[band][:, band], spacing) for band in bands
    ]
    return _lines(courses, bands, events, pattern, spacing)


def _lines(courses: list[Course | None], bands, events: EventTable, pattern, spacing: float) -> list[np.ndarray]:
    """Of those bands that have one."""
    known = [(course.path, band) for course, band in zip(courses, bands, strict=True) if course is not None]
    return carried([path for path, _ in known], [band for _, band in known], events, pattern, spacing)


def spacing_of(scene: Scene) -> float:
    """The largest initial spacing of particles [m]."""
    return max(scene.domain.dx / body.seeding.particles_per_axis for body in scene.bodies)


def measure_fracture(scene: Scene, history: np.ndarray, events: EventTable, snapshot: Snapshot) -> Fracture:
    """Cracks, fragments and acoustic events of a run from its history, failures and last state.

    With mass scaling every speed of a run is that of the scaled rock, so acoustic events and tip speeds use its waves:
    those of the scene's own rock, where there are several.
    """
    spacing = spacing_of(scene)
    shear_speed = float(np.sqrt(scene.rock.elasticity.mu / scene.rock.density)) / scene.time_scale
    densities = np.array([rock.density for rock in scene.rocks])
    tips: tuple[FlawTip, ...] = ()
    if scene.dim == 2:
        tips = flaw_tips(tuple(slit for body in scene.bodies for slit in slits_of(body.region)))
    bands, graph = find_bands(events, spacing)
    cracks = measure_cracks(events, bands, graph, tips, spacing, scene.time_scale)
    acoustic = gather(events, spacing, shear_speed)
    return Fracture(
        cracks=cracks,
        openings=openings(cracks, events, snapshot, scene.domain.dx) if scene.dim == 2 else [],
        initiation=initiations(events, bands, tips, history),
        fragments=find_fragments(snapshot, densities if snapshot.rock is None else densities[snapshot.rock]),
        acoustic=acoustic,
        b=b_value(acoustic.magnitude),
        rayleigh_speed=rayleigh_speed(shear_speed, scene.rock.wave_speed(scene.time_scale)),
        dim=scene.dim,
        lines=_lines([crack.course for crack in cracks], bands, events, snapshot, spacing),
        time_scale=scene.time_scale,
        warning=parting_warning(scene, snapshot),
    )
