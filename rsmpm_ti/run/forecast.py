"""What a run will take of time and of the disk, told before it starts; for memory see `spec/review/memory.py`.

Time is particles x steps x the time of one particle's step, in units of a loop over numbers that is timed here and now:
how fast a machine does the one says how fast it does the other. It is the solver's alone, on cores that nobody else
uses. Where much cracks a step takes up to a quarter more; what it takes to start and to paint is not in it.
"""

import time
from pathlib import Path

import numpy as np

from rsmpm_ti.fields.particles import stored
from rsmpm_ti.method.shape import Gimp
from rsmpm_ti.spec.review.machine import free_disk
from rsmpm_ti.spec.review.memory import averaging

UNITS = {(2, 2): 17.0, (2, 3): 28.0, (3, 2): 56.0, (3, 3): 123.0}
"""Time of a particle's step over that of the loop's, by dimension and nodes of the shape function per axis."""

GIMP, AFFINE = 1.2, 1.3
"""Factors of GIMP's weights and of an affine transfer."""

BREAKS, NONLOCAL = {2: 2.7, 3: 15.0}, 34.0
"""What the failure check adds, by dimension, and a nonlocal mean with directional cracks; in the same unit."""

THREAD = 0.75
"""What each further thread adds, in units of the first (docs/speed.md)."""

NUMBERS, ROUNDS = 20_000, 10

PICTURE, SHADED, FILMED = 140e3, 200e3, 20e3
"""Bytes of a picture, of one of rock that loses strength little by little, and of a frame of the movie."""

VTU = {2: 85.0, 3: 115.0}
"""Bytes of a particle in a VTU file, packed, by dimension, once the specimen is loaded."""

CHECKPOINTS = 3
"""The latest, the one before, and the next one before it has its name."""

FAILING, PATTERN = 0.1, 24.0
"""Fraction of particles that fail; bytes for each in the pattern of cracks at the largest load, beside 16 an axis."""


def disk(scene, count: int) -> tuple[float, float, float]:
    """Bytes of pictures with the movie, of particle files and of checkpoints; count: particles.

    Pictures at jumps of failures, at most as many again, are not in it.
    """
    output = scene.output
    pictures = 0 if output.frames == 0 else (output.frames + 1) * (2 + output.margin)
    film = FILMED * (output.frames + 1) if output.movie and output.frames else 0.0
    files = 0.0 if output.vtu == 0 else (output.vtu + 1) * VTU[scene.dim] * count
    kept = sum((4.0 if entry.whole else 8.0) * entry.size for entry in stored(scene)) + 4.0
    if scene.breaks:
        kept += PATTERN + 16.0 * scene.dim + FAILING * (8.0 * (4 + scene.dim) + 8.0)
    picture = SHADED if any(averaging(scene)) else PICTURE
    return picture * pictures + film, files, CHECKPOINTS * kept * count


def disk_said(scene, count: int, out) -> list[str]:
    """A sentence where the disk of a folder has less than a run will take. count: particles."""
    needed, free = sum(disk(scene, count)), free_disk(Path(out))
    if needed <= free:
        return []
    return [
        f"the run will write about {size(needed)} to {out}, whose disk has {size(free)} left; make room, give another "
        f"folder with --out, or take fewer --frames and a smaller output.vtu"
    ]


def size(count: float) -> str:
    """Bytes in the unit that people would take."""
    return f"{count / 1e9:.3g} GB" if count >= 1e9 else f"{count / 1e6:.3g} MB"


def particle_step(scene) -> float:
    """Time of one particle's step, in units of `unit`."""
    width = min(max(scene.shape.width, 2), 3)
    cost = UNITS[scene.dim, width] * (GIMP if isinstance(scene.shape, Gimp) else 1.0)
    cost *= AFFINE if scene.transfer.affine else 1.0
    if scene.breaks:
        cost += BREAKS[scene.dim] + NONLOCAL * sum(averaging(scene))
    return cost


def unit() -> float:
    """Processor time of the loop's step for one number [s]: six operations of arithmetic and a root."""
    a = np.linspace(0.1, 0.9, NUMBERS)
    best = np.inf
    for _ in range(ROUNDS):
        start = time.process_time()
        for _ in range(20):
            b = a * a
            b += a
            b *= a
            b += 0.5
            np.sqrt(b, out=b)
            b /= a
        best = min(best, time.process_time() - start)
    return best / (20 * NUMBERS)


def solving_time(scene, count: int, threads: int) -> float:
    """Of the solver, on so many threads [s]."""
    return count * scene.steps * particle_step(scene) * unit() / (1.0 + THREAD * (threads - 1))
