"""What kernels write for those outside: failure events, the ledger of sums over steps, the report of a survey."""

import taichi as ti

from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.scene import Scene

NEVER = 1e300
"""A time that does not come [s]. Infinity will not do: where threads take a minimum, Taichi makes the largest number of
it."""


def event_capacity(scene: Scene, count: int) -> int:
    """Most events of a run of so many particles."""
    return scene.rock.after_failure.max_events * count if scene.rock.criterion.breaks else 1


@ti.data_oriented
class Events:
    """Failure events in the order in which they happen; at most one of each mode per particle."""

    def __init__(self, scene: Scene, count: int, real, history):
        self.count, self.by_mode = ti.field(ti.i32, ()), ti.field(ti.i32, 3)
        # when a particle first begins to lose strength: without fracture energy that is the first event
        self.onset = ti.field(ti.f64, ())
        self.onset[None] = NEVER
        self.names = ("time", "x", "mode", "sigma_1", "sigma_3", "released", "id")
        self.of_history: tuple = ()  # pairs of a column and the variable of the law that it copies
        capacity = event_capacity(scene, count)
        if scene.rock.criterion.breaks and scene.rock.after_failure.oriented:
            self.normal = ti.Vector.field(scene.dim, real, capacity)  # unit vector across the crack
            self.names += ("normal",)
            self.of_history = ((self.normal, history.crack_normal),)
        self.capacity = capacity
        self.time, self.sigma_1 = ti.field(ti.f64, capacity), ti.field(real, capacity)
        self.sigma_3, self.released = ti.field(real, capacity), ti.field(real, capacity)
        self.x = ti.Vector.field(scene.dim, real, capacity)
        self.mode, self.id = ti.field(ti.i32, capacity), ti.field(ti.i32, capacity)


@ti.data_oriented
class Ledger:
    """Sums over steps, always float64: platen impulses [N s], their work [J], energy lost [J].

    Forces are those of a step's beginning, and a platen whose speed changes goes by the mean of the speeds before and
    after (trapezoidal rule): along a boundary's axis, `speed` is of the latest step and `mean_speed` the mean of it and
    the one before. `latest` is the work of the latest step alone, of which the work until now takes half again.
    """

    def __init__(self, scene: Scene, slots: int):
        boundaries = max(1, len(scene.loading.boundaries))
        self.impulse = ti.Vector.field(scene.dim, ti.f64, boundaries)
        self.work, self.latest = ti.field(ti.f64, boundaries), ti.field(ti.f64, boundaries)
        self.speed, self.mean_speed = ti.field(ti.f64, boundaries), ti.field(ti.f64, boundaries)
        self.body_work = ti.field(ti.f64, slots)
        self.viscous, self.released = ti.field(ti.f64, slots), ti.field(ti.f64, slots)
        # by local damping, and by PIC's part of the transfer
        self.damped, self.mixed = ti.field(ti.f64, slots), ti.field(ti.f64, slots)
        # by boundaries, from what particles bring to nodes that they hold: the sum, and what the next step gives back
        self.stopped = ti.field(ti.f64, 2)
        self.begin(scene)

    def begin(self, scene: Scene) -> None:
        """Speeds before the first step: none, but where bodies start with the field of uniform straining."""
        for b, boundary in enumerate(scene.loading.boundaries):
            self.speed[b] = boundary.speed if isinstance(scene.loading.start, Affine) else 0.0


SCALARS = (
    "kinetic",
    "elastic",
    "speed",
    "J_min",
    "J_max",
    "J_intact",
    "J_intact_min",
    "sick",
    "not_finite",
    "sick_id",
    "outside",
    "strays",
    "far_strays",
    "work",
    "dissipated",
)
"""Numbers of a survey, in the order in which the report lists them."""


@ti.data_oriented
class Report:
    """What a survey sums into: scalar fields, because Taichi reduces those per thread, and one vector of them all."""

    def __init__(self, scene: Scene):
        for name in SCALARS:
            setattr(self, name, ti.field(ti.f64, ()))
        self.momentum = tuple(ti.field(ti.f64, ()) for _ in range(scene.dim))
        self.scalars = tuple(getattr(self, name) for name in SCALARS)
        self.sums = (*self.scalars, *self.momentum)
        self.boundary_count = len(scene.loading.boundaries)
        self.values = ti.field(ti.f64, len(SCALARS) + 2 + scene.dim + scene.dim * max(1, self.boundary_count))
