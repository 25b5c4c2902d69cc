"""Bodies at rest under their own weight, which no platen can press slowly: kinetic damping, a column, a cantilever."""

import math

import numpy as np
from scipy.integrate import solve_bvp

from rsmpm_ti.cases.case import Case, Outcome, at_most, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.method.transfer import Apic, PicFlip
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.boundaries import Fixed, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.load_cell import LoadCell
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.elastic.bodies import elastic

GRAVITY = 9.81


def stop(drive: Drive) -> None:
    """Take all velocity from the particles, the affine one too."""
    particles = drive.sim.particles
    particles.v.fill(0.0)
    if particles.affine:
        particles.C.fill(0.0)


def relax(drive: Drive, look: int, least: float) -> list[tuple[float, float]]:
    """Let a body move and stop it whenever its kinetic energy has passed a peak: there it is near its equilibrium.

    Cundall (1976); Barnes (1999), Int. J. Space Struct. 14:89. This damps the slow modes; the transfer must damp the
    fast ones. FLIP does not: stops then feed it, and the state wanders off. Use Apic; where no particle leaves its
    cell, a PicFlip below 1 will do.

    look: steps between looks, about a hundredth of the slowest period. Ends when a peak is less than `least` of the
    first, or with the schedule. Returned is the history of (time [s], kinetic energy [J]).
    """
    history, first = [(drive.clock.time, 0.0)], 0.0
    while not drive.clock.done:
        drive.advance(look)
        before, now = history[-1][1], drive.survey.kinetic
        if now < before:
            stop(drive)
            first, now = first or before, 0.0
        history.append((drive.clock.time, now))
        if now == 0.0 and before < least * first:
            break
    return history


def self_weight(full: bool) -> Outcome:
    """A confined column under gravity: sigma_yy = -rho g (H - y), top at -rho g H^2/(2 (lambda + 2 mu))."""
    height, cells = 0.1, 40 if full else 20
    dx = height / cells
    sides = (Wall(axis=0, side="lower", position=0.0), Wall(axis=0, side="upper", position=2.0 * dx))
    E, nu, density = 17e9, 0.14, 2600.0
    rock = elastic(E, nu, density)
    period = 4.0 * height / rock.wave_speed()
    scene = Scene(
        title="column",
        domain=Domain(lower=(0.0, 0.0), upper=(2.0 * dx, height), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(2.0 * dx, height))),),
        rock=rock,
        loading=Loading(boundaries=(Wall(axis=1, side="lower", position=0.0), *sides), body_force=(0.0, -GRAVITY)),
        schedule=Schedule(t_end=20.0 * period, cfl=0.5),
        shape=Linear(),
        transfer=PicFlip(flip=0.99),
    )
    drive = set_up(scene)
    history = relax(drive, round(period / scene.dt / 40.0), 1e-8)
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    impulse, base = drive.survey.impulse, density * GRAVITY * height
    drive.advance(round(period / scene.dt))
    forces = (drive.survey.impulse - impulse) / (drive.clock.time - snapshot.time)
    reaction = LoadCell(axis=1, lower=(0,), upper=(), width=2.0 * dx).read(forces).stress_lower
    y = snapshot.x[:, 1] - snapshot.displacement[:, 1]
    sigma, exact = snapshot.sigma[:, 1, 1], -base * (1.0 - y / height)
    cell = np.floor(y / dx).astype(int)
    in_cells = (np.bincount(cell, sigma - exact) / np.bincount(cell)) / base
    sunk = -base * (y - 0.5 * y**2 / height) * (1.0 + nu) * (1.0 - 2.0 * nu) / (E * (1.0 - nu))
    off = np.abs(snapshot.displacement[:, 1] - sunk).max() / np.abs(sunk).max()
    top = np.argmax(y)
    still = "what still swings has 1e-8 of the first kinetic energy, 1e-4 of the displacement, more in short waves"
    rows = (
        at_most("stress, mean of a cell, over rho g H", np.abs(in_cells).max(), 1e-3, still),
        at_most(
            "stress of particles, over rho g H",
            np.abs(sigma - exact).max() / base,
            0.25 / cells + 1e-3,
            "linear functions: one stress in a cell, so particles are a quarter of a cell off",
        ),
        relative("displacement of the top", sunk[top], snapshot.displacement[top, 1], 1e-3, still),
        at_most("displacement over the top's", off, 1e-3, "linear between nodes: 3/16 (dx/H)^2 = 5e-4, and the swing"),
        relative("reaction of the base [Pa]", base, reaction, 1e-3, "momentum; mean over a period of the swing"),
    )

    def draw(figure):
        stress, energy = figure.subplots(1, 2)
        stress.plot(1e-3 * sigma, 1e3 * y, ".", label="particles")
        stress.plot(1e-3 * exact, 1e3 * y, "k-", linewidth=0.8, label="exact")
        stress.set(xlabel="vertical stress [kPa]", ylabel="height [mm]", title="Column under its own weight")
        stress.legend()
        time, kinetic = np.transpose(history)
        energy.semilogy(time / period, np.maximum(kinetic, 1e-18))
        energy.set(xlabel="time [periods]", ylabel="kinetic energy [J/m]", title="Stopped at every peak")

    return Outcome(rows, draw)


