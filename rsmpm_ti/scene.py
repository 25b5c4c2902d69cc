"""The command line: python -m rsmpm_ti.scene NAME [options]."""

import argparse
import math
import os
import sys
import warnings
from dataclasses import replace
from pathlib import Path
from typing import TextIO, cast

from rsmpm_ti.errors import RockWarning, SceneError, UnstableRun, shown
from rsmpm_ti.process import Output, command, tell
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.spec.library.glance import glance
from rsmpm_ti.spec.library.names import run_name
from rsmpm_ti.spec.library.places import available, find, ships
from rsmpm_ti.spec.library.rocks import described, for_scene, list_rocks, load_sheet
from rsmpm_ti.spec.loader import about, load_scene
from rsmpm_ti.spec.mass_scaling import estimate
from rsmpm_ti.spec.review.memory import memory
from rsmpm_ti.spec.review.placement import area_errors
from rsmpm_ti.spec.review.sentences import review
from rsmpm_ti.spec.scene import Scene
from rsmpm_ti.spec.scene_json import schema
from rsmpm_ti.spec.seeding import Seeds

STATUSES = (
    "Exit status: 0 done, also where the load fell or the specimen burst after its peak; 2 input refused, or a file "
    "cannot be written; 3 the run became unstable; 130 stopped by Ctrl-C, 143 by SIGTERM, 129 by SIGHUP, go on "
    "with --resume."
)

QUICK_FRAMES, QUICK_ROWS = 10, 250
"""Frames and history rows of a --quick run: painting and looking would otherwise take longer than solving."""


def parser() -> argparse.ArgumentParser:
    p = argparse.ArgumentParser(
        prog="python -m rsmpm_ti.scene",
        description="Load a rock specimen, break it, and write frames, movie, curve, events and particle data.",
        epilog=STATUSES,
    )
    p.add_argument("scene", nargs="?", help="scene name, or path of a .py or recorded scene.json")
    p.add_argument("--out", metavar="DIR", help="output folder (default renders/<scene>)")
    p.add_argument("--set", dest="settings", action="append", default=[], metavar="NAME=VALUE",
                   help="a keyword of the scene (flaw_length=15mm) or a field of it (schedule.cfl=0.3)")  # fmt: skip
    p.add_argument(
        "--rock", metavar="FILE|NAME", help="another rock for the scene: a sheet (.toml), or a name of --rocks"
    )
    p.add_argument("--quick", action="store_true", help="coarse grid and wider slit")
    p.add_argument("--elastic", action="store_true", help="switch failure off")
    p.add_argument(
        "--frames",
        type=int,
        metavar="N",
        help="frames at equal fractions of the run, the start besides; up to as many more when failures jump",
    )
    p.add_argument("--no-movie", action="store_true", help="frames only")
    p.add_argument("--margin", action="store_true", help="also frames of how near the rock is to failure")
    p.add_argument("--painter", choices=("raster", "ggui"), help="ggui needs Vulkan (a GPU, or Mesa's lavapipe)")
    p.add_argument("--arch", choices=("cpu", "cuda"), default="cpu")
    p.add_argument("--precision", choices=("f64", "f32"), default="f64")
    p.add_argument("--threads", type=int, metavar="N", help="CPU threads (default: all)")
    p.add_argument("--deterministic", action="store_true", help="the same bits with any number of threads")
    p.add_argument(
        "--overwrite",
        action="store_true",
        help="replace the run in --out, kept as DIR.previous until the new one is complete (renders/<scene>: always)",
    )
    p.add_argument("--resume", action="store_true", help="go on from the checkpoint in the output folder")
    p.add_argument("--checkpoint-every", type=float, default=60.0, metavar="S", help="seconds between checkpoints")
    p.add_argument("--list", action="store_true", help="list the scenes and their keywords")
    p.add_argument("--rocks", action="store_true", help="list the rocks of the shelf")
    p.add_argument("--schema", action="store_true", help="print the JSON schema of a scene.json, for editors")
    p.add_argument("--check", action="store_true", help="validate, print what would be run, and stop")
    return p


def build(options: argparse.Namespace, rock: DataSheet | None = None) -> Scene:
    """The scene that the options ask for; rock: in place of that which they name."""
    settings = {}
    for item in options.settings:
        name, separator, value = item.partition("=")
        if not separator or not name.strip():
            raise SceneError(f"--set {shown(item)} is refused: write name=value")
        settings[name.strip()] = value.strip()
    scene = load_scene(
        options.scene, quick=options.quick, settings=settings, rock=options.rock if rock is None else rock
    )
    output = scene.output
    if options.frames is not None or options.quick:
        output = replace(output, frames=QUICK_FRAMES if options.frames is None else options.frames)
    if options.no_movie:
        output = replace(output, movie=False)
    if options.margin:
        output = replace(output, margin=True)
    if options.painter:
        output = replace(output, painter=options.painter)
    schedule = scene.schedule
    if options.quick and "schedule.rows" not in settings:
        schedule = replace(schedule, rows=min(schedule.rows or QUICK_ROWS, QUICK_ROWS))
    scene = replace(scene, output=output, schedule=schedule)
    return scene.elastic() if options.elastic else scene


