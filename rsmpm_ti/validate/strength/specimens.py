"""Intact specimens in a pressure vessel, compressed or extended by the real solver until the first particle fails.

A uniform state fails at its criterion, so that the strength of the first failure is what criterion and test make of it;
what comes after is the law of broken rock, which has cases of its own. Plane strain from the hydrostatic state: the
stress out of the plane changes by nu times the axial change and stays between the others (docs/verification.md,
`triaxial`), as it does in the vessel, where it is the jacket's.
"""

import math
from dataclasses import replace

from rsmpm_ti import load_rock, simulate, uniaxial_test
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.validate.experiment import Input

CELLS, QUICK_CELLS = 25, 12
"""Across a width of 50 mm."""

WIDTH = 50e-3

BEYOND = 1.05
"""Strain at the end over that at which Hooke's law reaches the criterion."""


def rock_like(name: str, criterion) -> Rock:
    """Density and elasticity of a rock of the shelf, breaking at another criterion by the paper's rule."""
    of_shelf = load_rock(name)
    return Rock(density=of_shelf.density, elasticity=of_shelf.elasticity, criterion=criterion)


def of_the_shelf(name: str, *, tension: float | None = None) -> tuple[Input, ...]:
    """What `rock_like` takes of the shelf, and the tensile strength [Pa] where that is none of the case's own."""
    elastic, source = load_rock(name).elasticity, f"shelf, scenes/rocks/{name}.toml"
    found = (Input("E", elastic.E, "Pa", source), Input("nu", elastic.nu, "1", source))
    return found if tension is None else (*found, Input("tensile_strength", tension, "Pa", source))


def axial_strength(rock: Rock, pressure: float, *, expected: float, full: bool) -> float:
    """Axial stress at the first failure under `pressure` [Pa], compression positive; NaN where nothing fails.

    expected: the criterion's own axial stress [Pa]. It says how far to strain; below the pressure the test is one of
    extension.
    """
    elastic = rock.elasticity
    strain = BEYOND * (expected - pressure) * (1.0 - elastic.nu**2) / elastic.E
    scene = uniaxial_test(
        title="Intact specimen in a pressure vessel",
        rock=rock,
        dx=WIDTH / (CELLS if full else QUICK_CELLS),
        width=WIDTH,
        height=2.0 * WIDTH,
        room=0.2 * WIDTH,
        speed=math.copysign(2.5e-3, strain),
        strain_end=strain,
        confinement=pressure,
        time_scale="auto",
    )
    scene = replace(scene, schedule=replace(scene.schedule, stop_after_drop=0.5))
    summary = simulate(scene, threads=1).summary
    found = summary["first_failure_stress_Pa"]
    return math.nan if found is None else float(found)
