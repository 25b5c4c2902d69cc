"""Direct tension, and the Brazilian test, which reads a tensile strength from a disc that is pressed."""

import math

import numpy as np

from rsmpm_ti.lab.compression import UNEVEN, breakage
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import LabTest, Measured, Options, Specimen
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.setups.brazilian import brazilian_test
from rsmpm_ti.setups.uniaxial import uniaxial_test
from rsmpm_ti.spec.scene import Output
from rsmpm_ti.spec.seeding import Jittered

WIDTH, CELLS, QUICK_CELLS = 50e-3, 50, 25
"""Of a plate in tension, twice as high [m], and cells across it."""

DIAMETER, DISC_CELLS, QUICK_DISC_CELLS = 54e-3, 108, 54
"""Of a disc [m]: ISRM (1978) asks for 54 mm, an NX core; cells across it."""

ARC = 10.0
"""Half-angle of the loaded arc [degrees]: the jaws of ISRM (1978) touch 10 degrees at failure."""


def tension_in_the_middle(arc: float) -> float:
    """Tension there over 2 P/(pi D t), of a load over arcs of this half-angle [degrees]: Hondros (1959), Austral.
    J. Appl. Sci. 10:243; docs/references.md."""
    angle = math.radians(arc)
    return math.sin(2.0 * angle) / angle - 1.0


ELASTIC = (0.2, 0.8)
"""Fractions of the strength between which a modulus is fitted."""


def plan_tension(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    width = options.size or WIDTH
    dx = options.dx or width / (QUICK_CELLS if options.quick else CELLS)
    rock = Rock.from_sheet(sheet, dx=dx)
    scene = uniaxial_test(
        title="Direct tension of intact rock", rock=rock, width=width, height=2.0 * width, room=0.2 * width,
        dx=dx, speed=-2.5e-3,
        strain_end=-1.5 * _failure_strain(rock), seeding=Jittered(amount=UNEVEN, seed=seed), time_scale="auto",
        output=Output(frames=20, vtu=2),
    )  # fmt: skip
    return [Specimen(label=f"tension_seed{seed}", about=f"direct tension, seed {seed}", scene=scene)]


def _failure_strain(rock: Rock) -> float:
    elastic = rock.elasticity
    return rock.criterion.tensile_strength * (1.0 if elastic.plane_stress else 1.0 - elastic.nu**2) / elastic.E


def read_tension(measured: list[Measured]) -> list[Quantity]:
    (one,) = measured
    rock = one.specimen.scene.rock
    peak = one.summary["peak_filtered_Pa"]
    stress, strain = -nominal_stress(one.history), -one.history["axial_strain"]
    strength = math.nan if peak is None else -peak
    last = int(np.nanargmax(stress))
    part = np.flatnonzero((stress > ELASTIC[0] * stress[last]) & (stress < ELASTIC[1] * stress[last]))
    part = part[part < last]
    slope = float(np.polyfit(strain[part], stress[part], 1)[0]) if len(part) > 2 else math.nan
    elastic = rock.elasticity
    modulus = slope if elastic.plane_stress else slope * (1.0 - elastic.nu**2)
    return [
        Quantity(name="tensile strength", unit="Pa", value=strength, given=rock.criterion.tensile_strength,
                 about="peak of the tension, filtered over a quarter of a wave transit"),
        Quantity(name="E in tension", unit="Pa", value=modulus, given=elastic.E,
                 about="slope between 20 and 80 % of the strength, plane strain taken out"),
        *breakage(one),
    ]  # fmt: skip


def plan_brazilian(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    diameter = options.size or DIAMETER
    dx = options.dx or diameter / (QUICK_DISC_CELLS if options.quick else DISC_CELLS)
    rock = Rock.from_sheet(sheet, dx=dx)
    elastic, strength = rock.elasticity, rock.criterion.tensile_strength
    # elastic, between arcs: platens come closer by P/(pi R E') (2 ln(4/arc) - 1) of the diameter
    modulus = elastic.E / (1.0 if elastic.plane_stress else 1.0 - elastic.nu**2)
    strain = strength / modulus * (2.0 * math.log(4.0 / math.radians(ARC)) - 1.0)
    scene = brazilian_test(
        title="Brazilian test of intact rock", rock=rock, radius=0.5 * diameter,
        dx=dx,
        strain_end=2.5 * strain, seeding=Jittered(amount=UNEVEN, seed=seed), arc=ARC, time_scale="auto",
        output=Output(frames=20, vtu=2),
    )  # fmt: skip
    return [Specimen(label=f"brazilian_seed{seed}", about=f"disc under diametral load, seed {seed}", scene=scene)]


def read_brazilian(measured: list[Measured]) -> list[Quantity]:
    (one,) = measured
    rock = one.specimen.scene.rock
    peak, first, where = (one.summary[name] for name in
                          ("peak_filtered_Pa", "first_failure_stress_Pa", "first_failure_position_m"))  # fmt: skip
    radius = one.specimen.scene.loading.width / math.pi
    off = math.nan if where is None else math.hypot(where[0] - radius, where[1] - radius) / radius
    strength, middle = rock.criterion.tensile_strength, tension_in_the_middle(ARC)
    # at the centre the other principal stress is 3 times as large, pressing: no Griffith correction below 8 sigma_t
    return [
        Quantity(name="BTS", unit="Pa", value=math.nan if peak is None else peak, given=strength,
                 about="2 P/(pi D t) at the peak of the load"),
        Quantity(name="BTS less the arc's part", unit="Pa", value=math.nan if peak is None else middle * peak,
                 given=strength, about="tension in the middle at the peak by elasticity (Hondros 1959): the rest is "
                 "what a crack that costs energy bears beyond it"),
        Quantity(name="BTS at the first failure", unit="Pa", value=math.nan if first is None else first, given=strength,
                 about="the same when the first particle has lost half of its strength"),
        Quantity(name="place of the first failure", unit="1", value=off,
                 about="its distance from the centre over the radius: in a valid test below a third"),
        *breakage(one),
    ]  # fmt: skip


TENSION = LabTest(
    name="tension",
    about="direct tensile strength",
    method="ASTM D2936; ISRM (1978), Int. J. Rock Mech. Min. Sci. 15:99",
    limits=("a plate in plane strain, not a cylinder", "its ends are glued without holding them back sideways"),
    plan=plan_tension,
    read=read_tension,
)
BRAZILIAN = LabTest(
    name="brazilian",
    about="tensile strength of a disc under diametral load",
    method="ASTM D3967; ISRM (1978), Int. J. Rock Mech. Min. Sci. 15:99",
    limits=("a long cylinder in plane strain, not a disc half as thick as wide", "jaws that do not rub"),
    plan=plan_brazilian,
    read=read_brazilian,
)
