"""A standard test as if it had been run: records of made-up specimens, and the report of them."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.compression import final_strain
from rsmpm_ti.lab.quantity import over_seeds
from rsmpm_ti.lab.record import report_of
from rsmpm_ti.lab.standard import Measured, Options, Specimen
from rsmpm_ti.paint.layout import lay_out
from rsmpm_ti.paint.png import TIME_NOTE, write_png
from rsmpm_ti.records.files import write_csv
from rsmpm_ti.records.history_table import HISTORY_COLUMNS
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.library.rocks import load_sheet

ROWS, FRAMES, END = 61, 6, 1e-3
"""Of a run: rows of its history, frames, its end [s]."""

PEAK = 0.6
"""Fraction of a run at which its load falls."""


def history_of(test: str, peak: float, strain: float) -> np.ndarray:
    """A straight line up to the peak [Pa], and nothing after it; strain: at the end."""
    names = [*HISTORY_COLUMNS, *(["gauge_mouth_m"] if test in ("bend", "scb") else [])]
    history = np.zeros(ROWS, dtype=[(name, np.float64) for name in names])
    part = np.linspace(0.0, 1.0, ROWS)
    load = peak * np.where(part <= PEAK + 1e-9, part / PEAK, 0.02)
    history["time_s"], history["axial_strain"] = END * part, strain * part
    history["stress_top_Pa"] = history["stress_bottom_Pa"] = load
    history["force_top_N"] = history["force_bottom_N"] = 0.05 * load
    history["lateral_strain"] = -0.2 * history["axial_strain"]
    history["volumetric_strain"] = 0.8 * history["axial_strain"]
    history["lateral_strain"][-5:] = history["volumetric_strain"][-5:] = math.nan
    history["work_J"], history["energy_elastic_J"] = part**2, np.where(part <= PEAK, part**2, 0.1)
    history["energy_dissipated_J"] = history["work_J"] - history["energy_elastic_J"]
    if "gauge_mouth_m" in names:
        history["gauge_mouth_m"] = 1e-5 * part
    return history


def summary_of_run(peak: float, strain: float) -> dict:
    return {
        "peak_filtered_Pa": peak, "peak_filtered_strain": PEAK * strain, "largest_stress_Pa": peak,
        "first_failure_stress_Pa": 0.9 * peak, "first_failure_time_s": 0.5 * END, "first_failure_position_m": None,
        "onset_stress_Pa": None, "time_scale": 4.0, "least_pace": 0.1, "particles": 5000, "steps": 3000, "wall_s": 30.0,
        "energy_balance_error": 0.002, "kinetic_share": 1e-4, "failed_tension": 600, "failed_shear": 0, "fragments": 2,
        "largest_fragment_share": 0.5, "acoustic_events": 3, "stopped": "", "numerical_fracture": None, "warnings": [],
    }  # fmt: skip


def fill(folder: Path, size: tuple[int, int]) -> None:
    """Frames of this size [px] that get darker, and acoustic events."""
    (folder / "frames").mkdir(parents=True)
    for k in range(FRAMES):
        image = np.full((*size[::-1], 3), 255 - 30 * k, dtype=np.uint8)
        note = {TIME_NOTE: f"{END * k / (FRAMES - 1):.10g}"}
        write_png(folder / f"frames/cracks_{k:04d}.png", image, painter="raster", **note)
    write_csv(folder / "acoustic.csv", ("time_s", "energy_J"), [(0.5 * END, 1.0), (0.6 * END, 2.0), (0.7 * END, 1.0)])


def run_of(specimen: Specimen, test: str, out: Path, peak: float, **summary) -> Measured:
    folder = out / "runs" / specimen.label
    low, high = specimen.scene.bodies[0].region.bounds()
    fill(folder, lay_out(tuple(low), tuple(high), None, 0, 0).size)
    strain = final_strain(specimen.scene)
    said = summary_of_run(peak, strain) | summary
    return Measured(specimen=specimen, history=history_of(test, peak, strain), summary=said, folder=folder)


def measured_of(test: str, out: Path, *, seeds: int = 1, sheet: DataSheet | None = None, **summary):
    """Runs of each seed. summary: what theirs says otherwise."""
    sheet = sheet or load_sheet("paper_rock")
    found = []
    for seed in range(1, seeds + 1):
        plan = TESTS[test].plan(sheet, Options(quick=True), seed)
        sign = -1.0 if test == "tension" else 1.0
        found.append([run_of(one, test, out, sign * (2e6 + 1e5 * seed + 5e6 * k), **summary)
                      for k, one in enumerate(plan)])  # fmt: skip
    return found


def report_and_runs(test: str, out: Path, *, name: str = "granite", **settings) -> tuple[dict, list[list[Measured]]]:
    sheet = replace(load_sheet("paper_rock"), name=name)
    measured = measured_of(test, out, sheet=sheet, **settings)
    quantities = over_seeds([TESTS[test].read(seed) for seed in measured])
    command = f"python -m rsmpm_ti.lab {test} --quick"
    return report_of(TESTS[test], sheet, Options(quick=True), [command], measured, quantities), measured
