"""python -m rsmpm_ti.validate.fracture.cohesive_reference: peaks and curves of cohesive cracks, by finite elements.

Writes cohesive_reference.json, which the cases read; `cohesive_crack.py` says how. Needs the extra `reference`.
"""

import json
import sys
from collections.abc import Callable
from dataclasses import replace
from importlib.metadata import version
from pathlib import Path

import numpy as np

from rsmpm_ti.records.files import write_json
from rsmpm_ti.units import GPa, MPa, mm
from rsmpm_ti.validate.fracture.cohesive_crack import (
    HalfBody,
    condensed,
    exponential,
    growth,
    linear,
    toughness_stress,
)

STORED = Path(__file__).with_name("cohesive_reference.json")

CELLS = 120
"""Along the ligament; peaks are also found with half as many, which says how far they have converged."""

CONCRETE_STRENGTH, CONCRETE_ENERGY = 3.9 * MPa, 143.2
"""Of Gregoire, Rojas-Solano & Pijaudier-Cabot (2013), Int. J. Numer. Anal. Methods Geomech. 37:1434; J/m^2."""

BEAM = HalfBody(
    depth=50.0 * mm, notch=25.0 * mm, length=87.5 * mm, E=37.0 * GPa, nu=0.2, plane_stress=True, span=125.0 * mm,
    roller=2.0 * mm, gauge=20.0 * mm,
)  # fmt: skip
"""Theirs."""

ROCK_STRENGTH, ROCK_ENERGY = 2.0 * MPa, 5.0
"""Of `lab_rock`."""

PLATE = HalfBody(depth=150.0 * mm, notch=0.0, length=75.0 * mm, E=17.0 * GPa, nu=0.14)

NOTCHES = (11.0 * mm, 22.0 * mm, 44.0 * mm, 76.0 * mm, 108.0 * mm)
"""Depths, about 1/2, 1, 2, 3.5 and 5 lengths E' G_f/sigma_t^2 of that rock."""

POINTS = 80
"""Of a stored curve."""


def _beam(law: Callable, cells: int) -> tuple[np.ndarray, np.ndarray]:
    """Opening of the mouth [m] and load [N/m]."""
    half_load, opening, _ = growth(condensed(BEAM, cells), CONCRETE_STRENGTH, law)
    return opening, 2.0 * half_load


def _plate(notch: float, cells: int) -> float:
    """Nominal stress at the peak [Pa]."""
    half = condensed(replace(PLATE, notch=notch), cells)
    across = growth(half, ROCK_STRENGTH, linear(ROCK_STRENGTH, ROCK_ENERGY))[2]
    return float(across.max()) / PLATE.depth


def make() -> dict:
    found = {
        "command": "python -m rsmpm_ti.validate.fracture.cohesive_reference",
        "versions": {package: version(package) for package in ("scikit-fem", "numpy", "scipy")},
        "cells": CELLS,
        "beam": {},
        "plate": [],
    }
    for law in (exponential, linear):
        softening = law(CONCRETE_STRENGTH, CONCRETE_ENERGY)
        (opening, load), coarse = _beam(softening, CELLS), _beam(softening, CELLS // 2)[1]
        kept = np.unique(np.linspace(0, len(load) - 1, POINTS).astype(int))
        found["beam"][law.__name__] = {
            "opening_m": np.round(opening[kept], 9).tolist(),
            "load_N_per_m": np.round(load[kept], 1).tolist(),
            "peak_N_per_m": round(float(load.max()), 1),
            "change_from_mesh_twice_as_coarse": round(float(load.max() / coarse.max() - 1.0), 5),
        }
    for notch in NOTCHES:
        stress = _plate(notch, CELLS)
        tough = toughness_stress(replace(PLATE, notch=notch), ROCK_ENERGY, CELLS // 2)
        found["plate"].append(
            {
                "notch_m": notch,
                "peak_Pa": round(stress),
                "toughness_stress_Pa": round(tough),
                "change_from_mesh_twice_as_coarse": round(stress / _plate(notch, CELLS // 2) - 1.0, 5),
            }
        )
    return found


def read() -> dict:
    return json.loads(STORED.read_text(encoding="utf-8"))


def main() -> int:
    write_json(STORED, make())
    print(f"wrote {STORED}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
