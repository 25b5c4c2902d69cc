"""Measured numbers as they were published; each has a key, by which a case says what it was fitted on or judged by."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from rsmpm_ti.units import MPa, mm

FOLDER = Path(__file__).parent


@dataclass(frozen=True)
class Strength:
    """Principal stresses at failure [Pa], compression positive: sigma_1 >= sigma_2 >= sigma_3.

    key: file and line of the number, which is how cases name it.
    """

    key: str
    sigma_1: float
    sigma_2: float
    sigma_3: float
    source: str


def _lines(file: str) -> list[tuple[str, dict[str, str]]]:
    with open(FOLDER / file, newline="", encoding="utf-8") as lines:
        return [(f"{file}:{number}", row) for number, row in enumerate(csv.DictReader(lines), start=2)]


def strengths(rock: str, path: str) -> tuple[Strength, ...]:
    """Of a rock on a path, "compression", "extension" or "true triaxial", in the order of the table."""
    found = tuple(
        Strength(key, *(float(row[f"sigma_{k}_MPa"]) * MPa for k in (1, 2, 3)), row["source"])
        for key, row in _lines("strength_envelopes.csv")
        if (row["rock"], row["path"]) == (rock, path)
    )
    if not found:
        raise KeyError(f"no strengths of {rock} in {path}")
    return found


@dataclass(frozen=True)
class Band:
    """Lowest and highest load [N] of a set of tests at each crack mouth opening [m]."""

    opening: np.ndarray
    low: np.ndarray
    high: np.ndarray
    source: str


def gregoire() -> Band:
    """Half-notched beams, 50 mm deep."""
    rows = [row for _, row in _lines("gregoire_half_notch.csv")]
    opening, low, high = (np.array([float(row[c]) for row in rows]) for c in ("cmod_mm", "load_min_N", "load_max_N"))
    return Band(opening * mm, low, high, "Gregoire, Rojas-Solano & Pijaudier-Cabot 2013, IJNAMG 37:1434")
