"""Spall: a flyer hits a plate of the same rock in uniaxial strain, and what the free face sends back tears a scab off.

Acoustic theory (Meyers 1994, Dynamic Behavior of Materials, ch. 17; Antoun et al. 2003, Spall Fracture, ch. 2): the
pressure is rho c v/2. The releases from both free faces meet at the flyer's thickness h from the plate's free face, at
t = (L + h)/c, and would pull by rho c v/2. Where that is more than sigma_t the plate parts there. Its free face goes at
v, and the tension that comes to it from the spall plane slows it by 2 sigma_t/(rho c), the pull-back.

While a crack with fracture energy opens, the plane goes on pulling at the scab. With T = rho c v/2 and both halves
unloading into their waves it opens at dw/dt = 2 (T - sigma)/(rho c), sigma = sigma_t (1 - w sigma_t/(2 G_f)), so that

    T - sigma = (T - sigma_t) exp(t/tau),    tau = rho c G_f/sigma_t^2,

and it takes the impulse tau (T ln(T/(T - sigma_t)) - sigma_t) from the momentum rho h v that the flyer brought: the
scab goes at v less that over rho h. Predicted from sigma_t, G_f, E, nu and rho alone: the rock of the scenes, as it is.
"""

import math
from dataclasses import dataclass, field, replace

import numpy as np

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.results.result import Result
from rsmpm_ti.rock.after_failure import CompressionOnly
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.nonlocal_mean import Local
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.solver.observer import Observer
from rsmpm_ti.solver.view import View
from rsmpm_ti.spec.boundaries import Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import Comparison, compare
from rsmpm_ti.validate.experiment import Experiment, Input

FLYER, PLATE = 20.0 * mm, 60.0 * mm
"""Thicknesses h and L: 80 cells to h, in the quick tier 40."""

ABOVE = 2.0
"""Impact speed over the least that spalls: a pressure of 2 sigma_t, far below what breaks confined rock in shear."""

DX, QUICK_DX = 0.25 * mm, 0.5 * mm

LAB = lab_rock()
PAPER = replace(LAB, after_failure=CompressionOnly(), nonlocal_mean=Local())
"""The same rock by the paper's rule: a failed particle pulls no more, at once."""

STRENGTH = LAB.criterion.tensile_strength
ENERGY = LAB.after_failure.softening.G_f_I
SPEED_OF_SOUND = LAB.wave_speed()
IMPEDANCE = LAB.density * SPEED_OF_SOUND
SPEED = ABOVE * 2.0 * STRENGTH / IMPEDANCE
MEETING = (PLATE + FLYER) / SPEED_OF_SOUND
"""When the releases meet [s]."""

SOURCE = "acoustic theory: Meyers 1994, Dynamic Behavior of Materials, ch. 17; Antoun et al. 2003, Spall Fracture"

RINGS = (
    "fronts of a step ring: unbroken rock is pulled by 1.4 rho c v/2, beside the place (docs/references.md, section 2)"
)


@dataclass
class Face(Observer):
    """Velocity of the plate's free face, and stress along the plate and flyer, at every row of the history."""

    times: list[float] = field(default_factory=list)
    velocity: list[float] = field(default_factory=list)
    stress: list[np.ndarray] = field(default_factory=list)

    every = 0.0

    def see(self, view: View) -> None:
        snapshot = view.snapshot
        place = snapshot.x[:, 1] - snapshot.displacement[:, 1]
        rows, member = np.unique(place.round(9), return_inverse=True)
        count = np.bincount(member)
        self.times.append(view.time)
        self.stress.append(np.bincount(member, snapshot.sigma[:, 1, 1]) / count)
        self.velocity.append(float(snapshot.velocity[member == len(rows) - 1, 1].mean()))


