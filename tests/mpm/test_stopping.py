"""Energy that boundaries take by stopping what particles bring to the nodes that they hold: it is booked."""

import numpy as np
import pytest

from rsmpm_ti.method.shape import QuadraticBSpline
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.run.run import simulate
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Output, Scene, Schedule

DX, CELLS, DENSITY = 1e-3, 20, 2600.0
ROCK = Rock(density=DENSITY, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable(), viscosity=NoViscosity())
TRANSIT = CELLS * DX / ROCK.wave_speed()


def bar(velocity: tuple[float, float], flip: float = 1.0, **platen) -> Scene:
    """A bar of two cells by twenty between smooth walls, on a platen; long enough for it to have left the platen."""
    walls = (Wall(axis=0, side=side, position=p) for side, p in (("lower", 0.0), ("upper", 2 * DX)))
    end = Platen(axis=1, side="lower", position=0.0, **platen)
    return Scene(
        title="bar",
        domain=Domain(lower=(0.0, 0.0), upper=(2 * DX, (CELLS + 3) * DX), dx=DX),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(2 * DX, CELLS * DX)), velocity=velocity),),
        rock=ROCK,
        loading=Loading(boundaries=(end, *walls), start=AtRest()),
        schedule=Schedule(t_end=4.0 * TRANSIT, cfl=0.5, rows=200),
        shape=QuadraticBSpline(),
        transfer=PicFlip(flip=flip),
        output=Output(frames=0, movie=False, vtu=0),
    )


@pytest.mark.parametrize(
    ("velocity", "parts", "least"),
    [
        ((0.0, -1.0), {"flip": 0.99}, 0.04),  # falls on a platen, beside what PIC's part takes
        ((0.5, -1.0), {"friction": 0.3}, 0.2),  # and is thrown against the walls
        ((0.0, 0.0), {"speed": 1.0}, 0.004),  # a platen that starts at once hits it
    ],
    ids=str,
)
def test_energy_is_kept_done_or_booked_where_a_bar_hits_a_platen(velocity, parts, least):
    """To 0.3 % of it, a mean over waves that beat; `least`: the part that is lost, which was booked nowhere."""
    history = simulate(bar(velocity, **parts), threads=1).history
    lost, work = history["energy_dissipated_J"], history["work_J"]
    start = 0.5 * DENSITY * 2 * DX * CELLS * DX * np.dot(velocity, velocity)
    most = start + work.max()
    missing = start + work - history["energy_kinetic_J"] - history["energy_elastic_J"] - lost
    assert abs(missing[-20:].mean()) < 3e-3 * most
    assert least * most < lost[-1] < 2.0 * least * most
    assert np.diff(lost).min() > -1e-4 * most
