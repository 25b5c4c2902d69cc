"""When to paint: frames at equal strain or time, more when failed particles jump. What to paint: limits and titles."""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.laws import MohrCoulomb
from rsmpm_ti.softening import Brittle
from rsmpm_ti.spec import Scene

JUMP_SHARE, JUMP_GROWTH = 0.0003, 0.05
"""A frame is added when failures since the last one exceed this share of all particles and of all failures so far."""


class Timetable:
    """Decides after each history row whether a frame or a VTU is due."""

    def __init__(self, scene: Scene, particle_count: int):
        self._frames, self._vtus = scene.output.frames, scene.output.vtu
        self._jump = max(1.0, JUMP_SHARE * particle_count)
        self._extra = self._frames  # jumps may at most double the number of frames
        self._next_frame = self._next_vtu = 0
        self._failed = 0.0

    def state(self) -> dict[str, float]:
        """What `resume` needs to go on where this one is."""
        return {"frame": self._next_frame, "vtu": self._next_vtu, "extra": self._extra, "failed": self._failed}

    def resume(self, state: dict[str, float]) -> None:
        self._next_frame, self._next_vtu = state["frame"], state["vtu"]
        self._extra, self._failed = state["extra"], state["failed"]

    def frame_due(self, progress: float, failed: float) -> bool:
        """progress: share of the run done, 0 to 1; failed: particles failed so far."""
        if self._frames == 0:
            return False
        due = progress >= self._next_frame / self._frames - 1e-9
        if due:
            self._next_frame = math.floor(progress * self._frames + 1e-9) + 1
        elif self._extra > 0 and failed - self._failed >= max(self._jump, JUMP_GROWTH * self._failed):
            self._extra -= 1
            due = True
        if due:
            self._failed = failed
        return due

    def vtu_due(self, progress: float) -> bool:
        due = self._vtus > 0 and progress >= self._next_vtu / self._vtus - 1e-9
        if due:
            self._next_vtu = math.floor(progress * self._vtus + 1e-9) + 1
        return due


@dataclass(frozen=True, kw_only=True)
class Commission:
    """What is to be painted of one run, in plain values: they reach the process that paints.

    kinds: of frames; painters: keywords that all of them share; title: of summary.png; name: of the movie.
    """

    kinds: tuple[str, ...]
    painters: dict
    title: str
    name: str
    movie: bool
    out: Path


def commission(scene: Scene, name: str, out: Path, volume: float) -> Commission:
    """volume: of all particles [m^dim], from which the end of the load axis is estimated."""
    low, high = zip(*(body.region.bounds() for body in scene.bodies), strict=True)
    lower, upper = np.min(low, axis=0)[:2], np.max(high, axis=0)[:2]
    strain, load = load_limits(scene, volume)
    painters = {
        "lower": tuple(lower), "upper": tuple(upper), "stress_limit": stress_limit(scene, load),
        "strain_limit": strain, "load_limit": load, "backend": scene.output.painter, "softens": softens(scene),
    }  # fmt: skip
    kinds = ("stress", "cracks", "margin") if scene.output.margin else ("stress", "cracks")
    return Commission(
        kinds=kinds, painters=painters, title=scene.title, name=name, movie=scene.output.movie, out=Path(out)
    )


def softens(scene: Scene) -> bool:
    """Whether the rock of a scene loses its strength while it cracks, not at once."""
    law = scene.rock.after_failure
    return law.directional and not isinstance(law.softening, Brittle)


def stress_limit(scene: Scene, load: float | None) -> float:
    """Colour limit [Pa]: 1.5 times the tensile strength, or for an elastic run a tenth of the load expected."""
    if scene.output.stress_limit is not None:
        return scene.output.stress_limit
    if isinstance(scene.rock.criterion, MohrCoulomb):
        return 1.5 * scene.rock.criterion.tensile_strength
    return 0.1 * load if load else 1e6


def load_limits(scene: Scene, volume: float) -> tuple[float | None, float | None]:
    """Ends of the inset's axes: the last strain, and the nominal stress of a uniformly strained body of this volume.

    That is an upper bound of the elastic load (Voigt); the strength bounds it too. Confinement adds its pressure.
    """
    if scene.loading.platens is None or scene.loading.width is None:
        return None, None
    strain = abs(scene.schedule.strain_end or scene.loading.strain_rate * scene.t_end)
    if strain == 0.0:  # platens that stand still
        return None, None
    load = (
        scene.rock.elasticity.uniaxial_modulus(scene.dim)
        * strain
        * volume
        / (scene.loading.height * scene.loading.width)
    )
    load += scene.loading.confinement
    if isinstance(scene.rock.criterion, MohrCoulomb):
        load = min(load, 1.05 * scene.rock.criterion.strength(scene.loading.confinement))
    return strain, load