def inextensible(q: float) -> tuple[np.ndarray, float]:
    """(points [n, 2] from clamp to tip, strain energy over E'I/L) of an inextensible cantilever, in lengths L.

    theta'' = -q (1 - s) cos(theta), theta(0) = 0, theta'(1) = 0: the moment of the weight beyond s bends the beam down.
    """
    s = np.linspace(0.0, 1.0, 201)
    found = solve_bvp(
        lambda s, y: np.array([y[1], -q * (1.0 - s) * np.cos(y[0]), np.cos(y[0]), -np.sin(y[0]), 0.5 * y[1] ** 2]),
        lambda a, b: np.array([a[0], b[1], a[2], a[3], a[4]]),
        s,
        np.zeros((5, len(s))),
        tol=1e-8,
    )
    y = found.sol(s)
    return y[2:4].T, float(y[4, -1])


def hang(q: float, cells: int) -> tuple[np.ndarray, np.ndarray, float]:
    """A strip 15 times as long as thick, of so many cells' thickness, at rest under its weight q = rho g h L^3/(E'I).

    Its particles and its middle line from clamp to tip, in lengths L, and its strain energy over E'I/L.

    Apic: FLIP rings as particles cross cells, every stop then feeds the ringing, and the tip creeps (q = 2: -y/L went
    from 0.241 to 0.258 within two periods with PicFlip(flip=0.99)).
    """
    length, slenderness, density, nu = 0.15, 15.0, 1000.0, 0.14
    thickness = length / slenderness
    dx = thickness / cells
    modulus = 12.0 * density * GRAVITY * length * slenderness**2 / q  # E' = E/(1 - nu^2)
    period = 2.0 * math.pi / 1.8751**2 * length * slenderness * math.sqrt(12.0 * density / modulus)
    drop = math.ceil(0.6 * length / dx) * dx
    scene = Scene(
        title="cantilever",
        domain=Domain(lower=(0.0, -drop), upper=(length + 2.0 * dx, thickness + 2.0 * dx), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(length, thickness))),),
        rock=elastic(modulus * (1.0 - nu**2), nu, density),
        loading=Loading(boundaries=(Fixed(axis=0, side="lower", position=0.0),), body_force=(0.0, -GRAVITY)),
        schedule=Schedule(t_end=1.5 * period, cfl=1.0),
        transfer=Apic(),
    )
    drive = set_up(scene)
    relax(drive, round(0.01 * period / scene.dt), 1e-6)
    snapshot = take_snapshot(drive.sim, drive.clock.time)
    column = np.floor((snapshot.x - snapshot.displacement)[:, 0] / (0.5 * dx)).astype(int)
    line = np.stack([np.bincount(column, x) / np.bincount(column) for x in snapshot.x.T], axis=1)
    line = np.vstack([line, 1.5 * line[-1] - 0.5 * line[-2]])
    clamp = np.array([0.0, 0.5 * thickness])
    return (
        (snapshot.x - clamp) / length,
        (line - clamp) / length,
        drive.survey.elastic * 12.0 * length / (modulus * thickness**3),
    )


def elastica(full: bool) -> Outcome:
    """A cantilever bent far by its weight, against the inextensible elastica; q = 2 and 5, up to 8 cells thick."""
    rows, shapes = [], []
    for q, cells in ((2.0, 4), (2.0, 8), (5.0, 8)) if full else ((2.0, 4),):
        particles, line, energy = hang(q, cells)
        exact, exact_energy = inextensible(q)
        shapes.append((f"q = {q:g}, {cells} cells", particles, line, exact))
        missed = np.linalg.norm(line[-1] - exact[-1]) / np.linalg.norm(exact[-1] - [1.0, 0.0])
        name = f"q = {q:g}, {cells} cells:"
        why = "B-splines make free faces too soft by a fraction of a cell, so the error falls with it; shear 0.4 %"
        rows.append(at_most(f"{name} error of the tip over its way", float(missed), 0.03, why))
        why = "as the tip, whose displacement does the work"
        rows.append(relative(f"{name} strain energy/(E'I/L)", exact_energy, energy, 0.05, why))

    def draw(figure):
        axes = figure.subplots()
        for label, particles, line, exact in shapes:
            dots = axes.plot(*particles.T, ".", markersize=0.5, alpha=0.4)[0]
            axes.plot(*line.T, color=dots.get_color(), label=label)
            axes.plot(*exact.T, "k--", linewidth=1.0)
        axes.plot([], [], "k--", linewidth=1.0, label="inextensible elastica")
        axes.set(xlabel="x/L", ylabel="y/L", title="Cantilever under its own weight", aspect="equal")
        axes.legend(loc="lower left")

    return Outcome(tuple(rows), draw)


CASES = (
    Case("self_weight", "a column under gravity: stress profile, shortening, reaction", self_weight),
    Case("elastica", "a cantilever bent far by its own weight", elastica, quick=False),
)
