"""In what order particles meet nodes, and how they may add to them: the one place where threads, CPU and GPU differ.

Particles lie in cell order. A run of particles with the same base node gathers its node sums in locals and adds them
once. One CPU thread takes all particles in turn. For several, stripes of rows in two colours share no node, so adding
needs no atomics (a locked compare-exchange costs more than the arithmetic). On a GPU each thread takes a few
neighbouring particles and adds atomically.
"""

import taichi as ti

ROWS = 4
"""Rows of base nodes in a stripe. More than a stencil's width, so that stripes of one colour share no node even when
particles have strayed one row since the last sort: (s + 1) ROWS + width - 1 < (s + 2) ROWS - 1."""

SPREAD = 512
"""Taichi 1.7.4 runs a CPU range-for of 512 or fewer iterations on one thread, so each stripe is given 512."""


@ti.data_oriented
class Stripes:
    """CPU: stripes of ROWS rows along the first axis, even ones first, then odd ones."""

    colours = 2
    serial = False
    stride = SPREAD  # only every so many iterations of a loop have work

    def __init__(self, rows: int):
        self.count = -(-rows // ROWS)
        self.items = (self.count // 2 + 1) * SPREAD  # loop iterations over the stripes of one colour
        self.start = ti.field(ti.i32, self.count + 1)  # first particle of each stripe

    @ti.func
    def span(self, t, colour):
        """Particles [start, stop) of loop iteration t over the stripes of one colour, t a multiple of `stride`, and
        the stripe as slot in ledgers."""
        stripe = 2 * (t // SPREAD) + colour
        slot = ti.min(stripe, self.count - 1)
        start, stop = self.start[slot], self.start[slot + 1]
        if stripe >= self.count:
            stop = start
        return start, stop, slot

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] = field[i] + value

    def refresh(self, first_row) -> None:
        """`first_row`: NumPy base row of every particle, sorted."""
        self.start.from_numpy(first_row.searchsorted([ROWS * s for s in range(self.count + 1)]).astype("int32"))


@ti.data_oriented
class Single:
    """CPU, one thread: everything in turn, on the thread that asks. Waking another one costs 0.1 ms a loop."""

    colours = 1
    serial = True
    stride = items = count = 1

    def __init__(self, particle_count: int):
        self.stop = ti.field(ti.i32, ())
        self.stop[None] = particle_count

    @ti.func
    def span(self, t, colour):
        return 0, self.stop[None], 0  # from a field, so that it is the first one touched: see kernels.py

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] = field[i] + value

    def refresh(self, first_row) -> None:
        pass


@ti.data_oriented
class Chunks:
    """GPU: every thread takes a few particles that are neighbours in cell order."""

    colours = 1
    serial = False
    stride = 1
    size = 4

    def __init__(self, particle_count: int):
        self.particle_count = particle_count
        self.items = self.count = -(-particle_count // self.size)

    @ti.func
    def span(self, t, colour):
        return t * self.size, ti.min((t + 1) * self.size, self.particle_count), t

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] += value

    def refresh(self, first_row) -> None:
        pass


def traversal(particle_count: int, rows: int, gpu: bool) -> Stripes | Single | Chunks:
    """The one for the device and number of threads that Taichi was started with. rows: of nodes, along axis 0."""
    if gpu:
        return Chunks(particle_count)
    return Single(particle_count) if ti.lang.impl.current_cfg().cpu_max_num_threads == 1 else Stripes(rows)
