"""python -m rsmpm_ti.bench speed | error."""

import argparse
import sys
from pathlib import Path

from rsmpm_ti.bench.settings import CELLS


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="python -m rsmpm_ti.bench", description="Measure speed, alone and against error.")
    what = p.add_subparsers(dest="what", required=True)
    speed = what.add_parser("speed", help="ratios to a naive implementation, interleaved in one run")
    speed.add_argument("--threads", type=int, default=1)
    speed.add_argument("--rounds", type=int, default=7)
    speed.add_argument("--steps", type=int, default=40)
    speed.add_argument("--order", choices=("musl", "usf"), default="musl")
    error = what.add_parser("error", help="sweep numerical settings: error against wall time")
    error.add_argument("cases", nargs="*", choices=(*CELLS, []), metavar="CASE", help=f"of {', '.join(CELLS)}; all")
    error.add_argument("--quick", action="store_true", help="leave the finest grids out")
    error.add_argument("--jobs", type=int, default=None, help="settings at a time, one thread each; all cores")
    error.add_argument("--out", default="renders/bench", metavar="DIR", help="where the CSV and the picture go")
    return p


def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    if options.what == "speed":
        from rsmpm_ti.bench.speed import speed

        print(speed(options.threads, options.rounds, options.steps, options.order))
    else:
        from rsmpm_ti.bench.error import error

        print(error(options.cases, not options.quick, options.jobs, Path(options.out)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
