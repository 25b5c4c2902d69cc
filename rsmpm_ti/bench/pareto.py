"""Which settings are worth their cost: the Pareto front, and the cheapest setting of each accuracy."""

from rsmpm_ti.bench.measures import Measure
from rsmpm_ti.bench.sweep import Setting

LEVELS = (0.1, 0.05, 0.02, 0.01, 0.005, 0.0025)
"""Accuracies for which the cheapest setting is named."""

Entry = tuple[Setting, Measure]


def pareto(entries: list[Entry], cost) -> list[Entry]:
    """Entries that no other beats in both cost and error, cheapest first."""
    front, best = [], float("inf")
    for entry in sorted(entries, key=lambda e: (cost(e[1]), e[1].error)):
        if entry[1].error < best:
            front.append(entry)
            best = entry[1].error
    return front


def cheapest(entries: list[Entry], level: float) -> Entry | None:
    """The setting of least wall time with an error of at most `level`; None if there is none."""
    good = [entry for entry in entries if entry[1].error <= level]
    return min(good, key=lambda e: e[1].wall_s) if good else None


def recommendations(entries: list[Entry]) -> str:
    """A Markdown table: case, accuracy, cheapest setting, its error and cost relative to the cheapest of its case."""
    lines = ["| case | error at most | cells | setting | error | wall time |", "| --- | --- | --- | --- | --- | --- |"]
    for case in dict.fromkeys(setting.case for setting, _ in entries):
        own = [entry for entry in entries if entry[0].case == case]
        unit = min(m.wall_s for _, m in own)
        shown = None
        for level in LEVELS:
            entry = cheapest(own, level)
            if entry is None or entry is shown:
                continue
            shown = entry
            setting, m = entry
            found = f"{100 * m.error:.2g} % | {m.wall_s / unit:.1f} x"
            lines.append(f"| {case} | {100 * level:g} % | {setting.cells} | {setting.scheme} | {found} |")
    return "\n".join(lines)
