"""python -m rsmpm_ti.study [STUDY ...] [--list] [--quick] [--kept] [--out DIR] [--jobs N]."""

import argparse
import os
import sys
from pathlib import Path

from rsmpm_ti.cases.report import VERDICTS, draw, print_head, print_rows, write_table
from rsmpm_ti.process import command, tell
from rsmpm_ti.study.catalogue import STUDIES
from rsmpm_ti.study.runs import all_kept, run_all


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.study",
        description="Families of runs against theory; runs that are done are kept in DIR and not run again.",
    )
    p.add_argument("studies", nargs="*", metavar="STUDY", help="names of studies")
    p.add_argument("--list", action="store_true", help="list the studies and stop")
    p.add_argument("--quick", action="store_true", help="coarser and fewer runs")
    p.add_argument("--kept", action="store_true", help="run nothing: table and picture of what is done so far")
    p.add_argument("--out", default="renders/study", metavar="DIR", help="where results and pictures go")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    return p


@command
def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    if options.list:
        print("\n".join(f"{study.name:<20} {study.about}" for study in STUDIES.values()))
        return 0
    unknown = [name for name in options.studies if name not in STUDIES]
    if unknown or not options.studies or options.jobs < 1:
        problem = "name a study" if not options.studies else f"unknown study {', '.join(unknown)}"
        if options.jobs < 1:
            problem = f"--jobs {options.jobs} is not 1 or more"
        tell(f"study: {problem}; the studies are {', '.join(STUDIES)}")
        return 2
    misses = 0
    for name in options.studies:
        study, results, total = STUDIES[name], {}, 0.0
        folder = Path(options.out) / name
        runs = study.runs(options.quick)
        for tag, result, seconds in all_kept(runs, folder) if options.kept else run_all(runs, folder, options.jobs):
            results[tag] = result
            total += seconds
            tell(f"{name}: {tag} ({len(results)} of {len(runs)}) {seconds:.0f} s")
        if not results:
            tell(f"study: none of the runs of {name} is kept in {folder}; run it without --kept")
            return 2
        outcome = study.finish({run.tag: results[run.tag] for run in runs if run.tag in results})
        draw(folder / f"{name}.png", outcome)
        write_table(folder / f"{name}.csv", [VERDICTS.cells(name, row) for row in outcome.rows])
        print_head()
        print_rows(name, outcome.rows, total)
        misses += sum(not row.passed for row in outcome.rows)
    return 1 if misses else 0


if __name__ == "__main__":
    sys.exit(main())
