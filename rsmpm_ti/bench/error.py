"""`bench error`: the sweep, its CSV, its picture and its recommendations."""

import csv
import multiprocessing
import os
from dataclasses import fields
from pathlib import Path

from rsmpm_ti.bench.measures import Measure, measure
from rsmpm_ti.bench.pareto import Entry, pareto, recommendations
from rsmpm_ti.bench.sweep import CELLS, SHAPES, Setting, sweep
from rsmpm_ti.process import end_with_parent, no_current_folder, without_ctrl_c
from rsmpm_ti.records.files import complete, write_csv

CSV_NAME, PICTURE_NAME = "speed_vs_error.csv", "speed_vs_error.png"
NAMES = tuple(f.name for f in fields(Setting))

TITLES = {
    "slit": "Slit specimen: rms error of sigma_1\nagainst finite elements",
    "bar": "Vibrating bar: error of the mode\nafter two periods",
    "vortex": "Manufactured vortex:\nrms displacement error",
}
COLOURS = dict(zip(SHAPES, ("#4477aa", "#ccaa22", "#aa3377"), strict=True))
MARKS = {"musl": "o", "usf": "s", "usl": "^"}


def _work(setting: Setting) -> tuple[Setting, Measure | None, str]:
    try:
        return setting, measure(setting), ""
    except Exception as error:  # one setting that breaks leaves the others
        return setting, None, f"{type(error).__name__}: {error}"


def run_sweep(cases: list[str], finest: bool, jobs: int, out: Path) -> list[Entry]:
    """Every setting on one thread in a process of its own, `jobs` at a time; rows are written as they come.

    Rows of other cases that an earlier sweep left in `out` stay.
    """
    settings = [setting for case in cases for setting in sweep(case, finest)]
    path = out / CSV_NAME
    entries = [entry for entry in read_sweep(path) if entry[0].case not in cases] if path.exists() else []

    def save() -> None:
        write_csv(path, [*NAMES, "error", "wall_s", "particle_steps"], (_row(*entry) for entry in entries))

    save()
    with no_current_folder():
        with without_ctrl_c():
            pool = multiprocessing.get_context("spawn").Pool(jobs, initializer=end_with_parent, maxtasksperchild=8)
        with pool:
            for k, (setting, m, problem) in enumerate(pool.imap_unordered(_work, settings), 1):
                head = f"{k}/{len(settings)} {setting.case} {setting.cells}: {setting.scheme}"
                if m is None:
                    print(f"{head}: broke: {problem}", flush=True)
                    continue
                print(f"{head}: error {100 * m.error:.3g} %, {m.wall_s:.2f} s", flush=True)
                entries.append((setting, m))
                save()
    order = list(CELLS)
    return sorted(entries, key=lambda entry: order.index(entry[0].case))


def _row(setting: Setting, m: Measure) -> list:
    return [*(getattr(setting, name) for name in NAMES), f"{m.error:.6g}", f"{m.wall_s:.4g}", m.particle_steps]


def read_sweep(path: Path) -> list[Entry]:
    """The entries of a CSV that `run_sweep` wrote."""
    kinds = {f.name: f.type for f in fields(Setting)}
    entries = []
    with open(path, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            values = {name: row[name] == "True" if kind is bool else kind(row[name]) for name, kind in kinds.items()}
            m = Measure(float(row["error"]), float(row["wall_s"]), int(row["particle_steps"]))
            entries.append((Setting(**values), m))
    return entries


def draw(path: Path, entries: list[Entry]) -> None:
    """Error against wall time and against particle-steps, log-log, one column a case, the Pareto front as a line."""
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    cases = list(dict.fromkeys(setting.case for setting, _ in entries))
    costs = (("wall time [s]", lambda m: m.wall_s), ("particle-steps", lambda m: float(m.particle_steps)))
    figure = Figure(figsize=(5.0 * len(cases), 8.5), dpi=110, layout="constrained")
    grid = figure.subplots(2, len(cases), squeeze=False)
    for column, case in enumerate(cases):
        own = [entry for entry in entries if entry[0].case == case]
        for row, (label, cost) in enumerate(costs):
            axes = grid[row][column]
            for setting, m in own:
                colour = COLOURS[setting.shape]
                axes.plot(
                    cost(m), m.error, MARKS[setting.order], color=colour, markersize=6, alpha=0.85,
                    markerfacecolor=colour if setting.transfer == "flip" else "none",
                )  # fmt: skip
            front = pareto(own, cost)
            axes.plot([cost(m) for _, m in front], [m.error for _, m in front], "k-", linewidth=1.0, zorder=0)
            axes.set(xscale="log", yscale="log", xlabel=label, title=TITLES[case] if row == 0 else "")
            axes.grid(True, which="major", color="0.9")
        grid[0][0].set_ylabel("relative error")
        grid[1][0].set_ylabel("relative error")
    keys = [Line2D([], [], marker="o", linestyle="", color=c, label=shape) for shape, c in COLOURS.items()]
    keys += [Line2D([], [], marker=mark, linestyle="", color="0.4", label=order) for order, mark in MARKS.items()]
    keys += [Line2D([], [], marker="o", linestyle="", color="0.4", markerfacecolor="none", label="Apic (filled: FLIP)")]
    keys += [Line2D([], [], color="k", linewidth=1.0, label="Pareto front")]
    figure.legend(handles=keys, loc="outside lower center", ncols=len(keys))
    with complete(path) as part:
        figure.savefig(part)


def error(cases: list[str], finest: bool, jobs: int | None, out: Path) -> str:
    """Sweep, write CSV and picture into `out`, and return the table of recommendations."""
    out.mkdir(parents=True, exist_ok=True)
    entries = run_sweep(cases or list(CELLS), finest, jobs or os.cpu_count() or 1, out)
    draw(out / PICTURE_NAME, entries)
    return recommendations(entries)
