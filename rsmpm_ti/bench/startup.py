"""`bench start`: seconds from starting Python to the end of a scene's first step, without and with kept kernels."""

import json
import os
import subprocess
import tempfile
import time

from rsmpm_ti.process import python_command

CHILD = """
import json, sys, time
begun = float(sys.argv[1])
times = {"python": time.time() - begun}
from rsmpm_ti.backend.start import start_taichi
from rsmpm_ti.spec.loader import load_scene
scene = load_scene(sys.argv[2], quick=sys.argv[3] == "quick")
seeds = scene.particles()
times["scene"] = time.time() - begun
real, _ = start_taichi("f64", "cpu", int(sys.argv[4]))
from rsmpm_ti.solver.advance import Drive
import taichi as ti
times["taichi"] = time.time() - begun
drive = Drive(scene, seeds, real)
times["fields"] = time.time() - begun
drive.advance(1)
ti.sync()
times["first step"] = time.time() - begun
print(json.dumps(times))
"""


def start(scene: str, quick: bool, threads: int, rounds: int) -> str:
    """Seconds at which each stage ends: the first run compiles every kernel, the others find them kept."""
    lines = []
    with tempfile.TemporaryDirectory() as cache:
        for k in range(rounds + 1):
            environment = os.environ | {"TI_OFFLINE_CACHE_FILE_PATH": cache, "ENABLE_TAICHI_HEADER_PRINT": "0"}
            command = python_command(CHILD, repr(time.time()), scene, "quick" if quick else "full", str(threads))
            done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
            times = json.loads(done.stdout.splitlines()[-1])
            lines.append(
                f"{'cold' if k == 0 else 'warm'}: " + ", ".join(f"{n} {t:.2f}" for n, t in times.items()) + " s"
            )
    return "\n".join(lines)
