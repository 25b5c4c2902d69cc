"""Coulomb friction of platens on what truly presses: the pressure of the jacket, whose force nodes do not show.

A jacketed block between two rough platens is pushed sideways by a body force b. The platens press with p on each end,
so that friction bears mu p A on each: the block stays as long as b < b_c = 2 mu p/(rho H), and beyond that moves off
with b - b_c, as a whole but for its shearing. It is let slide at mu = 0.2: at 0.5 what slides begins to flutter, as an
elastic body on a rigid one may, and FLIP, which damps nothing, lets it.
"""

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Case, Outcome, Row, at_most, relative
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import BulkViscosity
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule

E, DENSITY, SIDE, PRESSURE = 17e9, 2600.0, 20e-3, 10e6
HOLDING, SLIDING = 0.5, 0.2
"""Coefficients of friction of the block that stays and of the one that slides."""


def bears(mu: float) -> float:
    """b_c [m/s^2]."""
    return 2.0 * mu * PRESSURE / (DENSITY * SIDE)


def pushed(dim: int, axis: int, mu: float, factor: float, dx: float) -> Scene:
    """The block, its platens across `axis`, pushed along the next one by b = factor b_c."""
    along = (axis + 1) % dim
    room = tuple(0.0 if d == axis else 6.0 * dx for d in range(dim))
    platens = tuple(
        Platen(axis=axis, side=side, position=place, speed=0.0, friction=mu)
        for side, place in (("lower", 0.0), ("upper", SIDE))
    )
    return Scene(
        title="a jacketed block between rough platens",
        domain=Domain(lower=tuple(-r for r in room), upper=tuple(SIDE + r for r in room), dx=dx),
        bodies=(Body(region=Box(lower=(0.0,) * dim, upper=(SIDE,) * dim)),),
        rock=Rock(
            density=DENSITY,
            elasticity=Hooke(E=E, nu=0.0),
            criterion=Unbreakable(),
            viscosity=BulkViscosity(),
        ),
        loading=Loading(
            boundaries=platens, confinement=PRESSURE, width=SIDE ** (dim - 1),
            body_force=tuple(factor * bears(mu) if d == along else 0.0 for d in range(dim)),
        ),
        schedule=Schedule(t_end=2e-4),
    )  # fmt: skip


def block(dim: int, axis: int, dx: float) -> list[Row]:
    along, name = (axis + 1) % dim, f"{dim}D, platens across axis {axis}"
    held = simulate(pushed(dim, axis, HOLDING, 0.5, dx))
    way = held.snapshot.displacement[:, along].mean()
    flight = 0.5 * (0.5 * bears(HOLDING)) * held.history["time_s"][-1] ** 2
    # sheared between platens that hold it: rho b H^2/12 G in the mean, twice that while it swings
    shear = DENSITY * 0.5 * bears(HOLDING) * SIDE**2 / (12.0 * 0.5 * E)
    slid = simulate(pushed(dim, axis, SLIDING, 2.0, dx))
    speed = slid.snapshot.velocity[:, along].mean()
    why = "corners: at a platen's edge nodes hold half a cell's rock, and slip begins there before the rest"
    return [
        at_most(
            f"{name}: way at b_c/2, of free flight", way / flight, 2.0 * shear / flight, "its elastic shear, swinging"
        ),
        relative(f"{name}: speed at 2 b_c [m/s]", bears(SLIDING) * slid.history["time_s"][-1], float(speed), 0.03, why),
    ]


def friction(full: bool) -> Outcome:
    """2D across y; full: every axis in 2D and 3D, and a finer one."""
    ways = [(2, 1, 2e-3)] + [(2, 0, 2e-3), (2, 1, 1e-3), (3, 0, 2e-3), (3, 1, 2e-3), (3, 2, 2e-3)] * full
    rows = [row for way in ways for row in block(*way)]

    def draw(figure):
        axes = figure.subplots()
        for k, row in enumerate(rows):
            axes.barh(k, row.got / max(row.reference, row.tolerance), color="tab:blue" if row.passed else "tab:red")
        axes.set_yticks(range(len(rows)), [row.quantity for row in rows], fontsize=7)
        axes.axvline(1.0, color="k", linewidth=0.8)
        axes.set(xlabel="of the speed by Coulomb's law, and of the shear that may be", title="friction under a jacket")

    return Outcome(tuple(rows), draw)


CASES = (Case("lab_friction", "a jacketed block between rough platens stays and slides as Coulomb says", friction),)
