"""How a scene is run: the arguments of `simulate`, checked."""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from rsmpm_ti import __version__
from rsmpm_ti.errors import refuse
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.records.progress import Progress
from rsmpm_ti.records.tables import Column
from rsmpm_ti.spec.library.names import ALLOWED, is_name
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.scene_checks import check_precision

CHECKPOINT_S = 60.0
"""Seconds of wall time between checkpoints, unless said otherwise."""


@dataclass(frozen=True, kw_only=True)
class Settings:
    """How a scene is run; arguments of `simulate`."""

    name: str = "scene"
    precision: str = "f64"
    arch: str = "cpu"
    threads: int | None = None
    deterministic: bool = False
    checkpoint_every: float = CHECKPOINT_S
    progress: Callable[[Progress], None] | None = None
    columns: tuple[Column, ...] = ()
    observers: tuple = ()

    def check(self, scene: Scene) -> None:
        """Raises SceneError for what cannot be run, before anything compiles."""
        if not is_name(self.name):
            raise refuse("name", self.name, ALLOWED, "the folder is given by `out`")
        if self.precision not in ("f64", "f32"):
            raise refuse("precision", self.precision, "'f64' or 'f32'")
        check_precision(scene, self.precision)
        if self.arch not in ("cpu", "cuda"):
            raise refuse("arch", self.arch, "'cpu' or 'cuda'")
        if self.threads is not None and not (type(self.threads) is int and 1 <= self.threads <= 1024):
            raise refuse("threads", self.threads, "a whole number from 1 to 1024")
        if self.deterministic and self.arch != "cpu":
            raise refuse(
                "deterministic", self.deterministic, "False on a GPU", "its sums are taken in any order; use --arch cpu"
            )
        if not (math.isfinite(self.checkpoint_every) and self.checkpoint_every >= 0.0):
            raise refuse("checkpoint_every", self.checkpoint_every, "a number of seconds, 0 for every history row")
        for name in ("columns", "observers"):
            if not isinstance(getattr(self, name), tuple):
                raise refuse(name, getattr(self, name), "a tuple", "a tuple of one ends in a comma")
        check_columns(scene, self.columns)
        if self.observers:
            from rsmpm_ti.solver.observer import Watch

            for observer in self.observers:
                Watch(observer)

    @property
    def kind(self) -> type:
        """NumPy's type of the numbers of particles."""
        return np.float64 if self.precision == "f64" else np.float32

    def identity(self, scene: Scene) -> dict:
        """What two runs must share if one goes on from the other's checkpoint."""
        from rsmpm_ti.spec.scene_json import to_plain

        shared = {"precision": self.precision, "arch": self.arch, "deterministic": self.deterministic}
        shared["columns"] = [column.name for column in self.columns]
        shared["observers"] = [type(observer).__name__ for observer in self.observers]
        return {"rsmpm_ti": __version__, **shared, "time_scale": scene.time_scale, "scene": to_plain(scene)}


def check_columns(scene: Scene, columns) -> None:
    """Refuse what is no column that can be added to a scene's history."""
    taken = [*HISTORY_COLUMNS, *(gauge.column for gauge in scene.loading.cell.gauges)]
    for column in columns:
        if not isinstance(column, Column) or not callable(column.value):
            raise refuse("columns", column, "Column(name=..., unit=..., about=..., value=lambda view: ...)")
        if not column.name.isidentifier() or column.name in taken:
            raise refuse("columns", column.name, "a name of letters, digits and _ that no other column has")
        taken.append(column.name)
