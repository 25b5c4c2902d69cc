"""Plane waves in a column between frictionless walls: a d'Alembert step, and free vibration against dispersion theory.

The column is confined, so its waves are exactly one-dimensional: c_p, and rho c_p v behind a front.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_most, difference, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Gimp, Linear, QuadraticBSpline
from rsmpm_ti.solver.advance import Drive
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.elastic.bodies import elastic

E, NU, DENSITY = 17e9, 0.14, 2600.0
C_P = math.sqrt(E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)) / DENSITY)
"""sqrt((lambda + 2 mu)/rho) = 2617.39 m/s."""

DX = 1e-3
LONG = 1.0
"""An end of the schedule that no run reaches [s]."""


def column(shape, order: str, cells: int, ends: tuple) -> Drive:
    """A column along y, two cells wide, `cells` long, walls at its sides."""
    width, length = 2.0 * DX, cells * DX
    sides = (Wall(axis=0, side="lower", position=0.0), Wall(axis=0, side="upper", position=width))
    scene = Scene(
        title="column",
        domain=Domain(lower=(0.0, 0.0), upper=(width, length), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(width, length))),),
        rock=elastic(E, NU, DENSITY),
        loading=Loading(boundaries=(*sides, *ends)),
        schedule=Schedule(t_end=LONG),
        shape=shape,
        order=order,
    )
    return set_up(scene)


V0 = 1e-3
"""Speed of the platen [m/s]: a strain of 4e-7, so that no particle leaves its cell."""

HALF, BEFORE, AFTER = 0.5, 0.75, 1.6
"""In column lengths: where arrival is timed, and how far the front has come for the profiles on its way and back."""


@dataclass(frozen=True)
class Front:
    """What one step wave did; stress over rho c_p v0, tension positive; times in cells that an exact front travels."""

    name: str
    y: np.ndarray  # of a row of particles [cells]
    times: np.ndarray
    middle: np.ndarray  # stress at the row next to the middle against times
    on_its_way: np.ndarray  # stress against y when the front is at BEFORE
    returned: np.ndarray  # and when it is back at 2 - AFTER

    @property
    def delay(self) -> float:
        """Cells by which the 50 % level is late."""
        late = np.flatnonzero(self.middle < -0.5)[0]
        a, b = self.middle[late - 1 : late + 1]
        fraction = (-0.5 - a) / (b - a)
        row = self.y[np.searchsorted(self.y, HALF * round(self.y[-1])) - 1]
        return float(self.times[late - 1] + fraction * (self.times[late] - self.times[late - 1]) - row)


def step_wave(shape, cells: int) -> Front:
    ends = (
        Platen(axis=1, side="lower", position=0.0, speed=V0),
        Wall(axis=1, side="upper", position=cells * DX),
    )
    drive = column(shape, "musl", cells, ends)
    row, times, profiles = drive.clock.dt * C_P / DX, [0.0], [np.zeros(2 * cells)]
    y = drive.sim.particles.reference.to_numpy()[:, 1] / DX
    rows, member = np.unique(y.round(6), return_inverse=True)
    while times[-1] < AFTER * cells:
        drive.advance(2)
        sigma = drive.sim.particles.sigma.to_numpy()[:, 1] / (DENSITY * C_P * V0)
        times.append(drive.clock.step * row)
        profiles.append(np.bincount(member, sigma) / np.bincount(member))
    times, profiles = np.array(times), np.array(profiles)
    middle = profiles[:, np.searchsorted(rows, HALF * cells) - 1]
    before = profiles[np.searchsorted(times, BEFORE * cells)]
    return Front(type(shape).__name__, rows, times, middle, before, profiles[-1])


def wave(full: bool) -> Outcome:
    """A column is hit at v0: -rho c_p v0 behind the front, twice that behind its reflection from the fixed end."""
    cells = 400 if full else 200
    fronts, rows = [step_wave(shape, cells) for shape in (Linear(), QuadraticBSpline())], []
    for front in fronts:
        behind = (front.y > 0.05 * cells) & (front.y < (BEFORE - 0.15) * cells)
        why = "the mean is conservation of momentum; the front rings by 27 %: docs/references.md, section 2"
        plateau = front.on_its_way[behind].mean()
        rows.append(relative(f"{front.name}: stress behind the front/(rho c v)", -1.0, plateau, 0.01, why))
        doubled = front.returned[front.y > (2.0 - AFTER + 0.15) * cells].mean()
        rows.append(relative(f"{front.name}: behind its reflection/(rho c v)", -2.0, doubled, 0.01, why))
        limit = 3.0 if front.name == "QuadraticBSpline" else 2.0
        why = "an Airy front is 1.4 to 1.7 (B-spline 1.7 to 2.2) cells late: docs/references.md, section 2"
        rows.append(difference(f"{front.name}: delay of the front [cells]", 0.0, front.delay, limit, why))

    def draw(figure):
        history, profile = figure.subplots(2, 1)
        for front in fronts:
            line = history.plot(front.times, front.middle, linewidth=0.8, label=front.name)[0]
            for stress in (front.on_its_way, front.returned):
                profile.plot(front.y, stress, linewidth=0.8, color=line.get_color())
        y = front.y
        passages = np.searchsorted([HALF * cells, (2.0 - HALF) * cells], front.times)
        history.plot(front.times, -passages, "k--", linewidth=0.8, label="exact")
        for exact in (np.where(y < BEFORE * cells, -1.0, 0.0), np.where(y > (2.0 - AFTER) * cells, -2.0, -1.0)):
            profile.plot(y, exact, "k--", linewidth=0.8)
        history.set(xlabel="way of an exact front [cells]", ylabel=r"$\sigma/(\rho c_p v_0)$", title="At mid-column")
        history.legend(loc="lower left")
        profile.set(xlabel="y [cells]", ylabel=r"$\sigma/(\rho c_p v_0)$", title="On its way, and on its way back")

    return Outcome(tuple(rows), draw)


HALF_WIDTH = {"Linear": 0.0, "Gimp": 0.25, "QuadraticBSpline": 0.5}
"""Each shape function is a hat averaged over +- so many cells: of a particle (uGIMP), of a cell (B-spline)."""


def averaged_hat(d: np.ndarray, half_width: float) -> tuple[np.ndarray, np.ndarray]:
    """(value, slope) at signed distance d [cells] of 1 - |d| averaged over d +- half_width: the hat's own integral."""
    hat = np.maximum(1.0 - np.abs(d), 0.0)
    if half_width == 0.0:
        return hat, np.where(np.abs(d) < 1.0, -np.sign(d), 0.0)

    def mean(function):
        return (function(d + half_width) - function(d - half_width)) / (2.0 * half_width)

    def integral(s):
        s = np.clip(s, -1.0, 1.0)
        return s - 0.5 * s * np.abs(s)

    return mean(integral), mean(lambda s: np.maximum(1.0 - np.abs(s), 0.0))


