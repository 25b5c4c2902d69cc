"""What damping that is no physics of the rock took of a run's energy: sentences for its end."""

import numpy as np

DAMPED_FRACTION = 0.05
"""Largest fraction of the energy put into a run that damping may take unsaid: loads and speeds err by half of it."""

LAST = 0.1
"""Fraction of the rows over which the balance is averaged: velocity and stress are half a step apart, and the energy
of a wave beats (see `guard.py`)."""


def viscous_energy(sim) -> float:
    """What the artificial viscosity has dissipated so far in a `Simulation` [J]."""
    return float(sim.ledger.viscous.to_numpy().sum(dtype=np.float64))


def damped_energy(sim) -> float:
    """What local damping has taken so far in a `Simulation` [J]."""
    return float(sim.ledger.damped.to_numpy().sum(dtype=np.float64))


def mixing_energy(sim) -> float:
    """What PIC's part of the transfer has taken so far in a `Simulation` [J]."""
    return float(sim.ledger.mixed.to_numpy().sum(dtype=np.float64))


def stopped_energy(sim) -> float:
    """What boundaries have taken so far in a `Simulation` by stopping what particles bring to their nodes [J]."""
    return float(sim.ledger.stopped.to_numpy().sum())


def damping_said(scene, history: np.ndarray, energy_start: float, viscous: float, booked: float = 0.0) -> list[str]:
    """Sentences about numerical damping and artificial viscosity that took more than DAMPED_FRACTION of the energy that
    was put in: what the run started with, `energy_start` [J], and the most that was done on it.

    history: the rows of a run; viscous: what the artificial viscosity dissipated; booked: numerical damping that is
    part of the dissipated energy, by PIC's part of the transfer and by boundaries [J].
    """
    if not len(history):
        return []
    put_in = energy_start + history["work_J"]
    most = float(np.max(put_in))
    present = history["energy_kinetic_J"] + history["energy_elastic_J"] + history["energy_dissipated_J"]
    rows = max(1, round(LAST * len(history)))
    lost = float(np.mean((put_in - present)[-rows:])) + booked
    said: list[str] = []
    if not most > 0.0:  # NaN too, where a run broke down
        return said
    if lost > DAMPED_FRACTION * most:
        said.append(
            f"numerical damping took {100.0 * lost / most:.2g} % of the energy put in (above "
            f"{100.0 * DAMPED_FRACTION:g} %): {_cause(scene)}"
        )
    if viscous > DAMPED_FRACTION * most:
        said.append(
            f"artificial viscosity took {100.0 * viscous / most:.2g} % of the energy put in (above "
            f"{100.0 * DAMPED_FRACTION:g} %): waves or a start without a ramp; take start = Affine or Ramp, smaller "
            f"rock.viscosity.c1 and c2, or NoViscosity where there is no shock"
        )
    return said


def _cause(scene) -> str:
    """What of a scene damps, and what does not."""
    flip = getattr(scene.transfer, "flip", 1.0)
    causes = []
    if flip < 1.0:
        causes.append(f"{type(scene.transfer).__name__} with flip = {flip:g} (1 does not damp)")
    if scene.transfer.affine:
        causes.append(f"{type(scene.transfer).__name__} (PicFlip with flip = 1 does not damp)")
    if scene.order == "usl":
        causes.append("order = usl (musl does not damp)")
    return " and ".join(causes) or "waves of a few cells, or particles that cross cells; take a finer dx"