def describe(scene: Scene, threads: int | None = None, file: Path | None = None, rock: DataSheet | None = None) -> str:
    """What would be run, as `--check` prints it; threads: all by default; file: which the scene is from; rock: the
    sheet of its rock."""
    from rsmpm_ti.run.forecast import disk, size, solving_time

    seeds = scene.particles()
    count = sum(len(body.x) for body in seeds)
    nodes = math.prod(scene.domain.node_counts)
    solver, painter = (held / 1e6 for held in memory(scene, count))
    pictures, files, checkpoints = map(size, disk(scene, count))
    cores = threads or os.cpu_count() or 1
    seconds = solving_time(scene, count, cores)
    rock_lines = [] if rock is None else described(for_scene(rock, scene), scene.domain.dx)
    rows = (
        *([] if file is None else [("file", f"{file}")]),
        ("scene", scene.title),
        *zip(("rock", *len(rock_lines) * [""]), rock_lines, strict=False),
        ("particles", f"{count}"),
        *area(scene, seeds),
        ("grid nodes", f"{nodes} ({scene.domain.grid}), dx = {1e3 * scene.domain.dx:g} mm"),
        ("memory", f"about {solver:.0f} MB to solve, and {painter:.0f} MB to paint and write"),
        ("disk", f"about {pictures} of pictures, {files} of particle files, {checkpoints} for checkpoints"),
        ("method", f"{scene.order}, {type(scene.shape).__name__}, {type(scene.transfer).__name__}"),
        ("dt", f"{scene.dt:.4g} s (mass scaling by time_scale = {scene.time_scale:g})"),
        *expectation(scene),
        ("steps", f"{scene.steps} to t = {1e3 * scene.t_end:.4g} ms{'' if scene.servo is None else SLOWED}"),
        (
            "estimate",
            f"about {max(seconds, 0.1):.1f} s to solve {count * scene.steps / 1e6:.3g} million particle-steps",
        ),
        ("", f"on {cores} cores that are free, by the speed of this one now; start-up and painting besides"),
    )
    return "\n".join(f"{name:<12}{value}" for name, value in rows)


def area(scene: Scene, seeds: list[Seeds]) -> tuple[tuple[str, str], ...]:
    """How far the particles' area is off that of their regions, where it is known."""
    worst = max(area_errors(scene, seeds), key=abs)
    text = f"of a body's particles {round(100.0 * worst, 4) + 0.0:+.2g} % off that of its region, at most"
    return () if math.isnan(worst) else (("area" if scene.dim == 2 else "volume", text),)


SLOWED = " at full speed; more, since a servo slows the platens while rock breaks"


def expectation(scene: Scene) -> tuple[tuple[str, str], ...]:
    """Why 'auto' takes the time scale that it takes; nothing where a number is given."""
    if scene.loading.time_scale != "auto":
        return ()
    found = estimate(scene)
    error = 100.0 * found.error(scene.time_scale)
    wanted = "" if error <= 100.1 * scene.loading.quasi_static else ", more than asked for even at the true density"
    text = f"by first failure, expected at {found.stress / 1e6:.3g} MPa, inertia adds up to {error:.2g} %{wanted}"
    return (("time_scale", text),)


def list_scenes() -> str:
    """Two lines for each scene: what it is, and its keywords with defaults, as --set takes them.

    Files of ./scenes are read and not run: whoever asks for a list has not asked for that.
    """
    lines = []
    for name, path in available().items():
        try:
            what, keywords = about(path) if ships(path) else glance(path)
        except SceneError as error:  # one bad file does not hide the others
            what, keywords = "cannot be listed: " + " ".join(str(error).split()), {}
        lines.append(f"{name:<15} {what}")
        if keywords:
            lines.append(f"{'':<15} {'  '.join(f'{key}={value}' for key, value in keywords.items())}")
    return "\n".join(lines)


@command
def main(arguments: list[str] | None = None) -> int:
    options = parser().parse_args(arguments)
    try:
        if options.list:
            print(list_scenes())
            return 0
        if options.rocks:
            print(list_rocks())
            return 0
        if options.schema:
            print(schema())
            return 0
        if not options.scene:
            raise SceneError(f"name a scene: {', '.join(available())} (or use --list)")
        with warnings.catch_warnings():
            warnings.simplefilter("always", RockWarning)
            warnings.showwarning = lambda message, *_, **__: say(message)
            rock = None if options.rock is None else load_sheet(options.rock)
            scene = build(options, rock)
            if not options.check:
                return run(scene, options)
            from rsmpm_ti.run.forecast import disk_said

            settings_of(options).check(scene)
            print(describe(scene, options.threads, find(options.scene), rock))
            seeds = scene.particles()
            count = sum(len(body.x) for body in seeds)
            for sentence in [*review(scene, seeds), *disk_said(scene, count, folder(options))]:
                say(sentence)
            return 0
    except UnstableRun as error:
        tell(f"rsmpm_ti: the run became unstable: {error}")
        return 3


