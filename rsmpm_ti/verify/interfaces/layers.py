"""Layers of two rocks, loaded along them and across them, against Backus."""

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_most, relative, seen
from rsmpm_ti.cases.static_state import Static, static_state
from rsmpm_ti.method.shape import Linear, QuadraticBSpline
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.verify.interfaces.closed_forms import across_layers, along_free_layers, along_layers

GRANITE = Rock(density=2650.0, elasticity=Hooke(E=50e9, nu=0.25), criterion=Unbreakable())
COAL = Rock(density=1400.0, elasticity=Hooke(E=4e9, nu=0.35), criterion=Unbreakable())

SIDE, THICKNESSES = 40e-3, (24e-3, 16e-3)
"""Of the block, and of its layers, granite and coal [m]."""

FRACTIONS = (0.6, 0.4)


def block(dx: float, along: bool, held: bool, shape: Linear | QuadraticBSpline | None = None) -> Scene:
    """Layers upright, along the load, or lying, across it; held: smooth walls on both sides."""
    edges, bodies = np.concatenate([[0.0], np.cumsum(THICKNESSES)]), []
    for k, (low, high) in enumerate(zip(edges[:-1], edges[1:], strict=True)):
        lower, upper = ((low, 0.0), (high, SIDE)) if along else ((0.0, low), (SIDE, high))
        bodies.append(Body(region=Box(lower=lower, upper=upper), rock=COAL if k % 2 else None))
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=0.0),
        Platen(axis=1, side="upper", position=SIDE, speed=-1.0e-3),
    )
    walls = (Wall(axis=0, side="lower", position=0.0), Wall(axis=0, side="upper", position=SIDE)) if held else ()
    room = 0.0 if held else 4.0 * dx
    return Scene(
        title="Layers of granite and coal",
        domain=Domain(lower=(-room, 0.0), upper=(SIDE + room, SIDE), dx=dx),
        bodies=tuple(bodies),
        rock=GRANITE,
        loading=Loading(boundaries=(*platens, *walls), width=SIDE),
        schedule=Schedule(t_end=1e-3),
        shape=shape or QuadraticBSpline(),
    )


def laminate(full: bool) -> Outcome:
    """Moduli of a block of two layers, the stress of each rock along them, and of both across.

    Strain jumps across an interface, where B-splines have none: they hide some 0.15 cells of the soft layer, and the
    stress of particles within three cells of it swings about the right one. Linear functions, whose strain jumps from
    cell to cell, are exact where the interface is a plane of nodes.
    """
    dx = 0.5e-3 if full else 1e-3
    rocks, why = (GRANITE.elasticity, COAL.elasticity), "1 %: 0.15 cells of 16 of the soft layer, twice as fine half"
    rows, shown = [], list[tuple[str, Static]]()
    for name, along, held, exact in (
        ("across, sides held", False, True, across_layers(rocks, FRACTIONS)),
        ("along, sides held", True, True, along_layers(rocks, FRACTIONS)),
        ("along, sides free", True, False, along_free_layers(rocks, FRACTIONS)),
    ):
        state = static_state(block(dx, along, held), press=24.0, hold=24.0)
        rows.append(relative(f"modulus {name} [Pa]", exact, state.nominal / -np.log1p(-state.strain), 0.01, why))
        shown.append((name, state))
    rock = shown[-1][1].snapshot.rock
    for k, elasticity in enumerate(rocks):
        own = shown[-1][1].sigma[rock == k]
        exact = -elasticity.E / (1.0 - elasticity.nu**2) / along_free_layers(rocks, FRACTIONS)
        found = own[:, 1, 1].mean() / shown[-1][1].nominal
        rows.append(relative(f"mean stress of rock {k} along free layers / S", exact, found, 0.01, why))
    across = shown[0][1]
    away = np.abs(across.snapshot.x[:, 1] - THICKNESSES[0]) / dx
    error = np.abs(across.sigma[:, 1, 1] / across.nominal + 1.0)
    swing = "what swings falls by three from cell to cell"
    rows.append(at_most("stress across from 4 cells on, error / S", error[away > 4.0].max(), 0.02, swing))
    rows.append(seen("the same beside the interface", error.max(), "B-splines; 0.33 where the contrast of M is 2.9"))
    straight = static_state(block(dx, along=False, held=True, shape=Linear()), press=24.0, hold=24.0)
    error = np.abs(straight.sigma[:, 1, 1] / straight.nominal + 1.0).max()
    exact = "uniform strain in each layer is a motion of linear functions; what swings is 0.1 %"
    rows.append(at_most("stress across, linear functions, error / S", error, 0.005, exact))

    def draw(figure):
        for axes, (name, state) in zip(figure.subplots(1, 3, sharey=True), shown, strict=True):
            x, y = 1e3 * state.snapshot.x.T
            image = axes.scatter(x, y, c=state.sigma[:, 1, 1] / state.nominal, s=2)
            axes.set(aspect="equal", title=name, xlabel="x [mm]")
            figure.colorbar(image, ax=axes, label="s_yy / S")

    return Outcome(tuple(rows), draw)


CASES = (Case("laminate", "moduli of layers of two rocks, along and across", laminate),)
