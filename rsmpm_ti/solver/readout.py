"""Particles copied out of their fields as they lie, and the snapshot that is made of the copy, by whoever needs it.

A run hands copies to the process that paints: putting them in order takes three times as long as the copy, and the
solver does not wait for it.
"""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.failure.failure_margin import damages, margins
from rsmpm_ti.fields.records import NEVER
from rsmpm_ti.fields.state import Simulation
from rsmpm_ti.records.events import EventTable
from rsmpm_ti.records.snapshot import Pattern, Snapshot


@dataclass(frozen=True)
class Readout:
    """A copy of the particles at one instant, in the order in which they lie and in the run's precision."""

    time: float  # [s]
    fields: dict[str, np.ndarray]  # of `Particles`, by name, those that the rock has; and what `margins` returns
    failed: tuple[np.ndarray, np.ndarray]  # id and time [s] of the failure events, in no order
    history: dict[str, np.ndarray]  # what the law after failure remembers, by name
    oriented: np.ndarray  # whether the crack of a particle has a normal, [n]

    def snapshot(self) -> Snapshot:
        """The particles in the order of their ids, without those that were dropped."""
        fields = self.fields
        ids = fields["id"]
        order = np.argsort(ids, kind="stable")
        order = order[fields["volume"][order] != 0.0]
        n = len(order)

        def column(name, dtype=np.float64):
            return fields[name].take(order, axis=0).astype(dtype, copy=False)

        u, packed = column("u"), column("sigma")
        sigma = np.zeros((n, 3, 3))
        positions = ((0, 0), (1, 1), (2, 2), (0, 1), (1, 2), (2, 0))
        for k in range(packed.shape[1]):
            a, b = positions[k]
            sigma[:, a, b] = sigma[:, b, a] = packed[:, k]
        sigma_1, sigma_3 = extreme_stresses(packed)
        history = {name: values.take(order, axis=0) for name, values in self.history.items()}
        crack_angle = np.full(n, np.nan)
        if self.oriented.any():
            begun = (column("mode", np.int8) > 0) & self.oriented.take(order)
            across, up = history["crack_normal"][begun, :2].astype(np.float64).T
            crack_angle[begun] = np.degrees(np.arctan2(up, across)) % 180.0
        return Snapshot(
            time=self.time,
            id=ids[order],
            x=column("reference") + u,
            displacement=u,
            velocity=column("v"),
            sigma=sigma,
            sigma_1=sigma_1,
            sigma_3=sigma_3,
            volume=column("volume") * column("J"),
            strength=column("strength") if "strength" in fields else np.ones(n),
            failure_mode=column("failure_mode", np.int8),
            failure_time=self._failure_times()[ids[order]],
            margin=column("margin"),
            governs=column("governs", np.int8),
            damage=column("damage"),
            aperture=column("aperture") if "aperture" in fields else np.full(n, np.nan),
            crack_angle=crack_angle,
            history=history,
            rock=column("rock", np.int8) if "rock" in fields else None,
        )

    def _failure_times(self) -> np.ndarray:
        """By id; of a particle that failed twice, the later."""
        ids, times = self.failed
        of_id = np.full(len(self.fields["id"]), np.nan)
        order = np.argsort(times, kind="stable")
        of_id[ids[order]] = times[order]
        return of_id


def read_out(sim: Simulation, time: float) -> Readout:
    """Copy what a snapshot is made of."""
    particles, events = sim.particles, sim.events
    names = ["id", "reference", "u", "v", "sigma", "volume", "J"]
    names += ["mode"] * particles.breaks + ["strength"] * particles.varied + ["rock"] * sim.several
    fields = {name: getattr(particles, name).to_numpy() for name in names}
    fields |= margins(sim)
    history = particles.history.to_numpy()
    rock = fields.get("rock")
    oriented = np.zeros(particles.count, dtype=bool)
    for view in sim.views:
        law, own = view.rock.after_failure, (rock == view.index if sim.several else slice(None))
        if view.rock.criterion.breaks:
            oriented[own] = law.oriented
            aperture = law.aperture({name: values[own] for name, values in history.items()}, sim.band)
            if aperture is not None:
                fields.setdefault("aperture", np.full(particles.count, np.nan))[own] = aperture
    count = min(events.count[None], events.capacity)
    return Readout(
        time=time,
        fields=fields,
        failed=(events.id.to_numpy()[:count], events.time.to_numpy()[:count]),
        history=history,
        oriented=oriented,
    )


def read_pattern(sim: Simulation, time: float) -> Pattern:
    """Copy what a picture of cracks needs, in the order of ids, without what was dropped."""
    particles, failed = sim.particles, damages(sim)
    ids, volume = particles.id.to_numpy(), particles.volume.to_numpy()
    order = np.argsort(ids, kind="stable")
    order = order[volume[order] != 0.0]
    u = particles.u.to_numpy()[order].astype(np.float64)
    return Pattern(
        time=time,
        id=ids[order],
        x=particles.reference.to_numpy()[order] + u,
        displacement=u,
        volume=(volume * particles.J.to_numpy())[order].astype(np.float64),
        failure_mode=failed["failure_mode"][order].astype(np.int8),
        governs=failed["governs"][order].astype(np.int8),
        damage=failed["damage"][order],
    )


def read_rocks(sim: Simulation) -> np.ndarray:
    """Index in `Scene.rocks` of the rock of every particle, by id, [n]; of a scene of several rocks."""
    rock = np.empty(sim.particles.count, dtype=np.int32)
    rock[sim.particles.id.to_numpy()] = sim.particles.rock.to_numpy()
    return rock


def take_snapshot(sim: Simulation, time: float) -> Snapshot:
    """Copy the particles out, in the order of their ids, without those that were dropped."""
    return read_out(sim, time).snapshot()


def extreme_stresses(packed: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Largest and smallest principal stress of packed ones (see tensors.py), [n] each; in 2D by the closed form, in a
    tenth of the time of an eigenvalue solver. What is not finite counts as 0 or as a very large number.
    """
    packed = np.nan_to_num(packed, posinf=1e300, neginf=-1e300)
    if packed.shape[1] == 4:
        xx, yy, zz, xy = packed.T
        centre, radius = 0.5 * xx + 0.5 * yy, np.hypot(0.5 * xx - 0.5 * yy, xy)
        return np.maximum(centre + radius, zz), np.minimum(centre - radius, zz)
    xx, yy, zz, xy, yz, zx = packed.T
    principal = np.linalg.eigvalsh(np.stack([xx, xy, zx, xy, yy, yz, zx, yz, zz], axis=1).reshape(-1, 3, 3))
    return principal[:, 2], principal[:, 0]


def read_events(sim: Simulation) -> EventTable:
    """All events so far, sorted by time, then particle id, so that threads do not show."""
    n = min(sim.events.count[None], sim.events.capacity)
    columns = {name: getattr(sim.events, name).to_numpy()[:n] for name in sim.events.names}
    order = np.lexsort((columns["id"], columns["time"]))
    columns = {name: column[order] for name, column in columns.items()}
    onset = float(sim.events.onset[None])
    return EventTable(**columns, time_scale=sim.scene.time_scale, onset=onset if onset < NEVER else np.inf)
