"""Whole bodies: flight, turning and spinning of a stressed disc, and the collision of two."""

import math

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_least, at_most, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.fields.cell_order import sort_particles
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.method.transfer import Apic
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.readout import take_snapshot
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule


def elastic(E: float, nu: float, density: float) -> Rock:
    """What does nothing but stretch."""
    return Rock(density=density, elasticity=Hooke(E=E, nu=nu), criterion=Unbreakable(), viscosity=NoViscosity())


def turned(angle: float) -> np.ndarray:
    """Rotation by an angle, counter-clockwise."""
    return np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])


class Wheel:
    """A free disc of four cells' radius, brought to a new motion without building the simulation again."""

    radius, centre = 4e-3, np.array([8e-3, 8e-3])

    def __init__(self):
        scene = Scene(
            title="wheel",
            domain=Domain(lower=(0.0, 0.0), upper=tuple(2.0 * self.centre), dx=1e-3),
            bodies=(Body(region=Disc(centre=tuple(self.centre), radius=self.radius)),),
            rock=elastic(17e9, 0.14, 2600.0),
            loading=Loading(),
            schedule=Schedule(t_end=1.0),  # never reached
            transfer=Apic(),  # an affine velocity field stays one
        )
        self.drive = set_up(scene)
        self.particles, self.c, self.dx = self.drive.sim.particles, scene.wave_speed, scene.domain.dx

    def start(self, cfl: float, velocity: np.ndarray, gradient: np.ndarray, sigma: tuple[float, ...]) -> None:
        """From where it was built, with an affine velocity field about its centre and a uniform packed stress."""
        particles, drive = self.particles, self.drive
        particles.u.fill(0.0)
        particles.J.fill(1.0)
        sort_particles(drive.sim)
        particles.v.from_numpy(velocity + self.position @ gradient.T)
        particles.C.from_numpy(np.tile(gradient, (particles.count, 1, 1)))
        particles.sigma.from_numpy(np.tile(sigma, (particles.count, 1)))
        drive.clock.step, drive.clock.dt = 0, cfl * self.dx / self.c

    @property
    def position(self) -> np.ndarray:
        """Positions from the centre."""
        return self.particles.reference.to_numpy() + self.particles.u.to_numpy() - self.centre

    @property
    def mass(self) -> np.ndarray:
        return self.drive.sim.density * self.particles.volume.to_numpy()

    @property
    def angular_momentum(self) -> float:
        """x cross v, and what the affine matrix carries: D = dx^2/4 for quadratic B-splines (Jiang et al. 2015)."""
        x, v, C = self.position, self.particles.v.to_numpy(), self.particles.C.to_numpy()
        orbital = x[:, 0] * v[:, 1] - x[:, 1] * v[:, 0]
        return float(self.mass @ (orbital + 0.25 * self.dx**2 * (C[:, 1, 0] - C[:, 0, 1])))


def _flight(wheel: Wheel) -> list:
    velocity = wheel.c * np.array([0.02, 0.013])
    wheel.start(0.5, velocity, np.zeros((2, 2)), (0.0,) * 4)
    wheel.drive.advance(200)
    change = np.abs(wheel.particles.v.to_numpy() / velocity - 1.0).max()
    stress = np.abs(wheel.particles.sigma.to_numpy()).max() / wheel.drive.sim.rock.elasticity.E
    why = "the functions sum to 1 and their gradients to 0: round-off of 200 steps across two cells"
    return [at_most("flight: change of velocity", change, 1e-13, why), at_most("flight: stress/E", stress, 1e-14, why)]


TURN = 200
"""Steps of one turn; the explicit Jaumann update would multiply the deviator by exp(8 pi^2/200) = 1.48."""

SHEAR, MEAN = np.array([[20e6, 5e6], [5e6, -20e6]]), 10e6
"""In-plane deviator and in-plane mean of the turned stress [Pa]."""


