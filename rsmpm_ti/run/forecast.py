"""What a run will take of time and of the disk, told before it starts; for memory see `spec/review/memory.py`.

Time is particles x steps x the time of one particle's step, in units of a loop over numbers that is timed here and now:
how fast a machine does the one says how fast it does the other. It is the solver's alone, on cores that nobody else
uses. Where much cracks a step takes up to a quarter more; what it takes to start and to paint is not in it.
"""

import time

import numpy as np

from rsmpm_ti.method.shape import Gimp

UNITS = {(2, 2): 17.0, (2, 3): 28.0, (3, 2): 56.0, (3, 3): 123.0}
"""Time of a particle's step over that of the loop's, by dimension and nodes of the shape function per axis."""

GIMP, AFFINE = 1.2, 1.3
"""Factors of GIMP's weights and of an affine transfer."""

BREAKS, NONLOCAL = {2: 2.7, 3: 15.0}, 34.0
"""What the failure check adds, by dimension, and a nonlocal mean with directional cracks; in the same unit."""

THREAD = 0.75
"""What each further thread adds, in units of the first (docs/speed.md)."""

NUMBERS, ROUNDS = 20_000, 10


def particle_step(scene) -> float:
    """Time of one particle's step, in units of `unit`."""
    rock, width = scene.rock, min(max(scene.shape.width, 2), 3)
    cost = UNITS[scene.dim, width] * (GIMP if isinstance(scene.shape, Gimp) else 1.0)
    cost *= AFFINE if scene.transfer.affine else 1.0
    if rock.criterion.breaks:
        cost += BREAKS[scene.dim] + NONLOCAL * rock.nonlocal_mean.acts
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
