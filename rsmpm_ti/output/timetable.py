"""When to paint: frames at equal strain or time, more when failed particles jump. What to paint: limits and titles."""

import math

from rsmpm_ti.spec.scene import Scene

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
        self._next_frame, self._next_vtu, self._extra = (int(state[name]) for name in ("frame", "vtu", "extra"))
        self._failed = state["failed"]

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
