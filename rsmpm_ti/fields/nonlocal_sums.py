"""Node fields by which stress, crack strain and slip are averaged over a length of the rock."""

import math

import numpy as np
import taichi as ti

from rsmpm_ti.fields.grid import Grid
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.scene import Scene

TILE = 8
"""Nodes along the edge of a tile, the piece of the grid that is averaged or skipped as a whole."""

MAX_NEW_CRACKS = 4096
"""Most particles that crack by mean stress in one step; the others wait for the next."""


@ti.data_oriented
class NonlocalSums:
    """Node fields of averages: sums of V sigma, V, V x crack strain and V x slip, a second copy for blurring, and
    the largest overload. Of one rock of a scene, over which alone is averaged."""

    def __init__(self, scene: Scene, rock: Rock, grid: Grid, real):
        filter_weights = rock.nonlocal_mean.filter_weights(scene.domain.dx, scene.shape.variance)
        self.reach, self.filter_weights = len(filter_weights) // 2, ti.field(real, len(filter_weights))
        self.filter_weights.from_numpy(np.array(filter_weights))
        self.sums, self.other = (ti.Vector.field(7, real, grid.nodes) for _ in range(2))
        self.peak, self.overloaded = ti.field(real, grid.nodes), ti.field(ti.i32, grid.nodes)
        # what a look needs of each tile: see `needed_tiles` in failure/nonlocal_fields.py
        tiles = tuple(-(-n // TILE) for n in grid.nodes)
        self.hot, self.needed, self.any_hot = ti.field(ti.i32, tiles), ti.field(ti.i32, tiles), ti.field(ti.i32, ())
        width = scene.shape.width - 1
        # from a hot particle's tile to all whose means it is part of, and from those to all that they take them from
        self.result_tiles = -(-(self.reach + 2 * width) // TILE)
        self.source_tiles = -(-(self.reach + width) // TILE)
        band = scene.shape.crack_band * scene.domain.dx
        self.band_fraction = rock.nonlocal_mean.band_fraction(band)
        self.variance = rock.nonlocal_mean.band_variance(band)
        # smallest tensile strength of a particle [Pa], and steps between two looks: the mean over a length cannot
        # change within a quarter of the time that a wave needs for it
        self.weakest = rock.criterion.tensile_strength
        travel = rock.wave_speed(scene.time_scale) * scene.dt
        self.interval = max(1, math.floor(0.25 * rock.nonlocal_mean.length / travel))
        # cracks that have begun at this look: how many, position and normal
        self.count = ti.field(ti.i32, ())
        self.x, self.normal = (ti.Vector.field(2, real, MAX_NEW_CRACKS) for _ in range(2))
