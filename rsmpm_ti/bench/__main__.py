"""python -m rsmpm_ti.bench speed | passes | scaling | fill | lab | memory | start | runs | error."""

import argparse
import os
import sys
from pathlib import Path

from rsmpm_ti.bench.sweep import CELLS, SHAPES
from rsmpm_ti.process import command


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(prog="python -m rsmpm_ti.bench", description="Measure speed, alone and against error.")
    what = p.add_subparsers(dest="what", required=True)
    speed = what.add_parser("speed", help="ratios to a naive twin and to one in C++, interleaved in one run")
    speed.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    speed.add_argument("--rounds", type=int, default=7)
    speed.add_argument("--steps", type=int, default=40)
    passes = what.add_parser("passes", help="time of each part of a step")
    passes.add_argument("--shape", choices=SHAPES, default="bspline")
    passes.add_argument("--threads", type=int, default=1)
    passes.add_argument("--rounds", type=int, default=25)
    scaling = what.add_parser("scaling", help="cost per particle-step from 20 000 to 5 million particles")
    scaling.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    scaling.add_argument("--rounds", type=int, default=3)
    scaling.add_argument("--shape", choices=SHAPES, default="bspline")
    fill = what.add_parser("fill", help="the sparse grid over the dense one, against how much of the grid is filled")
    fill.add_argument("--threads", type=int, default=1)
    fill.add_argument("--rounds", type=int, default=9)
    lab = what.add_parser("lab", help="the rock of cube_lab over the paper's rule, whole and at its peak")
    lab.add_argument("--dx", type=float, default=5e-4, help="cell size [m]")
    lab.add_argument("--threads", type=int, default=1)
    lab.add_argument("--rounds", type=int, default=9)
    memory = what.add_parser("memory", help="bytes per particle")
    memory.add_argument("scenes", nargs="*", default=["intact", "cube", "disc", "cube_lab"])
    start = what.add_parser("start", help="seconds until the first step, with and without kept kernels")
    start.add_argument("scene", nargs="?", default="cube")
    start.add_argument("--full", action="store_true", help="not with the scene's --quick settings")
    start.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    start.add_argument("--rounds", type=int, default=3)
    runs = what.add_parser("runs", help="whole runs, with and without pictures, and deterministic")
    runs.add_argument("scene", nargs="?", default="cube")
    runs.add_argument("--quick", action="store_true", help="with the scene's --quick settings")
    runs.add_argument("--rounds", type=int, default=3)
    error = what.add_parser("error", help="sweep numerical settings: error against wall time")
    error.add_argument("cases", nargs="*", choices=(*CELLS, []), metavar="CASE", help=f"of {', '.join(CELLS)}; all")
    error.add_argument("--quick", action="store_true", help="leave the finest grids out")
    error.add_argument("--jobs", type=int, default=None, help="settings at a time, one thread each; all cores")
    error.add_argument("--out", default="renders/bench", metavar="DIR", help="where the CSV and the picture go")
    return p


@command
def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    print(_measure(options))
    return 0


def _measure(options: argparse.Namespace) -> str:
    if options.what == "speed":
        from rsmpm_ti.bench.speed import speed

        return speed(options.threads, options.rounds, options.steps)
    if options.what == "passes":
        from rsmpm_ti.bench.passes import passes

        return passes(options.shape, options.threads, options.rounds)
    if options.what == "scaling":
        from rsmpm_ti.bench.scaling import scaling

        return scaling(options.rounds, options.threads, options.shape)
    if options.what == "fill":
        from rsmpm_ti.bench.ratios import fill

        return fill(options.threads, options.rounds)
    if options.what == "lab":
        from rsmpm_ti.bench.ratios import lab_rock

        return lab_rock(options.dx, options.threads, options.rounds)
    if options.what == "memory":
        from rsmpm_ti.bench.scaling import memory

        return memory(tuple(options.scenes))
    if options.what == "start":
        from rsmpm_ti.bench.startup import start

        return start(options.scene, not options.full, options.threads, options.rounds)
    if options.what == "runs":
        from rsmpm_ti.bench.runs import runs

        return runs(options.scene, options.quick, options.rounds)
    from rsmpm_ti.bench.error import error

    return error(options.cases, not options.quick, options.jobs, Path(options.out))


if __name__ == "__main__":
    sys.exit(main())
