"""report.json and quantities.csv: all that a report says, as data."""

import math
from pathlib import Path

from rsmpm_ti import __version__
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import LabTest, Measured, Options
from rsmpm_ti.lab.validity import Doubt, doubts_of
from rsmpm_ti.records.files import write_csv, write_json
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.review.machine import machine
from rsmpm_ti.spec.scene import Scene

SAID = (
    "peak_filtered_Pa", "first_failure_stress_Pa", "onset_stress_Pa", "time_scale", "least_pace", "particles", "steps",
    "wall_s", "energy_balance_error", "kinetic_share", "failed_tension", "failed_shear", "fragments",
    "largest_fragment_share", "acoustic_events", "stopped",
)  # fmt: skip
"""What of a run's summary.json stands in the report too."""


def report_of(
    test: LabTest, sheet: DataSheet, options: Options, commands: list[str], measured: list[list[Measured]],
    quantities: list[Quantity],
) -> dict:  # fmt: skip
    """All that the report says. measured: of each seed; paths are from the report's folder."""
    doubts = [doubt for seed in measured for one in seed for doubt in doubts_of(test.name, one)]
    return {
        "rsmpm_ti": __version__,
        "machine": machine(),
        "test": test.name,
        "about": test.about,
        "method": test.method,
        "limits": list(test.limits),
        "valid": not any(doubt.grave for doubt in doubts),
        "doubts": [_doubt(doubt) for doubt in doubts],
        "rock": _rock(sheet, measured[0][0].specimen.scene.domain.dx),
        "options": {"size_m": options.size, "dx_m": options.dx, "confinements_Pa": options.confinements,
                    "quick": options.quick, "seeds": len(measured),
                    "drawing": None if options.drawing is None else options.drawing.file},
        "commands": commands,
        "quantities": [_quantity(quantity) for quantity in quantities],
        "runs": [_run(one) for seed in measured for one in seed],
    }  # fmt: skip


def _doubt(doubt: Doubt) -> dict:
    return {"run": doubt.label, "grave": doubt.grave, "sentence": doubt.sentence}


def _rock(sheet: DataSheet, dx: float) -> dict:
    from dataclasses import fields

    held = {one.name: getattr(sheet, one.name) for one in fields(sheet)}
    return held | {"sources": dict(sheet.sources), "derived": sheet.derived(dx), "doubts": sheet.doubts(dx)}


def _quantity(quantity: Quantity) -> dict:
    text, unit = quantity.shown()
    return {
        "name": quantity.name, "value": quantity.value, "unit": quantity.unit, "error": quantity.error,
        "given": quantity.given, "values": list(quantity.values), "shown": text, "shown_unit": unit,
        "about": quantity.about,
    }  # fmt: skip


def _run(one: Measured) -> dict:
    return {
        "label": one.specimen.label, "about": one.specimen.about, "title": one.specimen.scene.title,
        "dx_m": one.specimen.scene.domain.dx, "facts": one.specimen.facts,
        "folder": f"runs/{one.specimen.label}", "scene": _scene(one.specimen.scene),
        "warnings": one.summary["warnings"],
        "numbers": {name: one.summary.get(name) for name in SAID},
    }  # fmt: skip


def _scene(scene: Scene) -> dict:
    """How it is computed; all of it is in the run's scene.json."""
    loading = scene.loading
    return {
        "shape": repr(scene.shape), "transfer": repr(scene.transfer), "order": scene.order, "dt_s": scene.dt,
        "grid_turn_deg": scene.domain.turn, "seeding": [repr(body.seeding) for body in scene.bodies],
        "boundaries": [type(boundary).__name__ for boundary in loading.boundaries],
        "confinement_Pa": loading.confinement, "servo": scene.servo is not None,
        "local_damping": scene.local_damping, "plane_stress": scene.rock.elasticity.plane_stress,
    }  # fmt: skip


FILES = ("report.html", "report.json", "quantities.csv")
"""Of a report, beside its runs."""


def set_aside(out: Path) -> None:
    """The report of an earlier test becomes `previous.report.html` and so on: if this one comes to no end, none of the
    runs that are there then is shown by another's numbers."""
    for name in FILES:
        if (out / name).is_file():
            (out / name).replace(out / f"previous.{name}")


def write_records(out: Path, report: dict) -> None:
    write_json(out / "report.json", report)
    header = ("name", "value", "unit", "error_95", "given", "over_given", "about")
    rows = []
    for quantity in report["quantities"]:
        given = quantity["given"]
        over = quantity["value"] / given if given and not math.isnan(given) else math.nan
        rows.append(
            [quantity[name] for name in ("name", "value", "unit", "error", "given")] + [over, quantity["about"]]
        )
    write_csv(out / "quantities.csv", header, rows)
