"""One confined cell pulled until it fails, opened further, closed and pressed: stress follows its closed form."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_most, difference
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

EDGE, SPEED, STEPS = 1e-3, 0.1, 400
E, NU, TENSILE = 17e9, 0.14, 2e6
CONFINED, BULK = E * (1.0 - NU) / ((1.0 + NU) * (1.0 - 2.0 * NU)), E / (3.0 * (1.0 - 2.0 * NU))
"""lambda + 2 mu and K of the reference [Pa], not asked of the solver."""


@dataclass(frozen=True, kw_only=True)
class PullThenPush:
    """The platen moves away during a quarter of `time` [s], then back at the same speed, past its first place."""

    time: float

    def factor(self, time: float) -> float:
        return 1.0 if time < 0.25 * self.time else -1.0


def cell_path() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, Rock]:
    """(J, sigma_yy, sigma_xx, mode) of one particle after every step [steps], and the rock."""
    criterion = MohrCoulomb(cohesion=5.95e6, friction_angle=40.0, tensile_strength=TENSILE)
    rock = Rock(density=2600.0, elasticity=Hooke(E=E, nu=NU), criterion=criterion, viscosity=NoViscosity())
    dt = 0.1 * EDGE / rock.wave_speed()
    scene = Scene(
        title="cell",
        domain=Domain(lower=(0.0, 0.0), upper=(EDGE, EDGE), dx=EDGE),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(EDGE, EDGE))),),
        rock=rock,
        loading=Loading(
            boundaries=(
                Wall(axis=0, side="lower", position=0.0),
                Wall(axis=0, side="upper", position=EDGE),
                Wall(axis=1, side="lower", position=0.0),
                Platen(axis=1, side="upper", position=EDGE, speed=SPEED, pulls=True),
            ),
            start=PullThenPush(time=STEPS * dt),
        ),
        schedule=Schedule(t_end=STEPS * dt, dt=dt),
        shape=Linear(),
    )
    drive = set_up(scene)
    particles, rows = drive.sim.particles, []
    for _ in range(STEPS):
        drive.advance(1)
        sigma = particles.sigma.to_numpy()[0]
        rows.append((particles.J.to_numpy()[0], sigma[1], sigma[0], particles.mode.to_numpy()[0]))
    return *np.array(rows).T, rock


def failed_cell(full: bool) -> Outcome:
    """(lambda + 2 mu) ln J up to the tensile strength; then p = max(K (1 - J), 0), by total J, without deviator."""
    J, axial, lateral, mode, rock = cell_path()
    expected = np.where(mode == 0, CONFINED * np.log(J), -np.maximum(BULK * (1.0 - J), 0.0))
    first = int(np.argmax(mode > 0))
    step = CONFINED * SPEED * 0.1 / rock.wave_speed()  # stress of one step
    error = np.abs(axial - expected).max() / TENSILE
    deviator = np.abs((axial - lateral)[mode > 0]).max() / TENSILE
    opened = np.abs(axial[(mode > 0) & (J > 1.0)]).max() / TENSILE
    why = "a step's strain is 4e-6; midpoint and logarithmic strain differ by its third power"
    rows = (
        at_most("path: largest stress error / sigma_t", error, 1e-6, why),
        difference(
            "stress when it fails [Pa]", TENSILE, expected[first - 1] + step, 1.1 * step, "the load of one step"
        ),
        at_most("failed: deviator / sigma_t", deviator, 1e-9, "set to zero in every step"),
        at_most("failed and open: stress / sigma_t", opened, 1e-12, "an opened crack carries nothing"),
        difference("label", 1.0, float(mode[first]), 0.0, "1 is tension"),
    )

    def draw(figure):
        axes = figure.subplots()
        strain = 1e3 * (J - 1.0)
        axes.plot(strain, 1e-6 * expected, "k--", label="closed form")
        axes.plot(strain, 1e-6 * axial, label="axial stress")
        axes.plot(strain, 1e-6 * lateral, ":", label="lateral stress")
        axes.set(
            xlabel="J - 1 [1e-3]", ylabel="stress [MPa]", title="One confined cell: pulled, opened, closed, pressed"
        )
        axes.legend()

    return Outcome(rows, draw)


CASES = (Case("failed_cell", "one confined cell pulled to failure, opened, closed and pressed", failed_cell),)
