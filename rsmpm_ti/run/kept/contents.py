"""Whether the numbers of a checkpoint can be those of a run: kernels and files trust them afterwards.

Held to the scene where it says what they are, such as which particle lies where, and to each other where they must
agree; and else to bounds within which whatever a run does with them ends in a sentence. Every check raises Damaged.
"""

import math

import numpy as np

from rsmpm_ti.fields.contacts import NOTHING_NEAR
from rsmpm_ti.fields.geometry import Geometry
from rsmpm_ti.fields.particles import stored
from rsmpm_ti.fields.records import NEVER, most_events
from rsmpm_ti.fields.state import densities, seeded, strength_factors
from rsmpm_ti.method.time_step import MAX_COUNT
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.run.kept.reading import need
from rsmpm_ti.solver.guard import J_BOUNDS
from rsmpm_ti.spec.holes.excavation import excavations_of, marks
from rsmpm_ti.spec.scene import Scene

LARGEST = 1e30
"""No number of a run is larger."""

SHORTEST = 1e-30
"""No time of a run is shorter [s], but none at all."""

UNDEFINED = {"axial_strain", "lateral_strain", "volumetric_strain", "stress_top_Pa", "stress_bottom_Pa",
             "force_top_N", "force_bottom_N"}  # fmt: skip
"""Columns of the history that may not be defined."""

MOST_CELLS = 10.0
"""A particle does not go further than so many cells in a step, where 0.4 are the rule."""


