"""When to paint, and painting: frames at equal strain or time, more when failed particles jump; movie and VTU."""

import math
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np

from rsmpm_ti.laws import MohrCoulomb
from rsmpm_ti.output import write_pvd, write_vtu
from rsmpm_ti.paint.figure import FramePainter, write_png
from rsmpm_ti.paint.movie import Movie
from rsmpm_ti.paint.summary import summary_picture
from rsmpm_ti.snapshot import Snapshot
from rsmpm_ti.softening import Brittle
from rsmpm_ti.spec import Scene

JUMP_SHARE, JUMP_GROWTH = 0.0003, 0.05
"""A frame is added when failures since the last one exceed this share of all particles and of all failures so far."""


WAITING = 4
"""Pictures or VTU files that may wait to be written."""


class Timetable:
    """Decides after each history row whether a frame or a VTU is due."""

    def __init__(self, scene: Scene, particle_count: int):
        self._frames, self._vtus = scene.output.frames, scene.output.vtu
        self._jump = max(1.0, JUMP_SHARE * particle_count)
        self._extra = self._frames  # jumps may at most double the number of frames
        self._next_frame = self._next_vtu = 0
        self._failed = 0.0

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


class Gallery:
    """Paints and writes the pictures of one run into `out`."""

    def __init__(self, scene: Scene, name: str, out: Path, volume: float):
        """volume: of all particles [m^dim], from which the end of the load axis is estimated."""
        self._scene, self._name, self._out = scene, name, out
        low, high = zip(*(body.region.bounds() for body in scene.bodies), strict=True)
        lower, upper = np.min(low, axis=0)[:2], np.max(high, axis=0)[:2]
        strain, load = load_limits(scene, volume)
        shared = {
            "lower": tuple(lower), "upper": tuple(upper), "stress_limit": stress_limit(scene, load),
            "strain_limit": strain,
            "load_limit": load, "backend": scene.output.painter,
        }  # fmt: skip
        kinds = ("stress", "cracks", "margin") if scene.output.margin else ("stress", "cracks")
        self.painters = {kind: FramePainter(kind=kind, softens=softens(scene), **shared) for kind in kinds}
        self.warning = ""
        self._movie = None
        if scene.output.movie:
            try:
                self._movie = Movie(out / f"{name}.mp4")
            except RuntimeError as error:  # no encoder: frames still come
                self.warning = str(error)
        self._writer, self._pending = ThreadPoolExecutor(max_workers=1), []
        self.count = 0
        self._vtus: list[tuple[float, str]] = []

    def frame(self, snapshot: Snapshot, history: np.ndarray) -> None:
        images = {kind: painter.paint(snapshot, history, self.count) for kind, painter in self.painters.items()}
        self._later(self._write_frame, images, self.count)
        self.count += 1

    def _write_frame(self, images: dict[str, np.ndarray], number: int) -> None:
        for kind, image in images.items():
            write_png(self._out / "frames" / f"{kind}_{number:04d}.png", image, painter=self._scene.output.painter)
        if self._movie is not None:
            self._movie.add(images["stress"], images["cracks"])

    def vtu(self, snapshot: Snapshot) -> None:
        self._vtus.append((snapshot.time, f"particles_{len(self._vtus):04d}.vtu"))
        self._later(self._write_vtu, snapshot, list(self._vtus))

    def _write_vtu(self, snapshot: Snapshot, entries: list[tuple[float, str]]) -> None:
        write_vtu(self._out / entries[-1][1], snapshot)
        write_pvd(self._out / "particles.pvd", entries)

    def _later(self, work, *arguments) -> None:
        """Compressing and encoding go on beside the solver; at most a few pictures wait, so memory stays flat."""
        while len(self._pending) >= WAITING:
            self._pending.pop(0).result()
        self._pending.append(self._writer.submit(work, *arguments))

    def close(self, snapshot: Snapshot, history: np.ndarray, paths: list[np.ndarray], acoustic: np.ndarray) -> None:
        """Finish what waits and the movie, paint summary.png, give the painters' memory back.

        paths: lines of cracks, each [k, 2] [m]; acoustic: times of acoustic events, ascending [s].
        """
        for pending in self._pending:
            pending.result()
        self._writer.shutdown()
        if self._movie is not None:
            self._movie.close()
        summary_picture(
            self._out / "summary.png", snapshot, history, self.painters["cracks"], self._scene.title, paths, acoustic
        )
        for painter in self.painters.values():
            painter.close()


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
