"""A command that runs cases of a catalogue: its options, what it prints, its table, its exit status."""

import argparse
import contextlib
import difflib
import errno
import os
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

from rsmpm_ti.cases.case import Case, Row
from rsmpm_ti.cases.report import (
    FORMS,
    VERDICTS,
    Layout,
    kept_table,
    print_head,
    print_rows,
    write_kept_table,
)
from rsmpm_ti.cases.running import cases_of, run_cases
from rsmpm_ti.errors import SceneError
from rsmpm_ti.output.lock import Lock
from rsmpm_ti.process import command


@dataclass(frozen=True, kw_only=True)
class Suite:
    """`python -m rsmpm_ti.NAME`: the module that holds its CASES, and the file that its table goes to.

    layout: of the table; write: more files, `beside` the table, given their folder, the new (case, row) and the lines
    of the table; check: raises SceneError where those that are there are somebody else's; misses_fail: whether a row
    that does not pass makes the command fail, as a case that breaks does.
    """

    name: str
    about: str
    catalogue: str
    table: str
    threads: int | None = None  # of each case; by default the processors are shared out
    layout: Layout = VERDICTS
    beside: tuple[str, ...] = ()
    write: Callable[[Path, list[tuple[str, Row]], list[list[str]]], None] | None = None
    check: Callable[[Path], None] | None = None
    misses_fail: bool = True


def parser(suite: Suite) -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog=f"python -m rsmpm_ti.{suite.name}", description=suite.about)
    p.add_argument("cases", nargs="*", metavar="CASE", help="names of cases; all of the tier by default")
    p.add_argument("--list", action="store_true", help="list the cases and stop")
    p.add_argument("--full", action="store_true", help="the long tier: finer grids and every case")
    p.add_argument("--out", default=f"renders/{suite.name}", metavar="DIR", help="where table and pictures go")
    p.add_argument("--overwrite", action="store_true", help="let quick forms replace what full ones found")
    p.add_argument("--jobs", type=int, default=os.cpu_count() or 1, metavar="N", help="cases at a time")
    return p


def _refuse_names(names: list[str], cases: dict[str, Case]) -> None:
    unknown = [name for name in names if name not in cases]
    if unknown:
        near = difflib.get_close_matches(unknown[0].lower(), list(cases), n=1)
        guess = f"did you mean {near[0]}? T" if near else "t"
        raise SceneError(f"unknown case {', '.join(map(repr, unknown))}; {guess}he cases are {', '.join(cases)}")


@contextlib.contextmanager
def _folder(name: str) -> Iterator[Path]:
    """The folder, which no other run writes into meanwhile. Raises SceneError where it cannot be written."""
    out = Path(name)
    try:
        if not name:
            raise FileNotFoundError(errno.ENOENT, "it is no name")
        out.mkdir(parents=True, exist_ok=True)
        lock = Lock(out)
    except OSError as error:
        why = "it is a file" if out.is_file() else error.strerror
        raise SceneError(f"{name or repr(name)} cannot be written: {why}; give another folder with --out") from None
    with lock:
        yield out


def _check_files(suite: Suite, out: Path, names: list[str]) -> None:
    """Raises SceneError where something else has the place of a file that is to be written."""
    for file in (suite.table, *suite.beside, *(f"{name}.png" for name in names)):
        if (out / file).exists() and not (out / file).is_file():
            raise SceneError(f"{out / file} is no file, and one is to be written there; give another folder with --out")
    if suite.check is not None:
        suite.check(out)


def _check_forms(table: list[list[str]], forms: dict[str, str], out: Path) -> None:
    """Raises SceneError where the quick form of a case would replace what its full one found."""
    full = {line[0] for line in table if line[-1] == "full"}
    lost = [name for name, form in forms.items() if form == "quick" and name in full]
    if lost:
        remedy = "add --full, give another folder with --out, or --overwrite to replace it"
        raise SceneError(f"{out} holds what the full form of {', '.join(lost)} found; {remedy}")


@command
def run_suite(suite: Suite, arguments: list[str] | None = None) -> int:
    """Exit status: 0 every row passes or need not, 1 some do not or a case breaks, 2 the command is refused."""
    options, cases = parser(suite).parse_args(arguments), cases_of(suite.catalogue)
    _refuse_names(options.cases, cases)
    if options.jobs < 1:
        raise SceneError(f"--jobs {options.jobs} is not 1 or more")
    if options.list:
        for case in cases.values():
            print(f"{case.name:<18} {'quick, full' if case.quick else 'full':<12} {case.about}")
        return 0
    names = list(dict.fromkeys(options.cases)) or [c.name for c in cases.values() if options.full or c.quick]
    with _folder(options.out) as out:
        _check_files(suite, out, names)
        table = kept_table(out / suite.table, suite.layout, cases)
        forms = {name: FORMS[cases[name].in_full(options.full)] for name in names}
        if not options.overwrite:
            _check_forms(table, forms, out)
        return _run(suite, options, out, table, forms)


def _run(suite: Suite, options: argparse.Namespace, out: Path, table: list[list[str]], forms: dict[str, str]) -> int:
    names, order = list(forms), list(cases_of(suite.catalogue))
    jobs = min(options.jobs, len(names))
    rows: list[tuple[str, Row]] = []
    broken, found = 0, set()
    print_head(suite.layout)
    threads = suite.threads or max(1, (os.cpu_count() or 1) // jobs)
    for done in run_cases(suite.catalogue, names, options.full, out, jobs, threads):
        print_rows(done.name, done.rows, done.seconds, suite.layout)
        if done.problem:
            what = "has no picture" if done.rows else "broke"
            print(f"{done.name:<18} {what}: {done.problem}", flush=True)
            broken += 1
        if not done.rows:  # what it gave earlier stays
            continue
        found.add(done.name)
        new = [(done.name, row) for row in done.rows]
        rows += new
        lines = [[*suite.layout.cells(*entry), forms[done.name]] for entry in new]
        table = [line for line in table if line[0] != done.name] + lines
        table.sort(key=lambda line: order.index(line[0]))
        write_kept_table(out / suite.table, table, suite.layout)  # at once: it is not lost with the rest
        if suite.write is not None:
            suite.write(out, new, table)
    misses = sum(not row.passed for _, row in rows) + broken
    others = len({line[0] for line in table} - found)
    stays = f"; of earlier runs it keeps {others} more" if others else ""
    quick = ", in their quick form" if "quick" in forms.values() else ""
    print(f"{len(rows)} numbers{quick}, {misses} misses; table and pictures in {out}{stays}")
    return 1 if broken or (misses and suite.misses_fail) else 0
