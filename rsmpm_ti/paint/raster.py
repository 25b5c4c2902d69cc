"""The painter that needs no display and no graphics driver: Taichi kernels splat particles onto a panel of pixels.

A pixel averages the *values* of the rock it sees, weighted by area, and only then looks up a colour: averaging colours
would show hues that stand for no value. Sums are integers, so their order does not matter and equal input gives equal
pictures with any number of threads.
"""

import numpy as np
import taichi as ti

from rsmpm_ti.paint.palette import INFLATE, Palette, View, squares_in_view

UNIT = 1024
"""Fixed-point one, for areas in pixels and for values in limits."""

GAP = 1.75
"""Widest sliver, in particle spacings, that is closed: jitter of 0.35 opens up to 1.7, and a flaw is 4 at the least."""

VALUE_RANGE = 4.0
"""Values are clipped to this many limits before they are averaged: one wild particle must not colour its neighbours."""


class Raster:
    """Paints particles as axis-parallel squares of their own size, antialiased by exact area."""

    def __init__(self, view: View, palette: Palette):
        """Allocates fields, so `ti.init` must have been called, and a later one ends this painter's life."""
        self.view = view
        self.palette = palette
        self.skipped = 0  # particles of the last image that had no finite position, size or value
        self._table = palette.table()
        self._area = ti.field(ti.i32, shape=(3, view.height, view.width))
        self._cover = ti.field(ti.i32, shape=(view.height, view.width))
        self._value = ti.field(ti.i64, shape=(view.height, view.width))
        self._side = ti.field(ti.i64, shape=(view.height, view.width)) if palette.folded else self._value

    def image(self, x: np.ndarray, half: np.ndarray, mode: np.ndarray, value: np.ndarray | None = None) -> np.ndarray:
        """The panel, uint8 [height, width, 3], first row on top.

        x: positions [m], [n, 2 or 3]; half: half sides [m], [n] or one number; mode: INTACT, TENSION or SHEAR, [n];
        value: what the palette's ramp shows, [n] (none needed where the ramp has a single colour).
        """
        squares, self.skipped = squares_in_view(self.view, self.palette.limit, x, half, mode, value)
        fixed = np.rint(np.clip(squares.value, -VALUE_RANGE, VALUE_RANGE) * UNIT).astype(np.int32)
        spacing = 2.0 * float(np.median(squares.half)) / INFLATE if len(fixed) else 0.0
        image = np.empty((self.view.height, self.view.width, 3), dtype=np.uint8)
        sums, folded = (self._area, self._value, self._side), self.palette.folded
        clear(*sums)
        splat(*sums, folded, squares.column, squares.row, squares.half, fixed, squares.mode)
        add_modes(self._area, self._cover)
        gap = round(GAP * spacing)
        resolve(*sums, self._cover, folded, self._table, self.palette.marks(), gap, image)
        return image

    def close(self) -> None:
        """Nothing to give back: fields live until the next `ti.init`. Here so that painters are interchangeable."""


@ti.kernel
def clear(area: ti.template(), value: ti.template(), side: ti.template()):
    """One pass: `fill` takes one for each field, and 13 ms where this takes 2."""
    for i, j in ti.ndrange(*value.shape):
        for mode in ti.static(range(3)):
            area[mode, i, j] = 0
        value[i, j] = 0
        side[i, j] = 0


@ti.kernel
def splat(
    area: ti.template(),
    value: ti.template(),
    side: ti.template(),
    folded: ti.template(),
    column: ti.types.ndarray(dtype=ti.f32, ndim=1),
    row: ti.types.ndarray(dtype=ti.f32, ndim=1),
    half: ti.types.ndarray(dtype=ti.f32, ndim=1),
    p_value: ti.types.ndarray(dtype=ti.i32, ndim=1),
    p_mode: ti.types.ndarray(dtype=ti.i32, ndim=1),
):
    """Adds to each pixel the area of each square in it, by mode, and area times value of the intact ones.

    What failed particles carry is hidden under the colour of their mode, so it is kept out of the average. `folded`:
    `value` gets sizes and `side` signed values.
    """
    for p in range(column.shape[0]):
        left, right = column[p] - half[p], column[p] + half[p]
        top, bottom = row[p] - half[p], row[p] + half[p]
        for i in range(ti.max(0, int(ti.floor(top))), ti.min(value.shape[0], int(ti.ceil(bottom)))):
            overlap = ti.min(bottom, i + 1) - ti.max(top, i)
            for j in range(ti.max(0, int(ti.floor(left))), ti.min(value.shape[1], int(ti.ceil(right)))):
                a = ti.round(overlap * (ti.min(right, j + 1) - ti.max(left, j)) * UNIT, ti.i32)
                area[p_mode[p], i, j] += a
                if p_mode[p] == 0:
                    if ti.static(folded):
                        side[i, j] += ti.cast(a, ti.i64) * p_value[p]
                        value[i, j] += ti.cast(a, ti.i64) * ti.abs(p_value[p])
                    else:
                        value[i, j] += ti.cast(a, ti.i64) * p_value[p]


