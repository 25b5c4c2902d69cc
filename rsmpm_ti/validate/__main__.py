"""python -m rsmpm_ti.validate [CASE ...] [--list] [--full] [--out DIR] [--jobs N]."""

import functools
import sys

from rsmpm_ti.cases.command import Suite, run_suite
from rsmpm_ti.validate.comparison import LAYOUT
from rsmpm_ti.validate.record import PAGE, RECORD, TABLE, check, write_records

CATALOGUE = "rsmpm_ti.validate.catalogue"

SUITE = Suite(
    name="validate",
    about="Hold predictions against experiments: measured distances; status 1: a case broke. A miss is a result.",
    catalogue=CATALOGUE,
    table=TABLE,
    beside=(RECORD, PAGE),
    check=check,
    layout=LAYOUT,
    write=functools.partial(write_records, CATALOGUE),
    misses_fail=False,
)


def main(arguments: list[str] | None = None) -> int:
    return run_suite(SUITE, arguments)


if __name__ == "__main__":
    sys.exit(main())
