"""python -m rsmpm_ti.lab TEST [--rock FILE] [--size L] [--dx L] [--confinement P,...] [--seeds N] [--quick]."""

import argparse
import math
import os
import sys
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np

from rsmpm_ti.errors import RockWarning, SceneError, refuse, shown
from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.drawing import Drawing
from rsmpm_ti.lab.quantity import over_seeds
from rsmpm_ti.lab.standard import LabTest, Options, Specimen
from rsmpm_ti.process import command, tell

MAX_SEEDS = 100
EXAMPLES = {"m": "54mm", "Pa": "10MPa"}


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.lab",
        description="A standard test of a rock: specimens are run, and a report is written.",
        epilog="Exit status: 0 done, 1 done but not to be trusted (the report says why), 2 input refused, 3 a specimen "
        "came to no end.",
    )
    p.add_argument("test", nargs="?", metavar="TEST", help=f"one of {', '.join(TESTS)}")
    p.add_argument("--rock", default="paper_rock", metavar="FILE|NAME", help="a rock's data sheet, or one of the shelf")
    p.add_argument("--size", metavar="L", help="width of a specimen, diameter of a disc, depth of a beam, such as 54mm")
    p.add_argument("--dx", metavar="L", help="edge of a cell, such as 0.5mm")
    p.add_argument(
        "--confinement", metavar="P,...", help="of a triaxial set, or normal stresses of shear: 0,5MPa,10MPa"
    )
    p.add_argument("--drawing", metavar="FILE", help="of ucs and triaxial: an outline (.stl), an image whose darker "
                   "half is rock (.png), or flaws x1, y1, x2, y2, a row each (.csv)")  # fmt: skip
    p.add_argument("--scale", metavar="L", help="one unit of the drawing, or one pixel (default 1mm)")
    p.add_argument("--seeds", type=int, default=1, metavar="N", help="specimens of each kind; means get error bars")
    p.add_argument("--quick", action="store_true", help="coarser cells")
    p.add_argument("--out", metavar="DIR", help="folder of the report (default renders/lab/TEST)")
    p.add_argument("--overwrite", action="store_true", help="renew the report in --out")
    p.add_argument("--resume", action="store_true", help="keep the runs in the folder that are complete")
    p.add_argument("--jobs", type=int, metavar="N", help="specimens at a time (default: as many as processors)")
    p.add_argument("--list", action="store_true", help="list the tests and stop")
    p.add_argument("--check", action="store_true", help="validate, print what would be run, and stop")
    return p


def test_of(name: str | None) -> LabTest:
    if name in TESTS:
        return TESTS[name]
    problem = "name a test" if name is None else f"there is no test {shown(name)}"
    raise SceneError(f"{problem}; the tests are {', '.join(TESTS)}")


def options_of(options: argparse.Namespace) -> Options:
    """Numbers of the options, in SI."""
    from rsmpm_ti.units import Unit, quantity

    def number(name: str, text: str | None, unit: str) -> float | None:
        if text is None:
            return None
        try:
            value = 0.0 if _is_nothing(text) else quantity(text, Unit(unit))
        except ValueError:
            value = None
        if value is None:
            raise refuse(f"--{name}", text, f"a number with its unit, such as {EXAMPLES[unit]}")
        return value

    size, dx = number("size", options.size, "m"), number("dx", options.dx, "m")
    for name, value in (("size", size), ("dx", dx)):
        if value is not None and not 1e-6 <= value <= 1e3:
            raise refuse(f"--{name}", getattr(options, name), "a length from 1 um to 1 km")
    pressures = None
    if options.confinement is not None:
        if options.test not in ("triaxial", "shear"):
            raise refuse("--confinement", options.confinement, "left out but for triaxial and shear")
        texts = [text.strip() for text in options.confinement.split(",")]
        pressures = tuple(number("confinement", text, "Pa") for text in texts)
        if any(p is None or not 0.0 <= p <= 1e10 or 0.0 < p < 1e3 for p in pressures):
            raise refuse("--confinement", options.confinement, "pressures of 0, or 1 kPa to 10 GPa")
        if len({f"{1e-6 * p:g}" for p in pressures}) < len(pressures):
            raise refuse(
                "--confinement", options.confinement, "pressures that differ", "for more of each, give --seeds"
            )
    scale = number("scale", options.scale, "m")
    if scale is not None and (options.drawing is None or not 1e-9 <= scale <= 1e3):
        raise refuse("--scale", options.scale, "a length from 1 nm to 1 km, beside a --drawing")
    drawing = None
    if options.drawing is not None:
        if options.test not in ("ucs", "triaxial"):
            raise refuse("--drawing", options.drawing, "left out but for ucs and triaxial")
        drawing = Drawing(file=options.drawing, scale=scale or 1e-3)
        if size is not None and not drawing.is_traces:
            raise refuse("--size", options.size, "left out beside the drawing of a specimen", "give its --scale")
    if not 1 <= options.seeds <= MAX_SEEDS:
        raise refuse("--seeds", options.seeds, f"in [1, {MAX_SEEDS}]")
    if options.jobs is not None and options.jobs < 1:
        raise refuse("--jobs", options.jobs, "1 or more")
    return Options(size=size, dx=dx, confinements=pressures, quick=options.quick, drawing=drawing)