def _turn(wheel: Wheel) -> tuple[list, np.ndarray]:
    """A rigid turn in steps that are exactly rotations: nothing else may happen to the stress than R sigma R^T.

    Only the velocity is prescribed, by what a centripetal force would add; the step is so short against dx/c_p that
    the stress itself moves nothing.
    """
    angle, cfl = 2.0 * math.pi / TURN, 1e-7
    gradient = (turned(angle) - np.eye(2)) / (cfl * wheel.dx / wheel.c)
    wheel.start(cfl, np.zeros(2), gradient, (MEAN + SHEAR[0, 0], MEAN + SHEAR[1, 1], 3e6, SHEAR[0, 1]))
    deviator, worst, spread = math.hypot(SHEAR[0, 0], SHEAR[0, 1]), 0.0, 0.0
    record = []
    for k in range(1, TURN + 1):
        wheel.drive.advance(1)
        wheel.particles.v.from_numpy(wheel.position @ gradient.T)
        xx, yy, zz, xy = wheel.particles.sigma.to_numpy().T
        exact = turned(k * angle) @ SHEAR @ turned(k * angle).T
        missed = (xx - MEAN - exact[0, 0], yy - MEAN - exact[1, 1], zz - 3e6, xy - exact[0, 1])
        worst = max(worst, np.abs(missed).max() / deviator)
        spread = max(spread, np.abs(np.hypot(0.5 * (xx - yy), xy) / deviator - 1.0).max())
        record.append((360.0 * k / TURN, xx.mean(), xy.mean(), MEAN + exact[0, 0], exact[0, 1]))
    why = "round-off of 200 steps in the strain, times E over 20 MPa: 1e-11"
    rows = [
        at_most("turn: stress against R s R^T, over its deviator", worst, 1e-9, why),
        at_most("turn: change of the deviator's size", spread, 1e-9, why),
    ]
    return rows, np.array(record)


def _free_spin(wheel: Wheel) -> list:
    """Left to itself the wheel widens and rings, but angular momentum stays, and the mean tension is the virial's:

    div(sigma) = -rho w^2 x, times x and integrated over the body: int sigma_xx + sigma_yy dV = int rho w^2 r^2 dV.
    """
    w = 0.03 * wheel.c / wheel.radius
    wheel.start(0.5, np.zeros(2), w * np.array([[0.0, -1.0], [1.0, 0.0]]), (0.0,) * 4)
    start, drift, virial = wheel.angular_momentum, 0.0, []
    for _ in range(100):
        wheel.drive.advance(16)
        drift = max(drift, abs(wheel.angular_momentum / start - 1.0))
        xx, yy, _, _ = wheel.particles.sigma.to_numpy().T
        tension = wheel.particles.volume.to_numpy() * wheel.particles.J.to_numpy() @ (xx + yy)
        virial.append(tension / (w**2 * wheel.mass @ (wheel.position**2).sum(axis=1)))
    why = "APIC keeps it to round-off of 1600 steps"
    rows = [at_most("free spin: change of angular momentum", drift, 1e-12, why)]
    why = "mean over 1600 steps of a ringing that starts with 100 % and that APIC damps"
    return [
        *rows,
        relative("free spin: tension over centrifugal force (virial)", 1.0, float(np.mean(virial)), 0.01, why),
    ]


def spin(full: bool) -> Outcome:
    """Flight, a prescribed turn of a stressed disc, and a free spin."""
    wheel = Wheel()
    turn, record = _turn(wheel)
    rows = (*_flight(wheel), *turn, *_free_spin(wheel))

    def draw(figure):
        axes = figure.subplots()
        degrees, xx, xy, exact_xx, exact_xy = record.T
        for got, exact, label in ((xx, exact_xx, r"$\sigma_{xx}$"), (xy, exact_xy, r"$\sigma_{xy}$")):
            axes.plot(degrees[::4], 1e-6 * got[::4], ".", label=label)
            axes.plot(degrees, 1e-6 * exact, "k-", linewidth=0.8)
        axes.set(xlabel="angle [degrees]", ylabel="stress [MPa]", title="A stressed disc that is turned; lines: exact")
        axes.legend()

    return Outcome(rows, draw)


