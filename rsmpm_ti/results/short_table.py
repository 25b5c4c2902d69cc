"""A run in a few lines of HTML."""

import html

from rsmpm_ti.errors import short
from rsmpm_ti.records.files import LARGEST

MOST_WARNINGS = 10


def short_table(numbers: dict, rows: int, stopped: str, out: str) -> str:
    """numbers: the dict of summary.json, perhaps of a stranger: every word is escaped. rows: of the history."""
    peak = "peak" if _number(numbers.get("peak_stress_Pa")) is not None else "largest load so far"
    lines = [
        (peak, _amount(numbers.get("largest_stress_Pa"), 1e-6, "MPa")),
        ("first failure", _first(numbers)),
        ("failures", f"{_word(numbers, 'failed_tension')} in tension, {_word(numbers, 'failed_shear')} in shear"),
        ("cracks, fragments", f"{_word(numbers, 'cracks')}, {_word(numbers, 'fragments')}"),
        ("particles, steps", f"{_word(numbers, 'particles')}, {_word(numbers, 'steps')}"),
        ("wall time", _amount(numbers.get("wall_s"), 1.0, "s")),
        ("history", f"{rows} rows"),
        ("ended", stopped or "at the end of its schedule"),
        ("folder", out or "not written"),
    ]
    warnings = numbers.get("warnings")
    said = [entry for entry in warnings if isinstance(entry, str)] if isinstance(warnings, list) else []
    lines += [("warning", sentence) for sentence in said[:MOST_WARNINGS]]
    if len(said) > MOST_WARNINGS:
        lines.append(("warning", f"and {len(said) - MOST_WARNINGS} more"))
    cells = (f"<tr><th>{html.escape(name)}</th><td>{html.escape(said)}</td></tr>" for name, said in lines)
    return f"<table>{''.join(cells)}</table>"


def _number(value) -> float | None:
    known = isinstance(value, int | float) and not isinstance(value, bool) and abs(value) < LARGEST
    return float(value) if known else None


def _amount(value, factor: float, unit: str) -> str:
    number = _number(value)
    return "not known" if number is None else f"{number * factor:.4g} {unit}"


def _word(numbers: dict, name: str) -> str:
    value = numbers.get(name)
    return short(str(value)) if isinstance(value, str | int | float) else "-"


def _first(numbers: dict) -> str:
    if not _number(numbers.get("failed_tension")) and not _number(numbers.get("failed_shear")):
        return "none"
    load = _amount(numbers.get("first_failure_stress_Pa"), 1e-6, "MPa")
    return f"{load}, in {_word(numbers, 'first_failure_mode')}"
