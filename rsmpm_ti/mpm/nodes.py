"""What is done to nodes alone: clear them, turn momentum into velocity, add forces, apply boundaries.

v_i = (m v)_i / m_i                                   (paper eq. 7)
v_i <- v_i + dt (f_i / m_i + b)                       (momentum equation, paper eq. 2 and 5, on the nodes)
"""

import taichi as ti

from rsmpm_ti.fields.nodes import SMALL_MASS
from rsmpm_ti.mpm.contact import clear_gaps, keep_state, kept_state, squeeze, touching
from rsmpm_ti.mpm.holes.press import book_walls
from rsmpm_ti.mpm.wall_nodes import extend, fold


@ti.func
def over_nodes(sim: ti.template(), work: ti.template(), dt: ti.template(), factor: ti.template()):
    """Do work(sim, i, dt, factor) for every node, dense or sparse."""
    # a loop over a field always wakes the threads, one over numbers need not; but a sparse grid must be asked for its
    # nodes
    if ti.static(sim.nodes.sparse):
        for i in ti.grouped(sim.nodes.mass):
            work(sim, i, dt, factor)
    else:
        ti.loop_config(serialize=sim.nodes.serial)
        for i in ti.grouped(ti.ndrange(*sim.grid.nodes)):
            work(sim, i, dt, factor)


@ti.func
def full_cell(sim: ti.template()):
    """Mass of a cell full of rock [kg]."""
    return sim.density * sim.grid.dx**sim.dim


@ti.func
def clear_node(sim: ti.template(), i, dt, factor):
    sim.nodes.mass[i] = 0.0
    sim.nodes.v[i] = ti.Vector.zero(float, sim.dim)
    sim.nodes.f[i] = ti.Vector.zero(float, sim.dim)


@ti.kernel
def clear_nodes(sim: ti.template()):
    clear_gaps(sim)
    over_nodes(sim, clear_node, 0.0, 0.0)


@ti.func
def speed_of(sim: ti.template(), b: ti.template(), factor):
    """Of a boundary along its axis, now [m/s]."""
    speed = sim.boundaries[b].speed * factor
    if ti.static(sim.grid.settles):
        speed *= ti.cast(sim.grid.pace[None], float)
    for held in ti.static(sim.grid.held):
        if ti.static(held.boundary == b):
            speed = ti.cast(sim.grid.velocity[held.axis, held.side], float)
    return speed


@ti.func
def held_by(sim: ti.template(), boundary: ti.template(), i):
    """Whether a boundary holds node i.

    On a turned grid it is a platen that presses by its position, where it is now, and holds all nodes that lie so near
    to it that their rock is not all there (`Domain.pressed`): every free node then is in balance in uniform stress.
    """
    x = sim.grid.label(i)
    if ti.static(sim.grid.turned):
        axis = ti.static(boundary.axis)
        if ti.static(boundary.side == "upper"):
            x[axis] += sim.grid.pressed - ti.cast(sim.grid.travel[axis, 1], float)
        else:
            x[axis] -= sim.grid.pressed + ti.cast(sim.grid.travel[axis, 0], float)
    return boundary.holds(x, sim.grid.dx)


@ti.func
def node_speed(sim: ti.template(), b: ti.template(), i, factor):
    """Speed along its axis at which a boundary holds node i [m/s]: its own.

    On a turned grid that of uniform straining between both platens, which it is at the platen itself.
    """
    speed = speed_of(sim, b, factor)
    if ti.static(sim.grid.turned):
        axis, other = ti.static(sim.boundaries[b].axis, 1 - b)
        way = ti.static(sim.boundaries[other].position - sim.boundaries[b].position)
        side = ti.static(1 if sim.boundaries[b].side == "upper" else 0)
        gone, far = sim.grid.travel[axis, side], sim.grid.travel[axis, 1 - side]
        rate = (speed_of(sim, other, factor) - speed) / (way + ti.cast(far - gone, float))
        speed += rate * (sim.grid.label(i)[axis] - sim.boundaries[b].position - ti.cast(gone, float))
    return speed