def one_step_operator(shape: str, order: str, cells: int, cfl: float, fixed: bool) -> np.ndarray:
    """One step of the linear 1-D method as a matrix on (v_p, sigma_p/(rho c)), two particles per cell, c = dx = 1.

    From the definitions of the method, sharing nothing with the solver: P maps particles' momentum to node velocities,
    F sigma is the nodes' acceleration, S and G map back velocities and gradients, H holds the end nodes if `fixed`.
    """
    n = 2 * cells
    nodes = np.arange(-1, cells + 2)
    S, G = averaged_hat((np.arange(n)[:, None] + 0.5) / 2.0 - nodes, HALF_WIDTH[shape])
    held = np.zeros(len(nodes))
    if fixed:
        held[[0, 1, -2, -1]] = 1.0
        for weights in (S, G):  # v_-1 = 2 v_0 - v_1 beyond a wall
            for beyond, wall, inner in ((0, 1, 2), (-1, -2, -3)):
                weights[:, wall] += 2.0 * weights[:, beyond]
                weights[:, inner] -= weights[:, beyond]
                weights[:, beyond] = 0.0
    used = S.sum(axis=0) > 1e-9
    S, G, H = S[:, used], G[:, used], np.diag(1.0 - held[used])
    mass = S.sum(axis=0)
    P, F, one, nil = S.T / mass[:, None], -G.T / mass[:, None], np.eye(n), np.zeros((n, n))
    strain = np.block([[one, nil], [cfl * G @ H @ P, one]])
    if order == "usf":
        return np.block([[one, cfl * S @ H @ F], [nil, one]]) @ strain
    # the solver's FLIP increment is counted from the node velocity before the wall stops it; usf stops it before
    push = [one + S @ (H - np.eye(len(mass))) @ P, cfl * S @ H @ F]
    if order == "usl":
        return np.block([push, [cfl * G @ H @ P, one + cfl**2 * G @ H @ F]])
    return strain @ np.block([push, [nil, one]])


@dataclass(frozen=True)
class Vibration:
    """A standing wave: phase speed over c_p, energy lost per period, and the record behind them."""

    speed: float
    loss: float
    periods: np.ndarray  # times in nominal periods
    amplitude: np.ndarray  # of the particle velocity in the mode over its start
    energy: np.ndarray  # kinetic and elastic, over its start


