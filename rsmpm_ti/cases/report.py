"""The table of cases: on the terminal, as CSV, and one picture per case."""

import csv
import math
from collections.abc import Callable, Collection
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.cases.case import Outcome, Row
from rsmpm_ti.errors import SceneError
from rsmpm_ti.records.files import complete, write_csv


@dataclass(frozen=True, kw_only=True)
class Layout:
    """How rows are shown. `cells` of a case's row, one per column; `line` formats those of the terminal's table;
    `remark` is said below a row, "" for none."""

    columns: tuple[str, ...]
    cells: Callable[[str, Row], list[str]]
    line: str
    remark: Callable[[Row], str]


def _cells(name: str, row: Row) -> list[str]:
    numbers = [f"{v:.6g}" for v in (row.reference, row.got)]
    if row.tolerance == math.inf:
        return [name, row.quantity, "", numbers[1], "", "", "seen", row.reason]
    verdict = "pass" if row.passed else "MISS"
    return [name, row.quantity, *numbers, f"{row.error:+.3g}", f"{row.tolerance:.3g}", verdict, row.reason]


def _remark(row: Row) -> str:
    """A miss is followed by the reason of its tolerance."""
    return "" if row.passed else f"tolerance: {row.reason}"


VERDICTS = Layout(
    columns=("case", "quantity", "reference", "got", "error", "tolerance", "verdict", "reason"),
    cells=_cells,
    line="{0:<18} {1:<52} {2:>12} {3:>12} {4:>10} {5:>9}  {6}",
    remark=_remark,
)
"""Of rows that pass or miss."""


FORMS = ("quick", "full")
"""Of a case; the last column of a table that several runs of a command add to."""


def kept_table(path: Path, layout: Layout, cases: Collection[str]) -> list[list[str]]:
    """Lines of an earlier table about these cases. Raises SceneError for a file that is no such table: it may be
    somebody else's."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            head, *lines = csv.reader(file)
    except FileNotFoundError:
        return []
    except (OSError, ValueError, csv.Error):
        head, lines = [], []
    columns = [*layout.columns, "form"]
    if head != columns or any(len(line) != len(columns) or line[-1] not in FORMS for line in lines):
        what = "is no table of this command, or one of another version"
        raise SceneError(f"{path} {what}; remove it, or give another folder with --out")
    return [line for line in lines if line[0] in cases]


def write_kept_table(path: Path, table: list[list[str]], layout: Layout) -> None:
    """One line per compared number, the form of its case last."""
    write_csv(path, (*layout.columns, "form"), table)


def write_table(path: Path, table: list[list[str]]) -> None:
    """One line per number that passes or misses."""
    write_csv(path, VERDICTS.columns, table)


def print_rows(name: str, rows: tuple[Row, ...], seconds: float, layout: Layout = VERDICTS) -> None:
    """The rows of one case as they come, each with its remark."""
    for row in rows:
        print(layout.line.format(*layout.cells(name, row)), flush=True)
        remark = layout.remark(row)
        if remark:
            print(f"{'':<19}{remark}", flush=True)
    print(f"{name:<18} {seconds:.0f} s", flush=True)


def print_head(layout: Layout = VERDICTS) -> None:
    print(layout.line.format(*layout.columns))


def draw(path: Path, outcome: Outcome) -> None:
    from matplotlib.figure import Figure

    assert outcome.draw is not None
    figure = Figure(figsize=(9.0, 5.5), dpi=120, layout="constrained")
    outcome.draw(figure)
    with complete(path) as part:
        figure.savefig(part)