def settings_of(options: argparse.Namespace):
    """How the options ask for a scene to be run."""
    from rsmpm_ti.run.settings import Settings

    names = ("precision", "arch", "threads", "deterministic", "checkpoint_every")
    return Settings(**{name: getattr(options, name) for name in names})


def folder(options: argparse.Namespace) -> Path:
    """Where a run writes."""
    return Path(options.out) if options.out else Path("renders") / run_name(options.scene)


def say(sentence: object) -> None:
    """A warning, on stderr."""
    tell(f"rsmpm_ti: warning: {' '.join(str(sentence).split())}")


def run(scene: Scene, options: argparse.Namespace) -> int:
    """Run with a progress bar and print what was found."""
    from rich.console import Console
    from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn

    from rsmpm_ti.run.run import simulate

    name, out = run_name(options.scene), folder(options)
    console = Console(file=cast(TextIO, Output(sys.stderr)))  # a terminal may be closed during the run
    console.quiet = not console.is_terminal  # else Rich 13.7 ends even a disabled bar by an empty line
    columns = (TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=console.quiet) as bar:
        task = bar.add_task("compiling", total=1.0)

        def show(p):
            speed = p.particle_steps_per_s / 1e6
            text = (
                f"{1e3 * p.time:.3f} ms  strain {100 * p.strain:.4f} %  {p.stress / 1e6:.3f} MPa  "
                f"failed {p.failed_tension}+{p.failed_shear}  {speed:.1f} M/s"
            )
            bar.update(task, completed=p.fraction, description=text)

        result = simulate(
            scene, out=out, name=name, precision=options.precision, arch=options.arch, threads=options.threads,
            deterministic=options.deterministic, overwrite=options.overwrite or not (options.out or options.resume),
            resume=options.resume, checkpoint_every=options.checkpoint_every, progress=show,
        )  # fmt: skip
    print(report(result))
    print(f"written to {out}")
    return 128 + result.signal if result.signal else 0


def report(result) -> str:
    """A run in a few lines."""
    s = result.summary
    speed = s["particle_steps_per_s"] / 1e6
    lines = [
        f"{s['particles']} particles, {s['steps']} steps: {s['compile_s']:.1f} s of start-up, {s['wall_s']:.1f} s "
        f"of run, {s['painting_s']:.1f} s of it painting; {speed:.1f} M particle-steps/s"
    ]
    # before the numbers that they are about
    lines += [f"warning: {sentence}" for sentence in s["warnings"]]
    if s["onset_stress_Pa"] is not None and s["onset_stress_Pa"] != s["first_failure_stress_Pa"]:
        lines.append(f"strength begins to be lost at {s['onset_stress_Pa'] / 1e6:.3f} MPa; failed: open by half of it")
    if s["first_failure_stress_Pa"] is not None:
        position = ", ".join(f"{1e3 * c:.2f}" for c in s["first_failure_position_m"])
        stress = s["first_failure_stress_Pa"] / 1e6
        lines.append(f"first failure: {s['first_failure_mode']} at {stress:.3f} MPa, ({position}) mm")
    if s["largest_stress_Pa"] is not None:
        counts = f"failed {s['failed_tension']} in tension, {s['failed_shear']} in shear"
        name = "largest stress so far, the load has not fallen after it"
        if s["peak_stress_Pa"] is not None:
            name = f"peak stress: {s['peak_filtered_Pa'] / 1e6:.3f} MPa, as a running median; in one row"
        lines.append(f"{name}: {s['largest_stress_Pa'] / 1e6:.3f} MPa; {counts}")
    angles = [f"{a:.0f}" for a in s["initiation_angles_deg"] if a is not None]
    if angles:
        lines.append(f"cracks leave the flaw at {' and '.join(angles)} degrees from its plane")
    if s["platen_imbalance"] is not None:
        until = "the end" if s["first_failure_stress_Pa"] is None else "first failure"
        lines.append(
            f"up to {until}: platen imbalance {100 * s['platen_imbalance']:.2g} %, "
            f"kinetic over elastic energy {100 * s['kinetic_share']:.2g} %"
        )
    if s["dropped"]:
        lines.append(f"{s['dropped']} particles left the domain with {s['dropped_energy_J']:.3g} J and were dropped")
    if result.signal:
        lines.append(f"stopped early: {result.stopped}; everything up to there is written; go on with --resume")
    elif result.stopped:
        lines.append(result.stopped)
    return "\n".join(lines)


if __name__ == "__main__":
    sys.exit(main())
