"""The table of a verification: on the terminal, as CSV, and one picture per case."""

import math
from pathlib import Path

from rsmpm_ti.cases.case import Outcome, Row
from rsmpm_ti.records.files import complete, write_csv

COLUMNS = ("case", "quantity", "reference", "got", "error", "tolerance", "verdict", "reason")


def cells(name: str, row: Row) -> list[str]:
    numbers = [f"{v:.6g}" for v in (row.reference, row.got)]
    if row.tolerance == math.inf:
        return [name, row.quantity, "", numbers[1], "", "", "seen", row.reason]
    verdict = "pass" if row.passed else "MISS"
    return [name, row.quantity, *numbers, f"{row.error:+.3g}", f"{row.tolerance:.3g}", verdict, row.reason]


def write_table(path: Path, rows: list[tuple[str, Row]]) -> None:
    """One line per compared number, with the reason of its tolerance."""
    write_csv(path, COLUMNS, (cells(name, row) for name, row in rows))


def print_rows(name: str, rows: tuple[Row, ...], seconds: float) -> None:
    """The rows of one case as they come; a miss is followed by the reason of its tolerance."""
    for row in rows:
        _, quantity, reference, got, error, tolerance, verdict, reason = cells(name, row)
        print(f"{name:<18} {quantity:<52} {reference:>12} {got:>12} {error:>10} {tolerance:>9}  {verdict}", flush=True)
        if not row.passed:
            print(f"{'':<19}tolerance: {reason}", flush=True)
    print(f"{name:<18} {seconds:.0f} s", flush=True)


def print_head() -> None:
    print(f"{'case':<18} {'quantity':<52} {'reference':>12} {'got':>12} {'error':>10} {'tolerance':>9}  verdict")


def draw(path: Path, outcome: Outcome) -> None:
    from matplotlib.figure import Figure

    assert outcome.draw is not None
    figure = Figure(figsize=(9.0, 5.5), dpi=120, layout="constrained")
    outcome.draw(figure)
    with complete(path) as part:
        figure.savefig(part)
