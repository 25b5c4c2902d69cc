"""Strength of a plate in uniaxial tension, equal biaxial tension and pure shear, by the real solver.

Three of the nine challenge problems for models of fracture by Kamarei, Zeng, Dolbow & Lopez-Pamies (2025), "Nine
circles of elastic brittle fracture", Comput. Methods Appl. Mech. Eng., arXiv:2507.00266: what breaks under a uniform
stress has to break at the strength that it was given, whatever its toughness. Predicted: the stress at the peak of a
whole plate of `lab_rock` in plane stress, held against its criterion, Mohr-Coulomb with a tension cut-off: sigma_t in
all three, since in pure shear the cut-off is reached before c cos(phi).

Others of the nine are other cases: a crack that grows steadily between two arms is `cantilever`, and strength passing
into toughness with the depth of an edge notch is `edge_notch`. What needs three dimensions, torsion for one, or a body
that does not compress, is not drawn: the law of cracked rock is one of two dimensions and of small elastic strains.
"""

import math
from dataclasses import replace

from rsmpm_ti import lab_rock, simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.method.transfer import PicFlip
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Jittered
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import compare
from rsmpm_ti.validate.experiment import Experiment, Input

SIZE = 40.0 * mm

CELLS, QUICK_CELLS = 30, 12
"""Across the plate; the mean is over two."""

SPEED, TRANSITS, TIME_SCALE = 2.5e-3, 8.0, 2.0
"""Of the platens that pull [m/s]; wave transits that their start takes; the time scale."""

BEYOND = 1.15
"""Strain at the end over that at which Hooke's law reaches the criterion."""

PATHS = {"uniaxial tension": None, "equal biaxial tension": 1.0, "pure shear": -1.0}
"""Stress across over the one along which is pulled; None: the sides are free."""


def criterion_stress(rock: Rock, ratio: float) -> float:
    """Stress along which is pulled [Pa] at which the criterion is reached; the stress out of the plane is 0."""
    of = rock.criterion
    slope = math.tan(math.radians(45.0 + 0.5 * of.friction_angle)) ** 2
    shear = of.ucs / (slope - min(ratio, 0.0))
    return min(of.tensile_strength, shear)


def peak(rock: Rock, ratio: float | None, dx: float) -> float:
    """Nominal stress at the peak [Pa]."""
    elastic = rock.elasticity
    strain = criterion_stress(rock, ratio or 0.0) / elastic.E * (1.0 - elastic.nu * (ratio or 0.0))
    platens = [
        Platen(axis=1, side="lower", position=0.0, speed=-SPEED, pulls=True),
        Platen(axis=1, side="upper", position=SIZE, speed=SPEED, pulls=True),
    ]
    if ratio is not None:  # in a plate of plane stress the strains are as the stresses where these are equal in size
        platens += [
            Platen(axis=0, side="lower", position=0.0, speed=-ratio * SPEED, pulls=True),
            Platen(axis=0, side="upper", position=SIZE, speed=ratio * SPEED, pulls=True),
        ]
    room = 4.0 * dx
    scene = Scene(
        title="Plate under a uniform stress",
        domain=Domain(lower=(-room, -room), upper=(SIZE + room, SIZE + room), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(SIZE, SIZE)), seeding=Jittered(amount=0.1, seed=1)),),
        rock=rock,
        loading=Loading(
            boundaries=tuple(platens), start=Ramp(time=TRANSITS * SIZE / rock.wave_speed(TIME_SCALE)),
            time_scale=TIME_SCALE, width=SIZE,
        ),
        schedule=Schedule(strain_end=-BEYOND * strain, stop_after_drop=0.3),
        transfer=PicFlip(),
    )  # fmt: skip
    found = simulate(scene, threads=1).summary["peak_filtered_Pa"]
    return math.nan if found is None else -float(found)


def uniform_stress(full: bool) -> Outcome:
    dx = SIZE / (CELLS if full else QUICK_CELLS)
    rock = lab_rock(length=2.0 * dx)
    rock = replace(rock, elasticity=replace(rock.elasticity, plane_stress=True))
    found = {name: peak(rock, ratio, dx) for name, ratio in PATHS.items()}
    theory = {name: criterion_stress(rock, ratio or 0.0) for name, ratio in PATHS.items()}
    rows = tuple(
        compare(name, "MPa", theory[name] / MPa, got / MPa, 0.05, "the criterion it was given")
        for name, got in found.items()
    )

    def draw(figure):
        axes = figure.subplots()
        ratios = [0.02 * k for k in range(-100, 51)]
        along = [criterion_stress(rock, ratio) / MPa for ratio in ratios]
        axes.plot([s * r for s, r in zip(along, ratios, strict=True)], along, "k-", lw=0.9, label="criterion")
        for name, ratio in PATHS.items():
            axes.plot(found[name] * (ratio or 0.0) / MPa, found[name] / MPa, "o", label=name)
        axes.set(xlabel="stress across [MPa]", ylabel="stress along which is pulled [MPa]", ylim=(0.0, 2.6),
                 aspect="equal", title="Strength under a uniform stress")  # fmt: skip
        axes.legend(loc="lower right")

    return Outcome(rows, draw)


GIVEN = "rock of the package, `lab_rock`"

CASES = (
    Experiment(
        "circles", "whole plate in tension, biaxial tension and shear: breaks at the strength that it was given",
        uniform_stress,
        inputs=(
            Input("E", 17e9, "Pa", GIVEN),
            Input("nu", 0.14, "1", GIVEN),
            Input("tensile_strength", 2e6, "Pa", GIVEN),
            Input("cohesion", 5.95e6, "Pa", GIVEN),
            Input("friction_angle", 40.0, "degrees", GIVEN),
            Input("G_f_I", 5.0, "J/m^2", GIVEN),
        ),
    ),
)  # fmt: skip
