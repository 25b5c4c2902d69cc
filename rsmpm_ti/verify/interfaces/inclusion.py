"""A disc of another rock in a plate under uniaxial compression, against Goodier."""

import numpy as np

from rsmpm_ti.cases.case import Case, Outcome, at_most, difference
from rsmpm_ti.cases.static_state import static_state
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.regions import Box, Difference, Disc
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice
from rsmpm_ti.verify.elastic.disc import cell_means, rms
from rsmpm_ti.verify.interfaces.closed_forms import RoundInclusion

R = 5e-3
"""Radius of the inclusion [m]."""

HALF = 12.0 * R
"""Half width and half height of the plate [m]: what is missing of an infinite one is 0.7 %, its (R/HALF)^2."""

AROUND = Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable())
STIFF = Rock(density=2900.0, elasticity=Hooke(E=68e9, nu=0.25), criterion=Unbreakable())
SOFT = Rock(density=2400.0, elasticity=Hooke(E=5e9, nu=0.3), criterion=Unbreakable())


def plate(dx: float, rock: Rock) -> Scene:
    """The upper right quarter: planes of symmetry are a wall on the left and a platen at rest below."""
    whole, disc = Box(lower=(0.0, 0.0), upper=(HALF, HALF)), Disc(centre=(0.0, 0.0), radius=R)
    corner = Box(lower=(0.0, 0.0), upper=(R, R))
    quarter = Difference(whole=corner, removed=(Difference(whole=corner, removed=(disc,)),))
    boundaries = (
        Platen(axis=1, side="lower", position=0.0, speed=0.0),
        Platen(axis=1, side="upper", position=HALF, speed=-2.0e-3),
        Wall(axis=0, side="lower", position=0.0),
    )
    return Scene(
        title="Quarter plate with an inclusion",
        domain=Domain(lower=(0.0, 0.0), upper=(HALF + R, HALF), dx=dx),
        bodies=(
            Body(region=Difference(whole=whole, removed=(disc,)), seeding=Lattice(fitted=True)),
            Body(region=quarter, seeding=Lattice(fitted=True), rock=rock),
        ),
        rock=AROUND,
        loading=Loading(boundaries=boundaries, width=HALF),
        schedule=Schedule(t_end=2e-3),
    )


def inclusion(full: bool) -> Outcome:
    """Stress in a stiff and in a soft inclusion, 0.8 R about the centre, and around it from 1.2 R to 3 R."""
    dx = R / (20 if full else 10)
    rows, shown = [], []
    for name, rock in (("stiff", STIFF), ("soft", SOFT)):
        static = static_state(plate(dx, rock))
        x, volume, stress = static.snapshot.x, static.snapshot.volume, static.sigma[:, :2, :2] / static.nominal
        positions, found = cell_means(x, volume, stress, dx)
        r = np.linalg.norm(positions, axis=1) / R
        exact = RoundInclusion(inside=rock.elasticity, around=AROUND.elasticity, radius=R)
        within, ring = r < 0.8, (r > 1.2) & (r < 3.0)
        mean = found[within].mean(axis=0)
        why = "1 % of S: 0.7 % is the plate's finite size"
        rows.append(difference(f"s_yy in the {name} inclusion / S", -exact.stress[1], mean[1, 1], 0.01, why))
        rows.append(difference(f"s_xx in the {name} inclusion / S", -exact.stress[0], mean[0, 0], 0.01, why))
        spread = rms(found[within] - mean)
        rows.append(at_most(f"spread in the {name} inclusion, rms / S", spread, 0.01, "it is uniform; the same"))
        error = rms(found[ring] + exact.stress_around(positions[ring]))
        rows.append(at_most(f"s around the {name} inclusion, rms / S", error, 0.01, why))
        shown.append((name, positions, found, -exact.stress[1]))

    def draw(figure):
        for axes, (name, positions, found, inner) in zip(figure.subplots(1, 2), shown, strict=True):
            near = np.linalg.norm(positions, axis=1) < 3.0 * R
            image = axes.scatter(*(positions[near] / R).T, c=found[near, 1, 1], s=4, marker="s")
            axes.set(aspect="equal", title=f"{name}: s_yy / S; {inner:.3f} inside", xlabel="x / R", ylabel="y / R")
            figure.colorbar(image, ax=axes)

    return Outcome(tuple(rows), draw)


CASES = (Case("inclusion", "stress in and around a round inclusion", inclusion),)