class Contents:
    """The arrays of a checkpoint, of the right names, kinds and shapes, beside the scene whose run it is to be."""

    def __init__(self, arrays: dict[str, np.ndarray], scene: Scene, seeds):
        self.arrays, self.scene = arrays, scene
        self.seeded, self.geometry = seeded(scene, seeds), Geometry(scene)
        self.count, self.fields = len(self.seeded.x), self._fields()
        self.single = arrays["particle_real_0"].dtype == np.float32
        self.step, self.total, self.first = (int(arrays[f"clock_{name}"]) for name in ("step", "total", "first"))
        self.dt, self.since = float(arrays["clock_dt"]), float(arrays["clock_since"])
        self.time = self.since + (self.step - self.first) * self.dt

    def check(self) -> None:
        for name, values in self.arrays.items():
            if values.dtype.kind == "f" and name not in ("history", "history_zero", "reactions", "event_onset"):
                need(_within(values, LARGEST), f"{name} is not finite")
        self._check_clock()
        self._check_grid()
        self._check_particles()
        self._check_events()
        self._check_history()
        self._check_dropped()
        for name, values in self.arrays.items():
            if name.startswith("seat_"):
                need((values >= 0.0).all() and (values <= NOTHING_NEAR).all(), f"{name} is no gap")
            if name.startswith("contact_"):
                need((values >= 0).all() and (values <= 2).all(), f"{name} is no state of nodes")

    def _check_clock(self) -> None:
        end, adaptive = float(self.arrays["end"]), self.scene.schedule.adaptive
        steps = 0 <= self.first <= self.step <= self.total <= MAX_COUNT
        need(steps, f"it counts {self.first}, {self.step} and {self.total} steps")
        longest = self.scene.dt * (1.0 + 1e-9)
        shortest = 0.0 if adaptive else self.scene.dt * (1.0 - 1e-9)
        need(shortest <= self.dt <= longest and self.dt > 0.0, f"its step is {self.dt:g} s")
        need(self.since >= 0.0 and (self.first > 0 or self.since == 0.0), f"its steps began at {self.since:g} s")
        pace, loaded = float(self.arrays["clock_pace"]), float(self.arrays["clock_loaded"])
        came = self.time
        if self.scene.servo is not None:
            paces = [pace, *(float(self.arrays[f"servo_{name}"]) for name in ("pace", "least"))]
            slowest = 0.5 * self.scene.servo.slowest  # steps up to the end of a row go at half of it at least
            need(all(slowest <= one <= 1.0 + 1e-9 for one in paces), f"its platens go at {min(paces):g} of their speed")
            need(0.0 <= loaded <= self.time * (1.0 + 1e-9), f"its platens have gone for {loaded:g} s")
            need(float(self.arrays["servo_most_elastic"]) >= 0.0, "its elastic energy was negative")
            came = loaded
        else:
            need(pace == 1.0, f"its platens go at {pace:g}")
        left = (end - came) / (pace * self.dt)
        need(abs(left - (self.total - self.step)) <= 1.0 + 1e-9 * self.total, "its clock and its end disagree")
        ended = end - came <= 2e-9 * self.scene.dt  # no step is taken over less
        need(not ended or self.step == self.total, "its clock is at its end and steps are left")

    def _check_grid(self) -> None:
        g, travel, began = self.geometry, self.arrays["grid_travel"], self.arrays["grid_began"]
        frame, wanted = self.arrays["grid_frame"], g.frame_at(travel)
        spacing = wanted[:, 2]
        need((spacing > 0.01 * g.dx).all() and (spacing < 100.0 * g.dx).all(), "its grid has no spacing")
        error = 1e-6 if self.single else 1e-9  # single precision also rounds the numbers of the scene
        near = np.allclose(frame, wanted, rtol=error, atol=error * (g.dx + np.abs(g.origin).max()))
        need(near, "its grid does not lie where its sides have gone")
        moved = np.zeros((g.dim, 2), dtype=bool)
        moved[list(g.followed)] = True
        need(not travel[~moved].any(), "sides of its grid have gone that nothing moves")
        need(self.scene.loading.settle or not began.any(), "its grid had gone before the start")
        held = np.zeros((g.dim, 2), dtype=bool)
        for side in g.held:
            held[side.axis, side.side] = True
        for name in ("grid_velocity", "grid_answered"):
            need(not self.arrays[name][~held].any(), f"{name} is of sides that no force moves")
        fastest = np.abs(self.arrays["grid_velocity"]).max() * self.scene.dt
        need(fastest <= MOST_CELLS * g.dx, "its platens go too fast")

    def _fields(self) -> dict[str, np.ndarray]:
        """Fields of the particles by name, [n, components]."""
        found, at = {}, {"real": 0, "whole": 0}
        for entry in stored(self.scene):
            word = "whole" if entry.whole else "real"
            columns = range(at[word], at[word] + entry.size)
            found[entry.name] = np.stack([self.arrays[f"particle_{word}_{k}"] for k in columns], axis=1)
            at[word] += entry.size
        return found

    def _check_particles(self) -> None:
        g, n = self.geometry, self.count
        ids = self.fields["id"][:, 0]
        mode = self.fields["mode"][:, 0] if "mode" in self.fields else np.zeros(n, dtype=int)
        need(np.array_equal(np.sort(ids), np.arange(n)), "its particles do not have each number once")
        x, u, v, J, volume = (self.fields[name].astype(float) for name in ("reference", "u", "v", "J", "volume"))
        J, volume = J[:, 0], volume[:, 0]
        start = self.seeded.x[ids]
        near = (1e-5 if self.single else 1e-9) * np.abs(start).max() + 1e-6 * g.dx
        need(np.abs(x - start).max() <= near, "its particles did not start where the scene's do")
        gone = volume == 0.0
        dug = np.zeros(n, dtype=bool)
        if found := excavations_of(self.scene):
            due = [k for k, hole in found if hole.time <= self.time - self.dt]
            begun = [k for k, hole in found if hole.time <= self.time + self.dt]
            mark = marks(self.scene)[ids]
            need(gone[np.isin(mark, due)].all(), "rock is there that was excavated")
            dug = gone & np.isin(mark, begun)
        need(self.scene.domain.outside == "drop" or not gone[~dug].any(), "particles have no volume")
        need(
            not gone.all() and (np.diff(gone.astype(int)) >= 0).all(), "dropped particles do not lie behind the others"
        )
        need(
            gone[~dug].sum() <= int(self.arrays["dropped_count"]) <= gone.sum() * (self.scene.domain.outside == "drop"),
            "it counts other particles as dropped",
        )
        free = (self.seeded.volume / self.seeded.J)[ids]
        need(np.allclose(volume[~gone], free[~gone], rtol=1e-4), "its particles are not as large as the scene's")
        if "strength" in self.fields:
            wanted = strength_factors(self.scene, self.seeded)[ids]
            need(
                np.allclose(self.fields["strength"][:, 0], wanted, rtol=1e-4),
                "its particles are not as strong as the scene's",
            )
        if "rock" in self.fields:
            need(np.array_equal(self.fields["rock"][:, 0], self.seeded.rock[ids]), "its particles are of other rocks")
        need(((mode >= 0) & (mode <= 2)).all(), "particles have failed in no known way")
        intact = mode == 0
        need((J >= J_BOUNDS[0]).all() and (J[intact] <= J_BOUNDS[1]).all(), "rock is squeezed or stretched too far")
        need(np.linalg.norm(v, axis=1).max() * self.scene.dt <= MOST_CELLS * g.dx, "particles go too fast")
        self._check_cells(x + u, gone)
        mass = self.scene.time_scale**2 * densities(self.scene, self.seeded)[ids] * volume
        self._kinetic = float(0.5 * mass @ np.sum(v**2, axis=1))

    def _check_cells(self, x: np.ndarray, gone: np.ndarray) -> None:
        """Particles lie in the grid, sorted by the cells of their last sort, at most a row from where they were."""
        g, frame, shape = self.geometry, self.arrays["grid_frame"], self.scene.shape
        local = g.coordinates_at(x, frame)
        # two cells beyond the domain and no further, to round-off
        inside = (local >= 0.9) & (local <= np.array(g.nodes) - 1.9)
        if g.turned:
            inside &= np.abs(x - np.array(g.centre)) * g.inv_dx <= np.array(g.reach) + 0.1
        need(inside.all(), "particles lie out of the grid")
        key, row_nodes = self.arrays["particle_key"].astype(np.int64), math.prod(g.nodes[1:])
        need((key >= 0).all() and (key < g.nodes[0] * row_nodes).all(), "particles lie in cells that are not there")
        key, row = key[~gone], key[~gone] // row_nodes
        need((np.diff(key) >= 0).all(), "its particles are not in the order of their cells")
        depth = local[~gone, 0] - shape.shift - row
        need((depth > -0.6).all() and (depth < 1.6).all(), "particles lie far from the cells they are sorted into")

    def _check_events(self) -> None:
        time, ids, mode = (self.arrays[f"event_{name}"] for name in ("time", "id", "mode"))
        late = self.time + self.dt
        onset = float(self.arrays["event_onset"])
        need(onset == 0.0 or SHORTEST <= onset <= late or onset == NEVER, f"rock began to fail at {onset:g} s")
        need(((time >= onset * (1.0 - 1e-6)) & (time <= late)).all(), "events are of another time")
        need(((ids >= 0) & (ids < self.count)).all(), "events are of particles that are not there")
        need(((mode == 1) | (mode == 2)).all(), "events are of no known kind")
        counts = np.bincount(mode, minlength=3)[:3]
        need(np.array_equal(self.arrays["event_by_mode"], counts), "it counts other events than it holds")
        if len(ids):
            most = most_events(self.scene)
            need(np.bincount(ids).max() <= most, f"a particle has more than {most} events")
            failed = np.zeros(self.count, dtype=bool)
            failed[self.fields["id"][:, 0]] = self.fields["mode"][:, 0] != 0
            need(failed[ids].all(), "particles that have failed are whole")
            need(self.near(self.arrays["event_x"], ids), "events are far from their particles")

    def near(self, x: np.ndarray, ids: np.ndarray) -> bool:
        """Whether places of particles are where those may have been: within a grid's length of where they started."""
        g, travel = self.geometry, np.abs(self.arrays["grid_travel"]).max(axis=1)
        return bool((np.abs(x - self.seeded.x[ids]) <= np.array(g.nodes) * g.dx + travel).all())

    def _check_history(self) -> None:
        rows, reactions = self.arrays["history"], self.arrays["reactions"]
        need(len(rows) <= self.step + 1, f"it has {len(rows)} rows of {self.step} steps")
        need(not np.isinf(rows).any() and not (np.abs(rows[:, : len(HISTORY_COLUMNS)]) > LARGEST).any(),
             "its history is not finite")  # fmt: skip
        sure = [k for k, name in enumerate(HISTORY_COLUMNS) if name not in UNDEFINED]
        need(np.isfinite(rows[:, sure]).all(), "its history is not finite")
        need(not np.isinf(reactions).any() and not (np.abs(reactions) > LARGEST).any(), "its reactions are not finite")
        zero = self.arrays["history_zero"]
        need(not (np.abs(zero) > LARGEST).any(), "readings of its instruments are not finite")
        need(self.scene.loading.settle or not zero.any(), "its instruments do not read from nothing")
        of_row, latest = float(self.arrays["history_time"]), rows[-1] if len(rows) else None
        need(0.0 <= of_row <= self.time * (1.0 + 1e-9), f"its latest row is of t = {of_row:g} s")
        if latest is None:
            return
        column = {name: rows[:, k] for k, name in enumerate(HISTORY_COLUMNS)}
        need((np.diff(column["time_s"], prepend=0.0) >= 0.0).all(), "rows of its history are not in order")
        need(math.isclose(column["time_s"][-1], of_row, rel_tol=1e-9), "its latest row is of another time")
        need(
            not len(reactions) or np.array_equal(reactions[:, 0], column["time_s"]), "its reactions are of other times"
        )
        for name in ("failed_tension", "failed_shear"):
            need((np.diff(column[name], prepend=0.0) >= 0.0).all(), f"{name} does not grow")
        if of_row == self.time:
            seen = np.array([column["failed_tension"][-1], column["failed_shear"][-1]])
            need(np.array_equal(seen, self.arrays["event_by_mode"][1:]), "its latest row counts other failures")
            kinetic, error = float(column["energy_kinetic_J"][-1]), 1e-3 if self.single else 1e-6
            need(math.isclose(kinetic, self._kinetic, rel_tol=error, abs_tol=1e-20), "particles go at other speeds")

    def _check_dropped(self) -> None:
        total = float(densities(self.scene, self.seeded) @ self.seeded.volume)
        need(0.0 <= float(self.arrays["dropped_mass"]) <= 1.01 * total, "more has been dropped than there was")
        need(int(self.arrays["dropped_count"]) or not float(self.arrays["dropped_mass"]), "nothing was dropped")


def _within(values: np.ndarray, most: float) -> bool:
    """Whether all numbers are finite and at most so large."""
    return bool((np.abs(values) <= most).all())