def theory(drive: Drive, wave_length: int, cfl: float) -> tuple[float, float]:
    """(phase speed/c_p, energy lost per period) by the eigenvalue of the one-step operator that is nearest the mode."""
    scene = drive.sim.scene
    fixed = len(scene.loading.boundaries) > 2
    cells = round(scene.domain.upper[1] / DX)
    values, vectors = np.linalg.eig(one_step_operator(type(scene.shape).__name__, scene.order, cells, cfl, fixed))
    mode = mode_shape((np.arange(2 * cells) + 0.5) / 2.0, wave_length, fixed)
    likeness = np.abs(mode @ vectors[: 2 * cells]) / np.linalg.norm(vectors[: 2 * cells], axis=0)
    value = values[np.argmax(np.where(values.imag > 1e-9, likeness, 0.0))]
    return (
        np.angle(value) / (cfl * 2.0 * np.pi / wave_length),
        1.0 - abs(value) ** (4.0 * np.pi / np.angle(value)),
    )


def mode_shape(y: np.ndarray, wave_length: int, fixed: bool) -> np.ndarray:
    """The exact mode of a bar that is fixed or free at both ends; y in cells."""
    return (np.sin if fixed else np.cos)(2.0 * np.pi / wave_length * y)


STRAIN = 1e-8
"""Amplitude: nothing is left of what is not linear, and no node beyond a free end gets mass enough to be one."""

LOOKS = 16
"""Samples per period."""


def vibrate(drive: Drive, wave_length: int, cfl: float, periods: int) -> Vibration:
    """Start the standing wave of that many cells from the same unstressed state, and fit what it does."""
    particles, clock = drive.sim.particles, drive.clock
    y = particles.reference.to_numpy()[:, 1] / DX
    mode = mode_shape(y, wave_length, len(drive.sim.boundaries) > 2)
    for field, value in ((particles.u, 0.0), (particles.sigma, 0.0), (particles.J, 1.0)):
        field.fill(value)
    particles.v.from_numpy(STRAIN * C_P * np.stack([0.0 * mode, mode], axis=1))
    clock.step, clock.dt = 0, cfl * DX / C_P
    stride = max(1, round(wave_length / cfl / LOOKS))
    samples = []
    while clock.step * cfl < periods * wave_length:
        drive.advance(stride)
        amplitude = particles.v.to_numpy()[:, 1] @ mode / (mode @ mode) / (STRAIN * C_P)
        samples.append((clock.step * cfl / wave_length, amplitude, drive.survey.kinetic + drive.survey.elastic))
    t, amplitude, energy = np.array(samples).T
    # a(t + s) + r^2 a(t - s) = 2 r cos(omega s) a(t) holds for any damped oscillation; s: a quarter period
    lag = LOOKS // 4
    rows = np.stack([amplitude[lag:-lag], amplitude[: -2 * lag], np.ones(len(t) - 2 * lag)], axis=1)
    (twice, minus_square, _), *_ = np.linalg.lstsq(rows, amplitude[2 * lag :], rcond=None)
    angle = math.acos(0.5 * twice / math.sqrt(-minus_square))
    speed = angle / (2.0 * np.pi * lag * (t[1] - t[0]))
    # kinetic energy of particles exceeds that of nodes, so the sum beats twice a period: fit that and two harmonics
    beat = 4.0 * np.pi * speed * t
    terms = (np.ones_like(t), t, *(f(k * beat) for k in (1.0, 2.0, 3.0) for f in (np.cos, np.sin)))
    fit = np.linalg.lstsq(np.stack(terms, axis=1), np.log(energy), rcond=None)[0]
    return Vibration(speed, 1.0 - math.exp(fit[1] / speed), t, amplitude, energy / energy[0])


BAR = 64
"""Length of the vibrating bar [cells]: a multiple of half of every wave length."""

FREE, FIXED = (), (Wall(axis=1, side="lower", position=0.0), Wall(axis=1, side="upper", position=BAR * DX))
"""Ends of the bar."""

CURVATURE = {"Linear": 1.0 / 8.0, "QuadraticBSpline": 1.0 / 4.0}
"""omega/(c k) = 1 - CURVATURE (k h)^2 at two particles per cell and cfl 0.5; other steps add (1/4 - cfl^2)/24.

docs/references.md, section 2. Linear elements with lumped mass would have 1/24."""


