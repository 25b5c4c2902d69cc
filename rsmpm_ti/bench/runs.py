"""`bench runs`: whole runs of a scene by the command line, in turn: what pictures and determinism cost."""

import json
import subprocess
import tempfile
import time
from pathlib import Path
from statistics import median

from rsmpm_ti.process import python_command

NO_PICTURES = ("--frames", "0", "--no-movie", "--set", "output.vtu=0")
VARIANTS = {
    "as it is": (),
    "no frames, movie, VTU": NO_PICTURES,
    "the same, deterministic": (*NO_PICTURES, "--deterministic"),
    "the same, one thread": (*NO_PICTURES, "--threads", "1"),
}


def one(scene: str, options: list[str]) -> dict[str, float]:
    """Seconds of one run, from starting Python to the last file."""
    with tempfile.TemporaryDirectory() as out:
        command = python_command("from rsmpm_ti.scene import main; sys.exit(main())", scene, *options, "--out", out)
        start = time.perf_counter()
        subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
        total = time.perf_counter() - start
        summary = json.loads((Path(out) / "summary.json").read_text())
    names = {"run": "wall_s", "start-up": "compile_s", "waited for output": "painting_s", "painter": "painting_cpu_s"}
    return {"total": total} | {name: summary[key] for name, key in names.items()}


def runs(scene: str, quick: bool, rounds: int) -> str:
    """Medians over rounds [s], and the run's ratio to the one without pictures in the same round: median, min, max."""
    base, seen = ["--quick"] if quick else [], {variant: [] for variant in VARIANTS}
    for _ in range(rounds):
        for variant, options in VARIANTS.items():
            seen[variant].append(one(scene, [*base, *options]))
    columns = list(seen["as it is"][0])
    lines = [f"{scene}, {rounds} rounds in turn, seconds", f"{'':<24}" + "".join(f"{c:>19}" for c in columns)]
    lines[1] += "   run over no pictures"
    for variant, found in seen.items():
        medians = "".join(f"{median(f[c] for f in found):>19.1f}" for c in columns)
        ratios = [f["run"] / g["run"] for f, g in zip(found, seen["no frames, movie, VTU"], strict=True)]
        lines.append(f"{variant:<24}{medians}   {median(ratios):.2f} ({min(ratios):.2f}-{max(ratios):.2f})")
    return "\n".join(lines)
