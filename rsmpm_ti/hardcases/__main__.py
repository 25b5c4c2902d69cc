"""python -m rsmpm_ti.hardcases [CASE ...] [--list] [--full] [--out DIR] [--jobs N]."""

import sys

from rsmpm_ti.cases.command import Suite, run_suite

SUITE = Suite(
    name="hardcases",
    about="Hard cases: cell crossing, small masses, steps past the limit, impact, collapse; status 1: a miss.",
    catalogue="rsmpm_ti.hardcases.catalogue",
    table="hardcases.csv",
    threads=1,  # a hundred particles: waking another thread costs more than they do
)


def main(arguments: list[str] | None = None) -> int:
    return run_suite(SUITE, arguments)


if __name__ == "__main__":
    sys.exit(main())
