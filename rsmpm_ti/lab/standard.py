"""What a standard test is: specimens to be run, and what is read from their records."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from rsmpm_ti.lab.drawing import Drawing
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.scene import Scene


@dataclass(frozen=True, kw_only=True)
class Options:
    """Of a test. size: what the test calls its size [m], None for its own; dx: cell [m], None for its own;
    confinements [Pa], of those that have any; quick: coarser; drawing: of the specimen, None for the standard's."""

    size: float | None = None
    dx: float | None = None
    confinements: tuple[float, ...] | None = None
    quick: bool = False
    drawing: Drawing | None = None


@dataclass(frozen=True, kw_only=True)
class Specimen:
    """One run. label: its folder; about: what it is; facts: numbers that its reading needs."""

    label: str
    about: str
    scene: Scene
    facts: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Measured:
    """A specimen that was run: its history [rows], the numbers of summary.json, and where its files are."""

    specimen: Specimen
    history: np.ndarray
    summary: dict
    folder: Path


@dataclass(frozen=True, kw_only=True)
class LabTest:
    """method: the standard, as it is cited; limits: what a plane simulation of it is not.

    plan(sheet, options, seed): the specimens of one seed; read(measured): their numbers, in the same order for every
    seed.
    """

    name: str
    about: str
    method: str
    limits: tuple[str, ...]
    plan: Callable[[DataSheet, Options, int], list[Specimen]]
    read: Callable[[list[Measured]], list[Quantity]]