@ti.func
def hold(sim: ti.template(), i, v, factor, before: ti.template()):
    """Velocity mapped apart from force, after every boundary that holds the node: as the node was held last.

    before: at the boundaries' speeds of the step before.
    """
    held = v
    for b, boundary in ti.static(enumerate(sim.boundaries)):
        if held_by(sim, boundary, i):
            speed = node_speed(sim, b, i, factor)
            if ti.static(before):
                speed += 2.0 * ti.cast(sim.ledger.mean_speed[b] - sim.ledger.speed[b], float)
            held = boundary.keep(held, speed, factor, kept_state(sim, b, i))
    return held


@ti.func
def may_be_held(sim: ti.template(), i):
    """Whether node i lies where a boundary acts."""
    found = False
    for boundary in ti.static(sim.boundaries):
        found = found or held_by(sim, boundary, i)
    return found


@ti.func
def missing(sim: ti.template(), i, v, factor):
    """Velocity that a node lacks to go as it was held in the step before [m/s], by what it does now."""
    return hold(sim, i, v, factor, True) - v


@ti.func
def book_stopping(sim: ti.template(), i, v_new, dv, momentum, u, dt, factor):
    """Energy that boundaries take from a node of musl by stopping what particles bring to it.

    Particles bring v to it before a step and r after it, and gain m dv.(v + r)/2. Stress works on u, which is r as the
    node is held, boundaries on the mean of u and the u before. What is left, with a = u_before - v and a' = u - r, is

        m dv.(a + a')/2 = m |a + a'|^2/4 + m (dv - a).(a + a')/2 + m (a^2 - a'^2)/4.

    The first is lost, as in an inelastic impact; the second comes of a platen that changes its speed; of the third,
    m a'^2/4 is given back in the next step. So the sum and that are dissipated. A uniform body force loses nothing.
    """
    m = sim.nodes.mass[i]
    if m > SMALL_MASS * full_cell(sim):
        a, rest = missing(sim, i, v_new - dv, factor), u - 1.0 / m * momentum
        lost = 0.5 * m * (dv - dt * ti.Vector(sim.acceleration)).dot(a + rest)
        sim.ledger.stopped[0] += ti.cast(lost, ti.f64)
        sim.ledger.stopped[1] += ti.cast(0.25 * m * rest.dot(rest), ti.f64)


@ti.func
def velocity_of(sim: ti.template(), i, momentum, factor):
    """v_i = (mv)_i / m_i and boundaries, for momentum that is mapped apart from force."""
    m = sim.nodes.mass[i]
    v = ti.Vector.zero(float, sim.dim)
    if m > SMALL_MASS * full_cell(sim):
        v = hold(sim, i, 1.0 / m * momentum, factor, False)
    return v


@ti.func
def velocity_from_momentum(sim: ti.template(), i, dt, factor):
    sim.nodes.v[i] = velocity_of(sim, i, sim.nodes.v[i], factor)


@ti.kernel
def momentum_to_velocity(sim: ti.template(), factor: float):
    """usf: velocity where momentum was."""
    fold(sim.nodes.momentum_columns, sim.grid.walls)
    over_nodes(sim, velocity_from_momentum, 0.0, factor)
    extend(sim.nodes.v_columns, sim.grid.walls)


@ti.func
def over_mass(v, inverse):
    """Velocity of a node whose v holds momentum."""
    return v * inverse


@ti.func
def as_it_is(v, inverse):
    """Velocity of a node whose v holds it already."""
    return v


@ti.func
def absorbed(sim: ti.template(), boundary: ti.template(), v, dt):
    """Velocity of a node of a plane that waves leave by: it holds the mass m = share rho dx A of the rock before it."""
    cells = dt / (sim.contacts.share * sim.grid.dx)
    shear_speed = ti.sqrt(sim.rock.elasticity.mu / sim.density)
    return boundary.absorb(v, cells * sim.wave_speed, cells * shear_speed)