def plate_impact(rock: Rock, dx: float) -> Scene:
    """A strip two cells wide between walls, so that strain is uniaxial; both bodies touch at the start."""
    width, room = 2.0 * dx, 5.0 * mm
    walls = (Wall(axis=0, side="lower", position=0.0), Wall(axis=0, side="upper", position=width))
    flyer = Box(lower=(0.0, 0.0), upper=(width, FLYER))
    plate = Box(lower=(0.0, FLYER), upper=(width, FLYER + PLATE))
    return Scene(
        title="A flyer hits a plate",
        domain=Domain(lower=(0.0, -room), upper=(width, FLYER + PLATE + room), dx=dx),
        bodies=(Body(region=flyer, velocity=(0.0, SPEED)), Body(region=plate)),
        rock=rock,
        loading=Loading(boundaries=walls),
        schedule=Schedule(t_end=2.2 * MEETING, cfl=0.25, rows=400),
    )


@dataclass(frozen=True)
class Spalled:
    """A run and what was seen of its free face."""

    result: Result
    face: Face

    @classmethod
    def of(cls, rock: Rock, dx: float) -> "Spalled":
        face = Face()
        return cls(simulate(plate_impact(rock, dx), threads=1, observers=(face,)), face)

    @property
    def place(self) -> float:
        """Depth of the first scab below the free face, where the first particle failed [m]; NaN without one."""
        events = self.result.events
        return FLYER + PLATE - float(events.x[0, 1]) if len(events) else math.nan

    @property
    def onset(self) -> float:
        """When the plate began to lose strength [s]."""
        events = self.result.events
        first = float(events.time[0]) if len(events) else math.inf
        return min(events.onset, first)

    @property
    def before(self) -> float:
        """Mean velocity of the free face between the wave's arrival and the pull-back [m/s]."""
        times, velocity = np.array(self.face.times), np.array(self.face.velocity)
        arrival, release = PLATE / SPEED_OF_SOUND, (PLATE + 2.0 * FLYER) / SPEED_OF_SOUND
        middle = (times > arrival + 0.2 * (release - arrival)) & (times < release - 0.2 * (release - arrival))
        return float(velocity[middle].mean())

    @property
    def pull_back(self) -> float:
        """rho c times half of what the free face then loses [Pa]: its strength, as a gauge there would tell it."""
        times, velocity = np.array(self.face.times), np.array(self.face.velocity)
        release = (PLATE + 2.0 * FLYER) / SPEED_OF_SOUND
        after = (times > release) & (times < release + FLYER / SPEED_OF_SOUND)
        return 0.5 * IMPEDANCE * (self.before - float(velocity[after].min()))

    @property
    def scab(self) -> float:
        """Mean velocity at the end of the rock that lies more than a tenth nearer to the face than the scab [m/s]."""
        snapshot = self.result.snapshot
        place = snapshot.x[:, 1] - snapshot.displacement[:, 1]
        return float(snapshot.velocity[place > FLYER + PLATE - 0.9 * FLYER, 1].mean())

    @property
    def spent(self) -> float:
        """What cracks cost, per area of the plate [J/m^2]."""
        return float(self.result.snapshot.history["dissipated"].mean()) * (FLYER + PLATE)


def scab_speed(energy: float) -> float:
    """Of the scab over the free face's before, by the theory above; energy: G_f [J/m^2]."""
    pull = 0.5 * IMPEDANCE * SPEED
    tau = IMPEDANCE * energy / STRENGTH**2
    impulse = tau * (pull * math.log(pull / (pull - STRENGTH)) - STRENGTH)
    return 1.0 - impulse / (LAB.density * FLYER * SPEED)