@ti.kernel
def add_modes(area: ti.template(), cover: ti.template()):
    """Area of each pixel that squares of any mode cover."""
    for i, j in ti.ndrange(*cover.shape):
        cover[i, j] = area[0, i, j] + area[1, i, j] + area[2, i, j]


@ti.func
def reach(cover, i, j, di, dj, gap):
    """Pixels from (i, j) in direction (di, dj) to the first that is mostly rock; gap + 1 where none is within gap."""
    steps = gap + 1
    s = 1
    while s < steps:
        k, m = i + s * di, j + s * dj
        if k < 0 or k >= cover.shape[0] or m < 0 or m >= cover.shape[1]:
            s = steps
        elif 2 * cover[k, m] >= UNIT:
            steps = s
        s += 1
    return steps


@ti.func
def level(area: ti.template(), value: ti.template(), side: ti.template(), folded: ti.template(), levels, k, m):
    """Where the table of `levels` colours shows what the intact rock of pixel (k, m) carries in the mean."""
    mean = ti.cast(value[k, m], ti.f32) / (ti.cast(ti.max(1, area[0, k, m]), ti.f32) * UNIT)
    if ti.static(folded):
        mean = ti.select(side[k, m] < 0, -mean, mean)
    position = (ti.min(ti.f32(1.0), ti.max(ti.f32(-1.0), mean)) + 1.0) * (ti.f32(0.5) * (levels - 1))
    return ti.cast(position + 0.5, ti.i32)


@ti.kernel
def resolve(
    area: ti.template(),
    value: ti.template(),
    side: ti.template(),
    cover: ti.template(),
    folded: ti.template(),
    table: ti.types.ndarray(dtype=ti.u8, ndim=2),
    marks: ti.types.ndarray(dtype=ti.f32, ndim=2),
    gap: ti.i32,
    image: ti.types.ndarray(dtype=ti.u8, ndim=3),
):
    """Turns sums into colours: failed particles lie on top of intact ones, the rest of a pixel's area is void.

    Between particles that were seeded with jitter there are slivers that no square covers. A pixel with rock on both
    sides, at most `gap` pixels apart, belongs to the rock and takes the nearer side's colour.
    """
    one = ti.f32(1.0)
    for i in range(cover.shape[0]):
        for j in range(cover.shape[1]):
            k, m = i, j
            rock = ti.cast(ti.min(cover[i, j], UNIT), ti.f32) / UNIT
            if 0 < gap and cover[i, j] < UNIT:
                line = 0  # along the row, along the column, along both diagonals, until rock is found on both sides
                while line < 4:
                    di, dj = ti.min(1, line), (1 - line if line < 2 else 5 - 2 * line)
                    widest = gap if line < 2 else gap * 5 // 7  # a diagonal step is longer
                    before = reach(cover, i, j, -di, -dj, widest)
                    if before <= widest:  # else no rock on one side: most of the void around the specimen
                        after = reach(cover, i, j, di, dj, widest + 1 - before)
                        if before + after - 1 <= widest:
                            rock = one
                            line = 4
                            if 4 * cover[i, j] < UNIT:
                                step = after if after < before else -before
                                k, m = i + step * di, j + step * dj
                    line += 1
            if rock == 0.0:
                for c in ti.static(range(3)):
                    image[i, j, c] = ti.cast(ti.cast(marks[0, c], ti.i32), ti.u8)
            else:
                at = level(area, value, side, folded, table.shape[0], k, m)
                if rock == 1.0 and area[0, k, m] == cover[k, m]:  # most pixels: nothing but intact rock
                    for c in ti.static(range(3)):
                        image[i, j, c] = table[at, c]
                else:
                    full = ti.cast(ti.max(1, ti.min(cover[k, m], UNIT)), ti.f32)
                    tension = ti.min(one, area[1, k, m] / full)
                    shear = ti.min(one - tension, area[2, k, m] / full)
                    for c in ti.static(range(3)):
                        colour = tension * marks[1, c] + shear * marks[2, c] + (one - tension - shear) * table[at, c]
                        image[i, j, c] = ti.cast(ti.round(rock * colour + (one - rock) * marks[0, c], ti.i32), ti.u8)
