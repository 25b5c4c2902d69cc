"""Particles brought to rest between two steps: that takes energy from every mode, however often it is done."""

import pytest

from rsmpm_ti import (
    Body,
    Box,
    Domain,
    Hooke,
    InSitu,
    Linear,
    Loading,
    NoViscosity,
    Rock,
    Scene,
    Schedule,
    Unbreakable,
    Wall,
)
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.mpm.rest import bring_to_rest

pytestmark = pytest.mark.usefixtures("taichi_f64")

DX, CFL = 0.5, 0.9


@pytest.mark.parametrize("order", ["musl", "usf"])
@pytest.mark.parametrize("steps", [2, 3, 5])
@pytest.mark.thorough("3-usf", "5-musl", "5-usf")
def test_stops_of_any_rhythm_never_feed_a_body(order, steps):
    """A column that was pressed lets go. At rest a mode of frequency w has H = E (1 - (w dt)^2/4), which stops lower,
    and w dt <= 2 cfl on a lattice of linear cells: so E never exceeds its start by more than 1/(1 - cfl^2)."""
    walls = (
        Wall(axis=1, side="lower", position=0.0),
        Wall(axis=0, side="lower", position=0.0),
        Wall(axis=0, side="upper", position=DX),
    )
    scene = Scene(
        title="column",
        domain=Domain(lower=(0.0, 0.0), upper=(DX, 12.0 * DX), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(DX, 10.0 * DX))),),
        rock=Rock(
            density=2600.0, elasticity=Hooke(E=17e9, nu=0.25), criterion=Unbreakable(), viscosity=NoViscosity()
        ),
        loading=Loading(boundaries=walls, initial_stress=InSitu(axis=1, overburden=1e6, K0=0.5)),
        schedule=Schedule(t_end=1.0, cfl=CFL),
        shape=Linear(),
        order=order,
    )  # fmt: skip
    drive = set_up(scene)
    start, most = drive.survey.elastic, 0.0
    for _ in range(300):
        bring_to_rest(drive.sim, drive.clock.dt, 1.0)
        drive.take(steps)
        most = max(most, drive.survey.elastic)
    assert most <= start / (1.0 - CFL**2)
    assert drive.survey.kinetic < 0.1 * start
