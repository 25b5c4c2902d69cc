"""python -m rsmpm_ti.verify [CASE ...] [--list] [--full] [--out DIR] [--jobs N]."""

import argparse
import os
import sys
from pathlib import Path

from rsmpm_ti.verify.catalogue import CASES
from rsmpm_ti.verify.report import print_head, print_rows, write_table
from rsmpm_ti.verify.running import run_cases


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.verify",
        description="Hold the solver against exact solutions, finite elements and published data; status 1: a miss.",
    )
    p.add_argument("cases", nargs="*", metavar="CASE", help="names of cases; all of the tier by default")
    p.add_argument("--list", action="store_true", help="list the cases and stop")
    p.add_argument("--full", action="store_true", help="the long tier: finer grids and every case")
    p.add_argument("--out", default="renders/verify", metavar="DIR", help="where table and pictures go")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="cases at a time")
    return p


def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    if options.list:
        for case in CASES.values():
            print(f"{case.name:<18} {'quick, full' if case.quick else 'full':<12} {case.about}")
        return 0
    unknown = [name for name in options.cases if name not in CASES]
    if unknown or options.jobs < 1:
        problem = f"unknown case {', '.join(unknown)}" if unknown else f"--jobs {options.jobs} is not 1 or more"
        print(f"verify: {problem}; the cases are {', '.join(CASES)}", file=sys.stderr)
        return 2
    names = options.cases or [case.name for case in CASES.values() if options.full or case.quick]
    out = Path(options.out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        print(f"verify: {out} cannot be written: {error.strerror}; give another with --out", file=sys.stderr)
        return 2
    jobs = min(options.jobs, len(names))
    rows, misses = [], 0
    print_head()
    for done in run_cases(names, options.full, out, jobs, max(1, (os.cpu_count() or 1) // jobs)):
        print_rows(done.name, done.rows, done.seconds)
        if done.problem:
            print(f"{done.name:<18} broke: {done.problem}", flush=True)
        misses += sum(not row.passed for row in done.rows) + bool(done.problem)
        rows += [(done.name, row) for row in done.rows]
    rows.sort(key=lambda entry: names.index(entry[0]))
    write_table(out / "verification.csv", rows)
    print(f"{len(rows)} numbers, {misses} misses; table and pictures in {out}")
    return 1 if misses else 0


if __name__ == "__main__":
    sys.exit(main())
