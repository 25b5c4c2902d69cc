"""A command that runs cases of a catalogue: its options, what it prints, its table, its exit status."""

import argparse
import os
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.cases.case import Row
from rsmpm_ti.cases.report import VERDICTS, Layout, kept_table, print_head, print_rows, write_table
from rsmpm_ti.cases.running import cases_of, run_cases
from rsmpm_ti.process import command, tell


@dataclass(frozen=True, kw_only=True)
class Suite:
    """`python -m rsmpm_ti.NAME`: the module that holds its CASES, and the file that its table goes to.

    layout: of the table; write: more files, given their folder, the new (case, row) and whether they are of the long
    tier, and the lines of the table; misses_fail: whether a row that does not pass makes the command fail, as a case
    that breaks does.
    """

    name: str
    about: str
    catalogue: str
    table: str
    threads: int | None = None  # of each case; by default the processors are shared out
    layout: Layout = VERDICTS
    write: Callable[[Path, list[tuple[str, Row]], bool, list[list[str]]], None] | None = None
    misses_fail: bool = True


def parser(suite: Suite) -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog=f"python -m rsmpm_ti.{suite.name}", description=suite.about)
    p.add_argument("cases", nargs="*", metavar="CASE", help="names of cases; all of the tier by default")
    p.add_argument("--list", action="store_true", help="list the cases and stop")
    p.add_argument("--full", action="store_true", help="the long tier: finer grids and every case")
    p.add_argument("--out", default=f"renders/{suite.name}", metavar="DIR", help="where table and pictures go")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="cases at a time")
    return p


@command
def run_suite(suite: Suite, arguments: list[str] | None = None) -> int:
    """Exit status: 0 every row passes or need not, 1 some do not or a case breaks, 2 the command is refused."""
    options, cases = parser(suite).parse_args(arguments), cases_of(suite.catalogue)
    if options.list:
        for case in cases.values():
            print(f"{case.name:<18} {'quick, full' if case.quick else 'full':<12} {case.about}")
        return 0
    unknown = [name for name in options.cases if name not in cases]
    if unknown or options.jobs < 1:
        problem = f"unknown case {', '.join(unknown)}" if unknown else f"--jobs {options.jobs} is not 1 or more"
        tell(f"{suite.name}: {problem}; the cases are {', '.join(cases)}")
        return 2
    names = options.cases or [case.name for case in cases.values() if options.full or case.quick]
    out = Path(options.out)
    try:
        out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        tell(f"{suite.name}: {out} cannot be written: {error.strerror}; give another with --out")
        return 2
    jobs = min(options.jobs, len(names))
    rows: list[tuple[str, Row]] = []
    broken, order = 0, list(cases)
    table = kept_table(out / suite.table, suite.layout, set(cases))
    print_head(suite.layout)
    threads = suite.threads or max(1, (os.cpu_count() or 1) // jobs)
    for done in run_cases(suite.catalogue, names, options.full, out, jobs, threads):
        print_rows(done.name, done.rows, done.seconds, suite.layout)
        if done.problem:
            print(f"{done.name:<18} broke: {done.problem}", flush=True)
            broken += 1
        new = [(done.name, row) for row in done.rows]
        rows += new
        table = [line for line in table if line[0] != done.name] + [suite.layout.cells(*entry) for entry in new]
        table.sort(key=lambda line: order.index(line[0]))
        write_table(out / suite.table, table, suite.layout)  # at once: what has been found is not lost with the rest
        if suite.write is not None:
            suite.write(out, new, options.full, table)
    misses = sum(not row.passed for _, row in rows) + broken
    others = len({line[0] for line in table} - set(names))
    stays = f"; of earlier runs it keeps {others} more" if others else ""
    print(f"{len(rows)} numbers, {misses} misses; table and pictures in {out}{stays}")
    return 1 if broken or (misses and suite.misses_fail) else 0