def _rows(spalled: Spalled, law: str, energy: float, *, place: str = "") -> list[Comparison]:
    """place: why that cannot come nearer."""
    momentum = "momentum, less the impulse of the crack while it opens: see the module"
    return [
        compare(f"{law}: depth of the first scab", "mm", FLYER / mm, spalled.place / mm, 0.03, SOURCE, beyond=place),
        compare(f"{law}: time of its first loss of strength", "us", 1e6 * MEETING, 1e6 * spalled.onset, 0.03, SOURCE),
        compare(f"{law}: velocity of the free face before", "m/s", SPEED, spalled.before, 0.03, SOURCE),
        compare(f"{law}: velocity of the scab over that of the face", "1", scab_speed(energy),
                spalled.scab / spalled.before, 0.03, momentum),
    ]  # fmt: skip


def spall(full: bool) -> Outcome:
    dx = DX if full else QUICK_DX
    lab = Spalled.of(LAB, dx)
    rows = [
        *_rows(lab, "with fracture energy", ENERGY),
        compare("with fracture energy: strength read from the pull-back", "MPa", STRENGTH / MPa, lab.pull_back / MPa,
                0.10, SOURCE),
        compare("with fracture energy: what the crack cost per area", "J/m^2", ENERGY, lab.spent, 0.10, "given: G_f_I"),
    ]  # fmt: skip
    runs = {"with fracture energy": lab}
    if full:
        paper, whole = Spalled.of(PAPER, dx), Spalled.of(replace(PAPER, criterion=Unbreakable()), dx)
        runs["law of the paper"] = paper
        rows += _rows(paper, "law of the paper", 0.0, place=RINGS)
        pull = max(stress.max() for stress in whole.face.stress) / (0.5 * IMPEDANCE * SPEED)
        rows.append(
            compare("unbroken: largest tension over rho c v/2", "1", 1.0, float(pull), 0.05, SOURCE, beyond=RINGS)
        )

    def draw(figure):
        history, waves = figure.subplots(1, 2)
        for name, spalled in runs.items():
            history.plot(1e6 * np.array(spalled.face.times), spalled.face.velocity, lw=0.9, label=name)
        arrival, release = 1e6 * PLATE / SPEED_OF_SOUND, 1e6 * (PLATE + 2.0 * FLYER) / SPEED_OF_SOUND
        history.plot([0.0, arrival, arrival, release, release], [0.0, 0.0, SPEED, SPEED, SPEED * (1.0 - 1.0 / ABOVE)],
                     "k--", lw=0.8, label="acoustic, to the pull-back")  # fmt: skip
        history.set(xlabel="time [us]", ylabel="velocity [m/s]", title="The plate's free face")
        history.legend(loc="lower right")
        field = np.array(lab.face.stress) / MPa
        image = waves.imshow(field, origin="lower", aspect="auto", cmap="RdBu_r", vmin=-2.0 * ABOVE, vmax=2.0 * ABOVE,
                             extent=(0.0, (FLYER + PLATE) / mm, 0.0, 1e6 * lab.face.times[-1]))  # fmt: skip
        waves.plot(PLATE / mm, 1e6 * MEETING, "ko", mfc="none", label="theory: first scab")
        waves.plot((FLYER + PLATE - lab.place) / mm, 1e6 * lab.onset, "kx", label="run")
        waves.axvline(FLYER / mm, color="k", lw=0.5, ls=":")
        waves.set(xlabel="flyer | plate [mm]", ylabel="time [us]", title="Stress, tension positive [MPa]")
        waves.legend(loc="lower right")
        figure.colorbar(image, ax=waves)

    return Outcome(tuple(rows), draw)


CASES = (
    Experiment(
        "spall", "a flyer hits a plate: place, time and velocity of the scab by acoustic theory", spall,
        inputs=(
            Input("sigma_t", STRENGTH, "Pa", "the rock of the scenes"),
            Input("G_f_I", ENERGY, "J/m^2", "the rock of the scenes"),
            Input("E", LAB.elasticity.E, "Pa", "the rock of the scenes"),
            Input("nu", LAB.elasticity.nu, "1", "the rock of the scenes"),
            Input("density", LAB.density, "kg/m^3", "the rock of the scenes"),
        ),
    ),
)  # fmt: skip
