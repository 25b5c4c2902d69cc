"""In what order particles meet nodes, and how they may add to them: the one place where threads, CPU and GPU differ.

Particles lie in cell order. A run of particles with the same base node gathers its node sums in locals and adds them
once. One CPU thread takes all particles in turn; of several, each takes a slab of rows and adds without atomics (a
locked compare-exchange costs more than the arithmetic), in an order that keeps neighbours from the rows they share. On
a GPU each thread takes a few neighbouring particles and adds atomically.
"""

import taichi as ti

REACH = 4
"""Rows from a border within which the particles of two slabs share nodes: one more than a stencil is wide. Then it
holds even for particles that have strayed one row since the last sort."""

SPREAD = 512
"""Taichi 1.7.4 runs a CPU range-for of 512 or fewer iterations on one thread, so each slab is given 512."""


FIXED_SLABS = 8
"""Slabs of a deterministic run: whatever the number of threads, sums are taken in one order. More threads are of no
use to it."""


@ti.data_oriented
class Slabs:
    """CPU: slabs of rows along the first axis, of about equally many particles, one for each thread, or a fixed number.

    A slab's first REACH rows are added first, and then it is said that they are; its last ones wait until the next slab
    has added its first. So every node takes its sums in one order. Slabs are begun from the last to the first, so that
    none waits for one that has not been begun: that holds for any number of threads.
    """

    serial = False
    parts = 3  # first rows, most rows, last rows
    stride = block = SPREAD  # only every so many iterations of a loop have work

    def __init__(self, count: int, ordered: bool):
        """ordered: whether other sums, too, are taken in the particles' order, at the cost of one thread."""
        self.count, self.ordered = count, ordered
        self.items = count * SPREAD  # loop iterations
        self.bounds = ti.field(ti.i32, (count, self.parts + 1))  # first particle of each part, and end of the last
        self.ready = ti.field(ti.i32, count)  # ticket of the last pass whose first rows are done
        self._tickets = 0

    def ticket(self, passes: int = 1) -> int:
        """A number that no pass has had, and the following ones if a kernel makes several."""
        self._tickets += passes
        return self._tickets - passes + 1

    @ti.func
    def span(self, t, part, ticket):
        """Particles [start, stop) of a part of loop iteration t, a multiple of `stride`, and the slab, a ledger's slot.

        Returns when they may be added to nodes.
        """
        slab = self._slab(t)
        if part == 2 and slab + 1 < self.count:
            # an atomic, since nothing else makes the compiler look again and again
            seen = ti.atomic_max(self.ready[slab + 1], 0)
            while seen < ticket:
                seen = ti.atomic_max(self.ready[slab + 1], 0)
        return self.bounds[slab, part], self.bounds[slab, part + 1], slab

    @ti.func
    def done(self, t, part, ticket):
        """To be called when the particles of a part have been added."""
        if part == 0:
            ti.atomic_max(self.ready[self._slab(t)], ticket)

    @ti.func
    def _slab(self, t):
        return self.count - 1 - t // SPREAD

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] = field[i] + value

    def refresh(self, first_row) -> None:
        """`first_row`: NumPy base row of every particle that takes part, sorted; those that do not lie behind them."""
        rows = [int(first_row[0])]
        for slab in range(1, self.count):
            fair = int(first_row[len(first_row) * slab // self.count])
            rows.append(max(fair, rows[-1] + 2 * REACH))
        rows.append(max(int(first_row[-1]) + 1, rows[-1] + 2 * REACH))
        parts = [[low, low + REACH, high - REACH, high] for low, high in zip(rows[:-1], rows[1:], strict=True)]
        self.bounds.from_numpy(first_row.searchsorted(parts).astype("int32"))


@ti.data_oriented
class Single:
    """CPU, one thread: everything in turn, on the thread that asks. Waking another one costs 0.1 ms a loop."""

    serial, ordered = True, False
    parts = stride = block = items = count = 1

    def __init__(self, particle_count: int):
        self.stop = ti.field(ti.i32, ())
        self.stop[None] = particle_count

    def ticket(self, passes: int = 1) -> int:
        return 0

    @ti.func
    def span(self, t, part, ticket):
        return 0, self.stop[None], 0  # from a field, so that it is the first one touched: see over_particles

    @ti.func
    def done(self, t, part, ticket):
        pass

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] = field[i] + value

    def refresh(self, first_row) -> None:
        self.stop[None] = len(first_row)


@ti.data_oriented
class Chunks:
    """GPU: every thread takes a few particles that are neighbours in cell order."""

    serial = ordered = False
    parts = stride = 1
    block = 128
    size = 4

    def __init__(self, particle_count: int):
        self.stop = ti.field(ti.i32, ())
        self.stop[None] = particle_count
        self.items = self.count = -(-particle_count // self.size)

    def ticket(self, passes: int = 1) -> int:
        return 0

    @ti.func
    def done(self, t, part, ticket):
        pass

    @ti.func
    def span(self, t, part, ticket):
        return t * self.size, ti.min((t + 1) * self.size, self.stop[None]), t

    @ti.func
    def add(self, field: ti.template(), i, value):
        field[i] += value

    def refresh(self, first_row) -> None:
        self.stop[None] = len(first_row)


@ti.func
def over_particles(
    sim: ti.template(),
    work: ti.template(),
    what: ti.template(),
    dt: ti.template(),
    time: ti.template(),
    ticket: ti.template(),
):
    """Do work(sim, start, stop, slot, what, dt, time) for every span [start, stop) of particles, each on one thread.

    Two things keep the vector instructions of loops in `work`. The span is asked for in the scope that does the work: a
    loop that is the first in its scope to touch a field gets none. And dt, time and ticket are templates: Taichi would
    copy numbers to memory that all threads share, and a loop that reads them there while it writes gets none either.
    """
    ti.loop_config(serialize=sim.traversal.serial, block_dim=sim.traversal.block)
    for t in range(sim.traversal.items):
        if t % sim.traversal.stride == 0:
            for part in range(sim.traversal.parts):
                start, stop, slot = sim.traversal.span(t, part, ticket)
                work(sim, start, stop, slot, what, dt, time)
                sim.traversal.done(t, part, ticket)


def traversal(particle_count: int, gpu: bool, deterministic: bool) -> Slabs | Single | Chunks:
    """The one for the device and the number of threads that Taichi was started with."""
    threads = ti.lang.impl.current_cfg().cpu_max_num_threads
    if gpu:
        return Chunks(particle_count)
    if deterministic:
        return Slabs(FIXED_SLABS, ordered=True)
    return Slabs(threads, ordered=False) if threads > 1 else Single(particle_count)
