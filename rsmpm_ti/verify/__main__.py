"""python -m rsmpm_ti.verify [CASE ...] [--list] [--full] [--out DIR] [--jobs N]."""

import sys

from rsmpm_ti.cases.command import Suite, run_suite

SUITE = Suite(
    name="verify",
    about="Hold the solver against exact solutions, finite elements and published data; status 1: a miss.",
    catalogue="rsmpm_ti.verify.catalogue",
    table="verification.csv",
)


def main(arguments: list[str] | None = None) -> int:
    return run_suite(SUITE, arguments)


if __name__ == "__main__":
    sys.exit(main())
