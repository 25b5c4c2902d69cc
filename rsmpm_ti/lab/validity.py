"""When a result should not be trusted, and why."""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.lab.bending import NOTCH, characteristic_length, energy_of, work_of_fracture
from rsmpm_ti.lab.compression import final_strain
from rsmpm_ti.lab.standard import Measured
from rsmpm_ti.spec.regions import slits_of

MAX_KINETIC, MAX_ENERGY, CELLS_IN_ZONE, MAX_SCALE_ERROR = 0.05, 0.01, 4.0, 0.98
"""Kinetic over stored energy up to the peak; energy that is not accounted for, over the work; cells in the process
zone, half of l_ch for a linear softening (Hillerborg et al. 1976); fraction of the strain at which a peak is one."""

DEEP = 2.5
"""Ligament over the length of the process zone from which linear fracture mechanics reads a toughness: ASTM E399."""


@dataclass(frozen=True, kw_only=True)
class Doubt:
    """label: of the specimen; grave: whether its numbers should not be used; sentence: what and why."""

    label: str
    grave: bool
    sentence: str


def doubts_of(test: str, one: Measured) -> list[Doubt]:
    """All of one specimen, the grave ones first."""
    checks = (
        _no_peak,
        _peak_at_end,
        _off_centre,
        _at_platen,
        _moving,
        _energy,
        _coarse,
        _smeared,
        _parted,
        _shallow,
        _load_left,
    )
    found = [doubt for check in checks if (doubt := check(test, one)) is not None]
    return sorted(found, key=lambda doubt: not doubt.grave)


def _doubt(one: Measured, grave: bool, sentence: str) -> Doubt:
    return Doubt(label=one.specimen.label, grave=grave, sentence=sentence)


def _no_peak(test: str, one: Measured) -> Doubt | None:
    if one.summary["peak_filtered_Pa"] is not None:
        return None
    return _doubt(one, True, "the load has not fallen by a tenth of its largest: there is no peak, so no strength")


def _peak_at_end(test: str, one: Measured) -> Doubt | None:
    strain, end = one.summary["peak_filtered_strain"], final_strain(one.specimen.scene)
    if strain is None or abs(strain) < MAX_SCALE_ERROR * abs(end):
        return None
    return _doubt(one, True, f"the peak comes at {100.0 * strain / end:.0f} % of the run's strain: it may not be one")


def _off_centre(test: str, one: Measured) -> Doubt | None:
    """Where a disc splits first: within a third of its radius of the loaded diameter's middle, or it was crushed."""
    where = one.summary["first_failure_position_m"]
    if test != "brazilian" or where is None:
        return None
    radius = one.specimen.scene.loading.width / math.pi
    off = math.hypot(where[0] - radius, where[1] - radius) / radius
    if off < 1.0 / 3.0:
        return None
    sentence = f"the first failure is {off:.2f} radii from the disc's middle: a Brazilian test must split from there"
    return _doubt(one, True, sentence)


def _at_platen(test: str, one: Measured) -> Doubt | None:
    said = next((said for said in one.summary["warnings"] if "cells from the platen" in said), None)
    return None if said is None or test == "brazilian" else _doubt(one, True, said)


def _moving(test: str, one: Measured) -> Doubt | None:
    """From half of the stored energy on until the peak: what the start and the collapse make move is no part of it."""
    peak, history = one.summary["peak_filtered_strain"], one.history
    before = np.abs(history["axial_strain"]) <= abs(peak) if peak is not None else np.ones(len(history), dtype=bool)
    stored = np.maximum.accumulate(history["energy_elastic_J"])
    begun = before & (stored > 0.5 * stored[before].max())
    if not begun.any():
        return None
    share = float((history["energy_kinetic_J"][begun] / stored[begun]).max())
    if share <= MAX_KINETIC:
        return None
    return _doubt(one, True, f"kinetic energy reaches {100.0 * share:.2g} % of the stored one before the peak: the "
                             f"load is not quasi-static; lower loading.time_scale")  # fmt: skip


def _energy(test: str, one: Measured) -> Doubt | None:
    error = one.summary["energy_balance_error"]
    if error is None or error <= MAX_ENERGY:
        return None
    return _doubt(one, False, f"{100.0 * error:.2g} % of the energy is not accounted for")


def _coarse(test: str, one: Measured) -> Doubt | None:
    rock, dx = one.specimen.scene.rock, one.specimen.scene.domain.dx
    if math.isnan(energy_of(rock)):
        return _doubt(one, False, "rock without a fracture energy: strength where stress is uneven depends on the cell")
    cells = 0.5 * characteristic_length(rock) / dx
    if cells >= CELLS_IN_ZONE:
        return None
    return _doubt(one, False, f"the process zone, E' G_f/(2 sigma_t^2), is {cells:.2g} cells: below {CELLS_IN_ZONE:g} "
                              f"cracks follow the cells; take a smaller --dx")  # fmt: skip


def _smeared(test: str, one: Measured) -> Doubt | None:
    """A drawn flaw whose ends are rounder to the mean stress than they are drawn."""
    scene = one.specimen.scene
    widths = [slit.width for body in scene.bodies for slit in slits_of(body.region)]
    mean = scene.rock.nonlocal_mean
    if test not in ("ucs", "triaxial") or not widths or not mean.acts or mean.length <= 0.5 * min(widths):
        return None
    said = f"the mean stress that decides is over {1e3 * mean.length:.3g} mm, a flaw {1e3 * min(widths):.3g} mm wide"
    return _doubt(one, False, f"{said}: its ends are rounder to it than drawn; give flaws a width, a fifth "
                              f"number in each row of the table, of {2e3 * mean.length:.3g} mm or more")  # fmt: skip


def _shallow(test: str, one: Measured) -> Doubt | None:
    """By the load at the peak toughness comes out as that of a large specimen only if the process zone is small."""
    size = one.specimen.facts.get("height")
    if test not in ("bend", "scb") or size is None:
        return None
    lengths = NOTCH * size / characteristic_length(one.specimen.scene.rock)
    if not lengths < DEEP:
        return None
    below = f"below {DEEP:g} the toughness by the peak load is that of this size"
    return _doubt(one, False, f"the ligament is {lengths:.2g} times E' G_f/sigma_t^2: {below}")


def _load_left(test: str, one: Measured) -> Doubt | None:
    """The work of fracture is that of a specimen that is broken through."""
    if test not in ("bend", "scb") or not math.isnan(work_of_fracture(one)):
        return None
    load = one.history["force_top_N"]
    left = 100.0 * load[-1] / load.max()
    return _doubt(one, False, f"{left:.0f} % of the largest load is left at the end: the work of fracture is not read")


def _parted(test: str, one: Measured) -> Doubt | None:
    said = one.summary["numerical_fracture"]
    return _doubt(one, True, said) if said else None
