"""python -m rsmpm_ti.calibrate --rock FILE|NAME --to TARGETS.toml [--out DIR] [--jobs N] [--check]."""

import argparse
import os
import shlex
import sys
import warnings
from pathlib import Path

from rsmpm_ti.errors import RockWarning, refuse
from rsmpm_ti.process import command, tell


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.calibrate",
        description="Fit parameters of a rock to measured numbers and curves, by quick runs of the laboratory's tests.",
        epilog="Run it again and it goes on: evaluations are kept in the folder. Exit status: 0 done, 1 done but a "
        "target is not met within its error, 2 input refused, 3 no evaluation came to an end.",
    )
    p.add_argument("--rock", required=True, metavar="FILE|NAME", help="data sheet of the rock at the start")
    p.add_argument("--to", required=True, metavar="TARGETS.toml", help="parameters with bounds, and what was measured")
    p.add_argument("--out", metavar="DIR", help="folder (default renders/calibrate/ and the name of TARGETS)")
    p.add_argument("--jobs", type=int, metavar="N", help="specimens at a time (default: as many as processors)")
    p.add_argument("--check", action="store_true", help="validate, print what would be run, and stop")
    return p


def folder_of(options: argparse.Namespace) -> Path:
    """Raises SceneError for a folder that holds something else than a calibration."""
    from rsmpm_ti.calibrate.kept import FOLDER
    from rsmpm_ti.output.lock import FILE as LOCK

    out = Path(options.out) if options.out else Path("renders") / "calibrate" / Path(options.to).stem
    if out.exists() and not out.is_dir():
        raise refuse("--out", str(out), "a folder")
    if out.is_dir() and any(path.name != LOCK for path in out.iterdir()) and not (out / FOLDER).is_dir():
        raise refuse("--out", str(out), "a new or empty folder, or one of an earlier calibration")
    return out


@command
def main(arguments: list[str] | None = None) -> int:
    arguments = sys.argv[1:] if arguments is None else arguments
    options = parser().parse_args(arguments)
    if options.jobs is not None and options.jobs < 1:
        raise refuse("--jobs", options.jobs, "1 or more")
    with warnings.catch_warnings():
        warnings.simplefilter("always", RockWarning)
        warnings.showwarning = lambda message, *_, **__: tell(f"rsmpm_ti: warning: {' '.join(str(message).split())}")
        from rsmpm_ti.calibrate.targets.reading import read_wanted
        from rsmpm_ti.spec.library.rocks import load_sheet

        wanted, sheet = read_wanted(Path(options.to)), load_sheet(options.rock)
        return run(wanted, sheet, options, f"python -m rsmpm_ti.calibrate {shlex.join(arguments)}")


def run(wanted, sheet, options: argparse.Namespace, said: str) -> int:
    from rsmpm_ti.calibrate.calibration import calibrate
    from rsmpm_ti.calibrate.experiment import laboratory, planned, with_pressures
    from rsmpm_ti.calibrate.saying import estimate, evaluation_said, report, task

    out = folder_of(options)
    wanted = with_pressures(wanted, sheet)
    print(task(wanted, sheet), flush=True)
    if options.check:
        print(estimate(wanted, planned(wanted, sheet), options.jobs or os.cpu_count() or 1))
        return 0
    found = calibrate(
        sheet, wanted, measure=laboratory(wanted, options.jobs), out=out, command=said,
        say=lambda one: tell(f"calibrate: {evaluation_said(one, wanted)}"),
    )  # fmt: skip
    if found is None:
        tell(f"calibrate: no evaluation came to an end, so nothing is fitted; {out / 'evaluations.csv'} says why")
        return 3
    print(report(found))
    print(f"written to {out}")
    return 0 if found.met else 1


if __name__ == "__main__":
    sys.exit(main())
