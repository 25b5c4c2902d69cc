"""A probe of the load cell: three-point bending, a test that the package does not know, in this file alone.

The load is the force of the upper roller, and the sum of the two lower ones; the stress at mid-span is beam theory's.
"""

import numpy as np
import pytest

from rsmpm_ti import (
    Body,
    Box,
    BulkViscosity,
    Domain,
    Gauge,
    GPa,
    Hooke,
    Lattice,
    Linear,
    LoadCell,
    Loading,
    Observer,
    Output,
    Platen,
    Press,
    Rock,
    Scene,
    Schedule,
    Unbreakable,
    mm,
    ms,
    simulate,
)

pytestmark = pytest.mark.thorough

SPAN, DEPTH, DX, E = 80.0 * mm, 20.0 * mm, 1.0 * mm, 17.0 * GPa
MIDDLE = 50.0 * mm
PRESSED, END = 1.2 * ms, 1.8 * ms
"""Four and six periods of the first bending mode, (2 L^2/pi) sqrt(rho A/(E I)) = 0.28 ms."""


def bending_test() -> Scene:
    """A beam of 100 x 20 mm on two rollers 80 mm apart, pressed in the middle by a third, then held.

    A roller is a platen as wide as one node. Linear functions: with wider ones nodes are folded along the whole plane
    of a platen, whatever its span, and the free faces beside the rollers would be held too.
    """
    rollers = [
        Platen(axis=1, side=side, position=y, speed=speed, span=(x - 0.2 * DX, x + 0.2 * DX))
        for side, x, y, speed in (
            ("lower", MIDDLE - 0.5 * SPAN, 0.0, 0.0),
            ("lower", MIDDLE + 0.5 * SPAN, 0.0, 0.0),
            ("upper", MIDDLE, DEPTH, -0.02),
        )
    ]
    # the nominal stress is that of beam theory at mid-span, 3 F L / (2 h^2)
    strip = Gauge(name="strip", a=(MIDDLE - 2.0 * mm, 0.0), b=(MIDDLE + 2.0 * mm, 0.0))
    cell = LoadCell(width=2.0 * DEPTH**2 / (3.0 * SPAN), gauges=(strip,))
    return Scene(
        title="Three-point bending",
        domain=Domain(lower=(-4.0 * mm, -4.0 * mm), upper=(104.0 * mm, 24.0 * mm), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(100.0 * mm, DEPTH)), seeding=Lattice()),),
        rock=Rock(
            density=2600.0, elasticity=Hooke(E=E, nu=0.0), criterion=Unbreakable(), viscosity=BulkViscosity()
        ),
        loading=Loading(boundaries=tuple(rollers), start=Press(time=PRESSED), cell=cell),
        schedule=Schedule(t_end=END, rows=120),
        shape=Linear(),
        output=Output(frames=0, movie=False, vtu=0),
    )  # fmt: skip


class Fibres(Observer):
    """sigma_xx of the particles beside mid-span, mean over the hold, by their height."""

    every = 1.0 / 120.0

    def __init__(self):
        self.seen = []

    def see(self, view) -> None:
        if view.time > PRESSED:
            x = view.snapshot.x - view.snapshot.displacement
            beside = np.abs(x[:, 0] - MIDDLE) < 0.5 * DX
            order = np.argsort(x[beside, 1], kind="stable")
            self.y, sigma = x[beside, 1][order], view.snapshot.sigma[beside, 0, 0][order]
            self.seen.append(sigma)

    def at_the_lower_face(self) -> float:
        """A parabola through the lower quarter, since particles lie a quarter of a cell and more above the face."""
        low = self.y < 0.25 * DEPTH
        return float(np.polyval(np.polyfit(self.y[low], np.mean(self.seen, axis=0)[low], 2), 0.0))


@pytest.fixture(scope="module")
def bent():
    fibres = Fibres()
    result = simulate(bending_test(), threads=1, observers=(fibres,))
    held = result.history[result.history["time_s"] > PRESSED + 0.02 * ms]
    return result, held, fibres


def test_load_is_the_force_of_the_upper_roller_and_the_sum_of_the_lower_ones(bent):
    result, held, _ = bent
    upper, lower = held["force_top_N"].mean(), held["force_bottom_N"].mean()
    assert upper > 5e3
    # what still swings in the hold: the beam's momentum changes by the difference of the two
    assert lower == pytest.approx(upper, rel=1e-3)
    assert held["stress_top_Pa"] == pytest.approx(held["force_top_N"] * 3.0 * SPAN / (2.0 * DEPTH**2), rel=1e-12)
    assert result.summary["platen_imbalance"] < 0.01, "no warning: the sides are equal but for the first waves"


def test_stress_at_mid_span_is_that_of_beam_theory(bent):
    """3 F L/(2 h^2), less what a concentrated load takes from the fibre opposite to it: 0.133 F/(h/2), Timoshenko &
    Goodier (1970), Theory of Elasticity, art. 40, after Seewald; here 4.4 %."""
    _, held, fibres = bent
    force = held["force_top_N"].mean()
    beam = 1.5 * force * SPAN / DEPTH**2 - 0.133 * force / (0.5 * DEPTH)
    # twenty cells over the depth: bilinear cells are too stiff in bending by about (dx/h)^2, 0.3 %, and the mass of the
    # rollers' nodes makes each reach half a cell to its sides, 1 mm of 80
    assert fibres.at_the_lower_face() == pytest.approx(beam, rel=0.02)
    # a strip of 4 mm sits a quarter of a cell above the face, 2.5 % of half the depth, and reads the mean over itself
    assert E * held["gauge_strip"].mean() == pytest.approx(0.975 * beam, rel=0.02)
