"""One evaluation: the tests that the targets need, run in quick form on a rock, and read."""

import os
import warnings
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from rsmpm_ti.calibrate.targets.measured import Found, Wanted
from rsmpm_ti.calibrate.targets.names import AT, CURVES
from rsmpm_ti.errors import RockWarning, SceneError
from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.compression import PRESSURES
from rsmpm_ti.lab.quantity import over_seeds
from rsmpm_ti.lab.running import read_back, run_all
from rsmpm_ti.lab.shear import STRESSES
from rsmpm_ti.lab.standard import Measured, Options, Specimen
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.review.sentences import review
from rsmpm_ti.spec.scene import Output

Laboratory = Callable[[DataSheet, Path], Found]
"""From a rock, and a folder for its runs, to what its tests found."""

OUTPUT = Output(frames=0, movie=False, vtu=0)
"""Of every run: numbers alone."""

ROWS = 1000
"""Of a curve that is kept, at most."""


def with_pressures(wanted: Wanted, sheet: DataSheet) -> Wanted:
    """The same with pressures for every test that has some: those of the test for the sheet as it was at the start.

    By themselves tests take parts of UCS, which would move with it.
    """
    pressures = dict(wanted.confinements)
    for test in AT:
        if test in wanted.tests and test not in pressures:
            parts = PRESSURES if test == "triaxial" else STRESSES
            pressures[test] = tuple(float(f"{part * sheet.compressive_strength:.2g}") for part in parts)
    return replace(wanted, confinements=pressures)


def planned(wanted: Wanted, sheet: DataSheet) -> dict[str, list[list[Specimen]]]:
    """Test -> specimens of every seed. Raises SceneError where a specimen cannot be made of such rock."""
    plan = {}
    for test in wanted.tests:
        options = Options(quick=True, confinements=wanted.confinements.get(test))
        seeds = [TESTS[test].plan(sheet, options, seed) for seed in range(1, wanted.seeds + 1)]
        plan[test] = [[_plain(one, test) for one in seed] for seed in seeds]
        for one in (one for seed in plan[test] for one in seed):
            review(one.scene, one.scene.particles())  # what a run would refuse of a scene is refused here
    return plan


def _plain(one: Specimen, test: str) -> Specimen:
    label = one.label if one.label.startswith(test) else f"{test}_{one.label}"
    return replace(one, label=label, scene=replace(one.scene, output=OUTPUT))


def laboratory(wanted: Wanted, jobs: int | None = None) -> Laboratory:
    """That of this package. jobs: specimens at a time, by default as many as processors.

    Its Found tells problems of the rock, which then are kept; it raises SceneError for those of the machine.
    """

    def measure(sheet: DataSheet, folder: Path) -> Found:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RockWarning)  # of the start they are told, and later ones are alike
            try:
                plan = planned(wanted, sheet)
            except SceneError as error:
                return Found(problem=str(error))
        cores, every = os.cpu_count() or 1, [one for seeds in plan.values() for seed in seeds for one in seed]
        at_once = min(jobs or cores, len(every))
        seconds = 0.0
        folder.mkdir(parents=True, exist_ok=True)
        for done in run_all(every, folder, jobs=at_once, threads=max(1, cores // at_once), resume=True):
            if done.problem and not done.unstable:
                raise SceneError(f"{done.label}: {done.problem}; then run it again: evaluations are kept")
            if done.problem:
                return Found(problem=f"{done.label}: {done.problem}", seconds=seconds)
            seconds += done.seconds
        measured = {test: [[read_back(one, folder / one.label) for one in seed] for seed in seeds]
                    for test, seeds in plan.items()}  # fmt: skip
        return found_of(measured, seconds)

    return measure


def found_of(measured: dict[str, list[list[Measured]]], seconds: float = 0.0) -> Found:
    """What tests found; measured: test -> records of every seed."""
    quantities = {
        test: {q.name: q.value for q in over_seeds([TESTS[test].read(seed) for seed in seeds])}
        for test, seeds in measured.items()
    }
    curves = {test: curve_of([seed[0] for seed in seeds]) for test, seeds in measured.items() if test in CURVES}
    return Found(quantities=quantities, curves=curves, seconds=seconds)


def curve_of(specimens: Sequence[Measured]) -> tuple[np.ndarray, np.ndarray]:
    """Strain and stress [Pa], positive as loaded, each [rows]; over several specimens the mean stress.

    A plate in plane strain is stiffer than a cylinder: its strain is over 1 - nu^2, by which both have the slope E.
    """
    curves = []
    for one in specimens:
        elastic = one.specimen.scene.rock.elasticity
        plane = 1.0 if elastic.plane_stress else 1.0 - elastic.nu**2
        strain, stress = one.history["axial_strain"] / plane, nominal_stress(one.history)
        sign = -1.0 if strain[-1] < 0.0 else 1.0
        curves.append((sign * strain, sign * stress))
    end = max(float(strain[-1]) for strain, _ in curves)
    strain = np.linspace(0.0, end, ROWS)
    return strain, np.mean([np.interp(strain, x, y) for x, y in curves], axis=0)