def _is_nothing(text: str) -> bool:
    """Whether it is a 0, which needs no unit."""
    try:
        return float(text) == 0.0
    except ValueError:
        return False


def folder_of(options: argparse.Namespace) -> Path:
    """Where the report goes. Raises SceneError for a folder of another kind, or one that holds a report."""
    out = Path(options.out) if options.out else Path("renders") / "lab" / options.test
    if out.exists() and not out.is_dir():
        raise refuse("--out", str(out), "a folder")
    if options.out and out.is_dir() and any(out.iterdir()) and not (options.overwrite or options.resume):
        raise refuse("--out", str(out), "an empty or a new folder", "or give --overwrite, or --resume")
    return out


def describe(specimens: list[Specimen]) -> str:
    lines = []
    for one in specimens:
        scene = one.scene
        low, high = (np.array(bound) for bound in scene.bodies[0].region.bounds())
        size = " x ".join(f"{1e3 * edge:.4g}" for edge in high - low)
        count = sum(len(body.x) for body in scene.particles())
        lines.append(
            f"{one.label:<18} {one.about}: {size} mm, {count} particles, dx = {1e3 * scene.domain.dx:.4g} mm, "
            f"{scene.steps} steps, time_scale {scene.time_scale:.3g}"
        )
    return "\n".join(lines)


@command
def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    if options.list:
        for test in TESTS.values():
            print(f"{test.name:<10} {test.about}; {test.method}")
        return 0
    test, asked = test_of(options.test), options_of(options)
    with warnings.catch_warnings():
        warnings.simplefilter("always", RockWarning)
        warnings.showwarning = lambda message, *_, **__: tell(f"rsmpm_ti: warning: {' '.join(str(message).split())}")
        from rsmpm_ti.spec.library.rocks import load_sheet

        sheet = load_sheet(options.rock)
        specimens = [test.plan(sheet, asked, seed) for seed in range(1, options.seeds + 1)]
        if options.check:
            print(describe([one for seed in specimens for one in seed]))
            return 0
    return run(
        test, sheet, asked, specimens, folder_of(options), options, sys.argv[1:] if arguments is None else arguments
    )


def run(test, sheet, asked: Options, specimens, out: Path, options, arguments: list[str]) -> int:
    from rsmpm_ti.lab.record import report_of, set_aside, write_records
    from rsmpm_ti.lab.report.page import write_page
    from rsmpm_ti.lab.running import of_another, read_back, run_all

    cores = os.cpu_count() or 1
    every = [one for seed in specimens for one in seed]
    jobs = min(options.jobs or cores, len(every))
    others = of_another(every, out / "runs") if options.resume else []
    if others:
        allowed = f"left out: {others[0]} is a run of another rock, size or drawing"
        raise refuse("--resume", True, allowed, "take another --out, or --overwrite")
    out.mkdir(parents=True, exist_ok=True)
    set_aside(out)
    problems = []
    for k, done in enumerate(run_all(every, out / "runs", jobs=jobs, threads=max(1, cores // jobs),
                                     resume=options.resume)):  # fmt: skip
        said = done.problem or ("was there" if done.kept else f"{done.seconds:.0f} s")
        tell(f"lab: {done.label} ({k + 1} of {len(every)}): {said}")
        problems += [done.label] if done.problem else []
    if problems:
        tell(f"lab: {', '.join(problems)} came to no end, so there is no report; what ran is in {out / 'runs'}")
        return 3
    measured = [[read_back(one, out / "runs" / one.label) for one in seed] for seed in specimens]
    quantities = over_seeds([test.read(seed) for seed in measured])
    if asked.drawing is not None:  # what the sheet says is of intact rock
        quantities = [replace(quantity, given=math.nan) for quantity in quantities]
    report = report_of(test, sheet, asked, [command_of(arguments)], measured, quantities)
    write_records(out, report)
    write_page(out, report, measured)
    print(table(report))
    print(f"written to {out}")
    return 0 if report["valid"] else 1


def command_of(arguments: list[str]) -> str:
    import shlex

    again = [word for word in arguments if word not in ("--resume", "--overwrite")]
    return " ".join(["python -m rsmpm_ti.lab", *map(shlex.quote, again)])


def table(report: dict) -> str:
    """The report in a terminal."""
    lines = [f"{report['test']}: {report['about']}", f"rock: {report['rock']['name']}"]
    for quantity in report["quantities"]:
        value = f"{quantity['shown']} {quantity['shown_unit']}".strip()
        ratio = quantity["value"] / quantity["given"] if quantity["given"] else math.nan
        over = "" if math.isnan(ratio) else f"{100.0 * (ratio - 1.0):+.2g} % off the sheet"
        lines.append(f"  {quantity['name']:<34} {value:<26} {over}".rstrip())
    lines += [f"{'NOT VALID' if d['grave'] else 'note'}: {d['run']}: {d['sentence']}" for d in report["doubts"]]
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