def _collision(shape, dx: float) -> tuple[np.ndarray, dict]:
    """Sulsky, Chen & Schreyer (1994): history (time, kinetic, elastic) over the start, and what is kept."""
    discs = tuple(Body(region=Disc(centre=(p, p), radius=0.2), velocity=(v, v)) for p, v in ((0.2, 0.1), (0.8, -0.1)))
    scene = Scene(
        title="discs",
        domain=Domain(lower=(-0.1, -0.1), upper=(1.1, 1.1), dx=dx),
        bodies=discs,
        rock=elastic(1000.0, 0.3, 1000.0),
        loading=Loading(),
        schedule=Schedule(t_end=3.6, cfl=0.3),
        shape=shape,
    )
    drive = set_up(scene)
    start = drive.survey.kinetic
    momentum = 0.5 * scene.density * sum(body.volume.sum() for body in scene.particles()) * 0.1  # of one disc
    history, translation, drift = [(0.0, 1.0, 0.0)], [], 0.0
    while not drive.clock.done:
        drive.advance(4)
        survey, time = drive.survey, drive.clock.time
        history.append((time, survey.kinetic / start, survey.elastic / start))
        drift = max(drift, np.abs(survey.momentum).max() / momentum)
        if time > APART:
            snapshot = take_snapshot(drive.sim, time)
            first = slice(0, len(snapshot.x) // 2)
            translation.append((snapshot.velocity[first].mean(axis=0) ** 2).sum() / 0.02)
    return np.array(history), {"drift": drift, "translation": np.array(translation)}


APART = 3.0
"""By then the discs have no node in common any more [s]."""


def colliding_discs(full: bool) -> Outcome:
    """Two elastic discs head on: momentum is kept, they fly apart, and energy goes into vibration, not nowhere."""
    runs = [("B-spline", QuadraticBSpline(), 0.05)]
    if full:
        runs += [("B-spline, dx/2", QuadraticBSpline(), 0.025), ("Linear", Linear(), 0.05)]
    rows, histories = [], []
    for name, shape, dx in runs:
        history, kept = _collision(shape, dx)
        histories.append((name, history))
        time, kinetic, elastic_fraction = history.T
        why = "every scatter and gather keeps momentum: round-off of 300 steps"
        rows.append(at_most(f"{name}: momentum over one disc's", kept["drift"], 1e-12, why))
        why = "MUSL and FLIP at 8 cells a diameter lose or gain 2-3 % as particles cross cells"
        rows.append(relative(f"{name}: energy at the end", 1.0, kinetic[-1] + elastic_fraction[-1], 0.03, why))
        why = "the rest is vibration"
        after = kinetic[time > APART].mean()
        rows.append(at_least(f"{name}: kinetic energy after the rebound", after, 0.85, why))
        why = "two free bodies: nothing acts on their centres but that nodes below 1e-24 of a cell's mass are dropped"
        change = np.ptp(kept["translation"]) / kept["translation"].mean()
        rows.append(at_most(f"{name}: change of the discs' speed^2, apart", change, 1e-9, why))

    def draw(figure):
        axes = figure.subplots()
        for name, history in histories:
            time, kinetic, elastic_fraction = history.T
            colour = axes.plot(time, kinetic, label=f"kinetic, {name}")[0].get_color()
            axes.plot(time, elastic_fraction, ":", color=colour)
            axes.plot(time, kinetic + elastic_fraction, "--", color=colour)
        axes.axvline(1.586, color="0.5", linewidth=0.8)
        axes.axhline(1.0, color="k", linewidth=0.8)
        axes.set(xlabel="time [s]", ylabel="energy over its start", title="Discs; dotted: elastic, dashed: sum")
        axes.annotate("circles touch", (1.586, 0.5), rotation=90, ha="right", va="center")
        axes.legend()

    return Outcome(tuple(rows), draw)


CASES = (
    Case("spin", "flight, a prescribed turn of a stressed disc, a free spin", spin),
    Case("colliding_discs", "two elastic discs head on: momentum and energy", colliding_discs),
)