def _frequencies(shape, order: str, waves: tuple[int, ...]) -> tuple[list, list]:
    """Rows of an order that loses nothing in a free bar, and what was measured: (wave length, Vibration) each."""
    bar, name = column(shape, order, BAR, FREE), type(shape).__name__
    found = [(length, vibrate(bar, length, 0.4, 5)) for length in waves]
    rows = []
    for length, vibration in found:
        why = "terms of fourth order, 1.7 % at 16 cells by the one-step operator; docs/references.md, section 2"
        formula = (CURVATURE[name] + (0.25 - 0.4**2) / 24.0) * (2.0 * math.pi / length) ** 2
        quantity = f"{name}: frequency error, {length} cells per wave"
        rows.append(relative(quantity, formula, 1.0 - vibration.speed, 0.03, why))
    for (_, coarse), (length, fine) in zip(found, found[1:], strict=False):
        why = "second order; the terms of fourth order are 1 % of it at 16 cells"
        ratio = (1.0 - coarse.speed) / (1.0 - fine.speed)
        rows.append(relative(f"{name}: fall of that error to {length} cells", 4.0, ratio, 0.03, why))
    off = max(abs(vibration.speed - theory(bar, length, 0.4)[0]) for length, vibration in found)
    why = "the cosine mixes in other modes of the operator near the ends: 2e-5"
    rows.append(at_most(f"{name}: frequency against the operator", off, 5e-5, why))
    why = "the operator's eigenvalues lose 1e-12; the fit of the beat over 5 periods resolves 1e-8"
    rows.append(at_most(f"{name}, {order}: energy lost per period", abs(found[-1][1].loss), 1e-6, why))
    return rows, found


def _losses(waves: tuple[int, ...]) -> tuple[list, list]:
    """Rows of usl, which dissipates; before particles move uGIMP is the linear hat, with which usl is refused."""
    bar = column(Gimp(), "usl", BAR, FREE)
    found = [(length, vibrate(bar, length, 0.1, 4)) for length in waves]
    rows = []
    for length, vibration in found:
        why = "two fits of one linear system; 5e-2, 7e-3, 9e-4 at 8, 16, 32 cells: docs/references.md, section 2"
        quantity = f"Gimp, usl: loss per period, {length} cells per wave"
        rows.append(relative(quantity, theory(bar, length, 0.1)[1], vibration.loss, 0.01, why))
    length, slow = found[1]
    why = "proportional to the step to first order: 3.95 by the one-step operator"
    ratio = vibrate(bar, length, 0.4, 4).loss / slow.loss
    rows.append(relative("Gimp, usl: loss at CFL 0.4 over that at 0.1", 4.0, ratio, 0.03, why))
    return rows, found


def _wall_losses() -> list:
    """musl stops nodes at a wall after the step: what their particles bring there is lost, and the operator says so."""
    bar = column(QuadraticBSpline(), "musl", BAR, FIXED)
    why = "the sine mixes in other modes of the operator, which lose more: 2 %"
    quantity = "QuadraticBSpline, musl: loss per period, fixed ends"
    return [relative(quantity, theory(bar, 32, 0.4)[1], vibrate(bar, 32, 0.4, 5).loss, 0.05, why)]


def vibration(full: bool) -> Outcome:
    """Standing waves: frequency and damping of each shape function and order against dispersion theory."""
    waves = (16, 32, 64) if full else (16, 32)
    linear_rows, linear = _frequencies(Linear(), "musl", waves)
    spline_rows, spline = _frequencies(QuadraticBSpline(), "usf", waves)
    usl_rows, usl = _losses((8, 16, 32))
    rows = (*linear_rows, *spline_rows, *usl_rows, *(_wall_losses() if full else ()))

    def draw(figure):
        dispersion, energy = figure.subplots(1, 2)
        lengths = np.array([64.0, 8.0])
        for label, found in (("Linear", linear), ("QuadraticBSpline", spline)):
            formula = CURVATURE[label] * (2.0 * np.pi / lengths) ** 2
            dispersion.loglog(lengths, formula, "k--", linewidth=0.8)
            dispersion.loglog(*np.transpose([(length, 1.0 - v.speed) for length, v in found]), "o", label=label)
        dispersion.set(xlabel="cells per wave", ylabel=r"$1 - \omega/(c_p k)$", title="Dashed: (kh)²/8 and (kh)²/4")
        dispersion.set_xticks([8, 16, 32, 64], ["8", "16", "32", "64"])
        dispersion.minorticks_off()
        dispersion.legend()
        for label, found in (("Linear, musl", linear), ("QuadraticBSpline, usf", spline), ("Gimp, usl", usl)):
            v = dict(found)[16]
            window = np.count_nonzero(v.periods < 0.5 / v.speed)  # the sum beats with half a period
            mean = np.convolve(v.energy, np.full(window, 1.0 / window), mode="valid")
            energy.plot(v.periods[: len(mean)], mean / mean[0], label=label)
        decay = (1.0 - usl_rows[1].reference) ** energy.lines[-1].get_xdata()
        energy.plot(energy.lines[-1].get_xdata(), decay, "k--", linewidth=0.8, label="one-step operator")
        energy.set(xlabel="time [periods]", ylabel="mean energy of half a period", title="16 cells per wave")
        energy.legend()

    return Outcome(rows, draw)


CASES = (
    Case("wave", "a step wave in a confined column, and its reflection", wave),
    Case("vibration", "frequency and damping of standing waves, by shape function and order", vibration),
)
