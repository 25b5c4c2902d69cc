"""The result of a validation for other programs, validation.json, and for a page, validation.md."""

import json
from pathlib import Path

from rsmpm_ti import __version__
from rsmpm_ti.cases.case import Row
from rsmpm_ti.cases.running import cases_of
from rsmpm_ti.records.files import complete, known
from rsmpm_ti.validate.comparison import LAYOUT, Comparison, cells
from rsmpm_ti.validate.experiment import Experiment

PAGE = (1, 3, 2, 4, 5, 6, 7, 8)
"""Columns of the table that a page has."""


def _inputs(case: Experiment) -> list[dict]:
    return [
        {"name": i.name, "value": i.value, "unit": i.unit, "source": i.source, "fitted_on": list(i.fitted_on)}
        for i in case.inputs
    ]


def _row(row: Row) -> dict:
    assert isinstance(row, Comparison)
    numbers = {
        "measured": row.reference, "low": row.low, "high": row.high, "predicted": row.got, "error": row.error,
        "target": row.tolerance,
    }  # fmt: skip
    return {
        "quantity": row.quantity, "unit": row.unit, **{name: known(value) for name, value in numbers.items()},
        "absolute": row.absolute, "verdict": row.verdict, "source": row.reason, "datum": row.datum, "why": row.beyond,
    }  # fmt: skip


def _page(rows: list[tuple[str, Row]]) -> str:
    """The table as Markdown, a heading for each case."""
    lines, before = [], ""
    for name, row in rows:
        if name != before:
            heads = [LAYOUT.columns[k] for k in PAGE]
            lines += ["", f"**`{name}`**", "", f"| {' | '.join(heads)} |", "|" + " --- |" * len(heads)]
            before = name
        of = cells(name, row)
        lines.append(f"| {' | '.join(of[k] for k in PAGE)} |")
    return "\n".join(lines[1:]) + "\n"


def write_records(catalogue: str, out: Path, rows: list[tuple[str, Row]]) -> None:
    """validation.json: version, and for each case its inputs and rows; validation.md."""
    cases, found = cases_of(catalogue), {}
    for name, row in rows:
        case = cases[name]
        assert isinstance(case, Experiment)
        found.setdefault(name, {"about": case.about, "inputs": _inputs(case), "rows": []})["rows"].append(_row(row))
    with complete(out / "validation.json") as part:
        part.write_text(json.dumps({"version": __version__, "cases": found}, indent=1, allow_nan=False) + "\n")
    with complete(out / "validation.md") as part:
        part.write_text(_page(rows), encoding="utf-8")
