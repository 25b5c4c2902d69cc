"""A circular hole in a plate under uniaxial compression, against Kirsch."""

from dataclasses import dataclass

import numpy as np

from rsmpm_ti import load_scene
from rsmpm_ti.cases.case import Case, Outcome, at_most, relative
from rsmpm_ti.cases.static_state import static_state
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Press
from rsmpm_ti.spec.regions import Box, Difference, Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice
from rsmpm_ti.verify.elastic.closed_forms import kirsch
from rsmpm_ti.verify.elastic.disc import cell_means, rms

R = 5e-3
"""Radius of the hole [m]."""

HALF = 10.0 * R
"""Half width and half height of the plate [m]: what is missing of an infinite one is 1 % at 10 R, its (R/HALF)^2."""

RING_INNER, RING_OUTER = 1.2, 3.0
"""Distances from the centre, in R, between which stress is compared."""


def plate(dx: float) -> Scene:
    """The upper right quarter: planes of symmetry are a wall on the left and a platen at rest below.

    Fitted edges: the stress at the edge comes out within 1 %, with a hole of stairs within 3 %.
    """
    rock = load_scene("intact").rock
    whole = Box(lower=(0.0, 0.0), upper=(HALF, HALF))
    quarter = Difference(whole=whole, removed=(Disc(centre=(0.0, 0.0), radius=R),))
    boundaries = (
        Platen(axis=1, side="lower", position=0.0, speed=0.0),
        Platen(axis=1, side="upper", position=HALF, speed=-2.0e-3),
        Wall(axis=0, side="lower", position=0.0),
    )
    return Scene(
        title="Quarter plate with a hole",
        domain=Domain(lower=(0.0, 0.0), upper=(HALF + R, HALF), dx=dx),
        bodies=(Body(region=quarter, seeding=Lattice(fitted=True)),),
        rock=rock,
        loading=Loading(boundaries=boundaries, start=Press(time=1e-3), width=HALF),
        schedule=Schedule(t_end=2e-3),
        shape=Linear(),
    )


@dataclass(frozen=True)
class _Axis:
    """Cells beside an axis of symmetry: r over R, tangential stress over S found and exact."""

    r: np.ndarray
    found: np.ndarray
    exact: np.ndarray

    def at_edge(self) -> float:
        """Tangential stress at r = R by least squares in a + b (R/r)^2 + c (R/r)^4, the form of Kirsch's."""
        powers = np.stack([np.ones_like(self.r), self.r**-2.0, self.r**-4.0], axis=1)
        return float(np.linalg.lstsq(powers, self.found, rcond=None)[0].sum())


def _axis(positions: np.ndarray, found: np.ndarray, exact: np.ndarray, dx: float, along: int) -> _Axis:
    k = 1 - along  # across the axis is tangential
    on = positions[:, k] < dx
    return _Axis(np.linalg.norm(positions[on], axis=1) / R, found[on, k, k], exact[on, k, k])


def kirsch_hole(full: bool) -> Outcome:
    """Stress around the hole from 1.2 R to 3 R, and the tangential stress at its crown and side by its form there.

    Tangential stress S at the crown means failure in tension at S = 2 MPa. A particle on the edge of the hole carries
    its cell's stress, not the edge's: the largest tension that any particle feels stands in a row of its own.
    """
    dx = R / (20 if full else 10)
    static = static_state(plate(dx))
    x, volume, stress = static.snapshot.x, static.snapshot.volume, static.sigma[:, :2, :2] / static.nominal
    positions, found = cell_means(x, volume, stress, dx)
    r, exact = np.linalg.norm(positions, axis=1) / R, -kirsch(positions, R)
    ring = (r > RING_INNER) & (r < RING_OUTER)
    error = found - exact
    crown, side = (_axis(positions[ring], found[ring], exact[ring], dx, along) for along in (1, 0))
    beside = (np.abs(crown.found - crown.exact).max(), np.abs(side.found / side.exact - 1.0).max())
    why = "5 % at 10 cells a radius from 1.2 R on"
    edge = "the same; of it 1 % is the plate's finite width"
    tension = np.linalg.eigvalsh(static.sigma)[:, 2].max() / static.nominal
    grain = "a particle at the edge of a hole of cells feels 10 to 30 % too much or too little"
    rows = (
        at_most("s_tt on the axis of the load, largest error / S", beside[0], 0.05, why),
        at_most("s_tt on the axis across, largest relative error", beside[1], 0.05, why),
        at_most("s_xx, s_yy, s_xy from 1.2 R to 3 R, rms / S", rms(error[ring]), 0.05, why),
        relative("s_tt at the crown / S", 1.0, crown.at_edge(), 0.05, edge),
        relative("s_tt at the side / S", -3.0, side.at_edge(), 0.05, edge),
        relative("S at which a particle feels 2 MPa [MPa]", 2.0, 2.0 / tension, 0.3, grain),
    )

    def draw(figure):
        left, right = figure.subplots(1, 2)
        for axis, colour, name in ((crown, "C0", "axis of the load"), (side, "C3", "axis across")):
            order = np.argsort(axis.r)
            left.plot(axis.r[order], axis.exact[order], color=colour, linewidth=0.9, label=f"Kirsch, {name}")
            left.plot(axis.r[order], axis.found[order], ".", color=colour, markersize=4, label="MPM, means of cells")
            left.plot(1.0, axis.at_edge(), "o", color=colour, fillstyle="none", label="MPM, continued to the edge")
        left.set(xlabel="r / R", ylabel="tangential stress / S", title=f"{R / dx:.0f} cells a radius")
        left.legend(fontsize="x-small")
        shown = r < RING_OUTER
        size = np.linalg.norm(error[shown].reshape(-1, 4), axis=1)
        image = right.scatter(
            *(positions[shown] / R).T, c=100.0 * size, s=1500.0 * dx / R, marker="s", vmin=0.0, vmax=10.0
        )
        right.set(aspect="equal", xlabel="x / R", ylabel="y / R", title="|sigma - Kirsch| / S [%]; load along y")
        figure.colorbar(image, ax=right)

    return Outcome(rows, draw)


CASES = (Case("kirsch", "stress around a circular hole in uniaxial compression", kirsch_hole),)