@ti.func
def accelerate(sim: ti.template(), i, velocity: ti.template(), dt, factor):
    """v_i <- v_i + dt (f_i/m_i + b), then boundaries, whose impulses and work go to the ledger.

    f takes the velocity change of the step. `velocity`: one of the two above.
    """
    nodes, ledger = sim.nodes, sim.ledger
    m = nodes.mass[i]
    v, dv = ti.Vector.zero(float, sim.dim), ti.Vector.zero(float, sim.dim)
    if m > SMALL_MASS * full_cell(sim):
        inverse = 1.0 / m
        v_old = velocity(nodes.v[i], inverse)
        v = v_old
        if m > nodes.pushed_mass * full_cell(sim):
            v += dt * inverse * nodes.f[i]
        v += dt * ti.Vector(sim.acceleration)
        books, before = False, 0.0 * v
        if ti.static(nodes.books_stopping):
            books = may_be_held(sim, i)
            if books:
                before = missing(sim, i, v_old, factor)
        for b, boundary in ti.static(enumerate(sim.boundaries)):
            if held_by(sim, boundary, i):
                held, state = v, 0
                if touching(sim, b, i):
                    held, state = boundary.project(v, node_speed(sim, b, i, factor), factor, squeeze(sim, dt))
                during = held
                if ti.static(b in sim.absorbing):
                    held = absorbed(sim, boundary, v, dt)
                    during = 0.5 * (held + v_old)
                keep_state(sim, b, i, state)
                impulse = ti.cast(m * (held - v), ti.f64)
                work = impulse.dot(ti.cast(during, ti.f64))
                ledger.impulse[b] += impulse
                ledger.work[b] += work + impulse[boundary.axis] * (ledger.mean_speed[b] - ledger.speed[b])
                ledger.latest[b] += work
                v = held
        if books:
            # where a node begins or ends to be held, stress has worked on what it did before
            change = missing(sim, i, v_old, factor) - before
            ledger.stopped[0] -= ti.cast(0.5 * dt * nodes.f[i].dot(change), ti.f64)
        dv = v - v_old
    nodes.v[i] = v
    nodes.f[i] = dv


@ti.func
def update_node(sim: ti.template(), i, dt, factor):
    accelerate(sim, i, over_mass, dt, factor)


@ti.func
def update_node_and_clear(sim: ti.template(), i, dt, factor):
    """And clear v_remapped for the momentum that comes back from the particles."""
    update_node(sim, i, dt, factor)
    sim.nodes.v_remapped[i] = ti.Vector.zero(float, sim.dim)


@ti.func
def update_moving_node(sim: ti.template(), i, dt, factor):
    accelerate(sim, i, as_it_is, dt, factor)


@ti.func
def new_velocity(
    sim: ti.template(), update: ti.template(), sums: ti.template(), dt: ti.template(), factor: ti.template()
):
    """Velocity of all nodes at the step's end, by one of the updates above; `sums`: what lies beside f at walls."""
    for _ in range(1):
        sim.ledger.stopped[1] = 0.0
    for b in ti.static(range(len(sim.boundaries))):
        now = ti.cast(speed_of(sim, b, factor), ti.f64)
        sim.ledger.latest[b] = 0.0
        sim.ledger.mean_speed[b] = 0.5 * (sim.ledger.speed[b] + now)
        sim.ledger.speed[b] = now
    fold(sums, sim.grid.walls)
    fold(sim.nodes.f_columns, sim.grid.walls)
    over_nodes(sim, update, dt, factor)
    extend(sim.nodes.v_columns, sim.grid.walls)
    extend(sim.nodes.f_columns, sim.grid.walls)
    book_walls(sim, dt)


@ti.kernel
def move_grid(sim: ti.template(), dt: float, factor: float):
    """To where platens are after a step. Not for musl, which begins the next step in this one's last pass."""
    for _ in range(1):
        sim.grid.move(dt, factor)
        sim.grid.push(sim.ledger.impulse, dt, factor)
        sim.grid.settle()


@ti.kernel
def update_nodes(sim: ti.template(), dt: float, factor: float):
    """Momentum and force become velocity and its change."""
    new_velocity(sim, update_node, sim.nodes.momentum_columns, dt, factor)


@ti.kernel
def update_moving_nodes(sim: ti.template(), dt: float, factor: float):
    """usf: force becomes velocity change; velocity is there."""
    new_velocity(sim, update_moving_node, (), dt, factor)
