"""The result of a validation for other programs, validation.json, and for a page, validation.md."""

import json
from pathlib import Path

from rsmpm_ti import __version__
from rsmpm_ti.cases.case import Row
from rsmpm_ti.cases.running import cases_of
from rsmpm_ti.errors import SceneError
from rsmpm_ti.records.files import complete, known
from rsmpm_ti.validate.comparison import LAYOUT, Comparison
from rsmpm_ti.validate.experiment import Experiment

TABLE, RECORD, PAGE = "validation.csv", "validation.json", "validation.md"

ON_PAGE = (1, 3, 2, 4, 5, 6, 7, 8)
"""Columns of the table that a page has."""


def _inputs(case: Experiment) -> list[dict]:
    return [
        {"name": i.name, "value": i.value, "unit": i.unit, "source": i.source, "fitted_on": list(i.fitted_on)}
        for i in case.inputs
    ]


def _row(row: Row) -> dict:
    assert isinstance(row, Comparison)
    numbers = {
        "reference": row.reference, "low": row.low, "high": row.high, "predicted": row.got, "error": row.error,
        "target": row.tolerance,
    }  # fmt: skip
    return {
        "quantity": row.quantity, "unit": row.unit, **{name: known(value) for name, value in numbers.items()},
        "absolute": row.absolute, "verdict": row.verdict, "source": row.reason, "datum": row.datum, "why": row.beyond,
    }  # fmt: skip


def _page(table: list[list[str]]) -> str:
    """The table as Markdown, a heading for each case."""
    lines, before = [], ""
    for line in table:
        if line[0] != before:
            heads = [LAYOUT.columns[k] for k in ON_PAGE]
            tier = ", quick form" if line[-1] == "quick" else ""
            lines += ["", f"**`{line[0]}`**{tier}", "", f"| {' | '.join(heads)} |", "|" + " --- |" * len(heads)]
            before = line[0]
        lines.append(f"| {' | '.join(line[k] for k in ON_PAGE)} |")
    return "\n".join(lines[1:]) + "\n"


def _earlier(path: Path) -> dict:
    """Cases of an earlier validation.json, none where there is none. Raises SceneError for another file."""
    try:
        cases = json.loads(path.read_text(encoding="utf-8"))["cases"]
        if all(isinstance(case["full"], bool) and case["rows"][0]["quantity"] for case in cases.values()):
            return cases
    except FileNotFoundError:
        return {}
    except (OSError, ValueError, KeyError, IndexError, TypeError, AttributeError):
        pass
    what = "is no record of this command, or one of another version"
    raise SceneError(f"{path} {what}; remove it, or give another folder with --out")


def check(out: Path) -> None:
    """Raises SceneError where validation.json, or validation.md without a table, is somebody else's."""
    _earlier(out / RECORD)
    if (out / PAGE).exists() and not (out / TABLE).exists():
        raise SceneError(f"{out / PAGE} has no {TABLE} beside it; remove it, or give another folder with --out")


def write_records(catalogue: str, out: Path, rows: list[tuple[str, Row]], table: list[list[str]]) -> None:
    """validation.json: for each case of the table its inputs and rows, its version and tier; validation.md."""
    cases, new, full = cases_of(catalogue), {}, {line[0]: line[-1] == "full" for line in table}
    for name, row in rows:
        case = cases[name]
        assert isinstance(case, Experiment)
        head = {"version": __version__, "full": full[name], "about": case.about, "inputs": _inputs(case), "rows": []}
        new.setdefault(name, head)["rows"].append(_row(row))
    known_cases = {**_earlier(out / RECORD), **new}
    found = {name: known_cases[name] for name in full if name in known_cases}
    with complete(out / RECORD) as part:
        part.write_text(json.dumps({"cases": found}, indent=1, allow_nan=False) + "\n", encoding="utf-8")
    with complete(out / PAGE) as part:
        part.write_text(_page(table), encoding="utf-8")
