"""Toughness: a notched beam in three-point bending, and a notched half disc.

By the load at the peak and the notch as it was cut, as the standards have it: exact for a process zone that is small
against the specimen, and too low otherwise (Bazant & Planas 1998, Fracture and Size Effect, ch. 7). By the work of
fracture, the area below the curve of load against displacement over that of the ligament (RILEM 1985, Mater. Struct.
18:285), G_f, and K = sqrt(G_f E'): of any size, but the load must be followed until it is gone. And for a beam by the
effective crack, as long as makes the specimen as soft as it is at the peak (Karihaloo & Nallathambi 1990, Eng. Fract.
Mech. 35:637). Specimens are as deep as some lengths l_ch = E' G_f/sigma_t^2 of their rock.
"""

import math

import numpy as np

from rsmpm_ti.errors import refuse
from rsmpm_ti.lab.compression import UNEVEN, breakage
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import LabTest, Measured, Options, Specimen
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.setups.bending import bending_test, plane_modulus, shape_factor
from rsmpm_ti.setups.semicircular import SPAN, semicircular_test, stress_intensity
from rsmpm_ti.spec.scene import Output
from rsmpm_ti.spec.seeding import Jittered

DEPTH, CELLS, QUICK_CELLS = 2.0, 40, 30
"""Depth of a beam, or radius of a half disc, over l_ch; cells in it. The mean stress that decides on tension is then
over l_ch/10, and delays a crack at the notch by some per cent of the load: docs/lab.md. Deeper specimens break off at
once, and their work is not read."""

NOTCH = 0.5
"""Depth of a notch over that of the beam, or the radius: ISRM (2014), 0.4 to 0.6."""

STRAIGHT = (0.1, 0.4)
"""Fractions of the peak between which a beam is as soft as its notch makes it."""

OUTPUT = Output(frames=20, vtu=2)


def characteristic_length(rock: Rock) -> float:
    """l_ch = E' G_f/sigma_t^2 [m]: Hillerborg, Modeer & Petersson (1976), Cem. Concr. Res. 6:773."""
    return plane_modulus(rock) * energy_of(rock) / rock.criterion.tensile_strength**2


def energy_of(rock: Rock) -> float:
    """G_f of a crack in tension [J/m^2]; NaN of rock that has none."""
    softening = getattr(rock.after_failure, "softening", None)
    return (softening.G_f_I or math.nan) if softening is not None else math.nan


def _sizes(sheet: DataSheet, options: Options) -> tuple[float, float]:
    """Depth or radius, and cell [m], in whole micrometres. Raises SceneError for rock without a fracture energy."""
    rock = Rock.from_sheet(sheet)
    if math.isnan(energy_of(rock)):
        raise refuse("law", sheet.law, "'lab' for a test of toughness", f"rock {sheet.name} has no fracture energy")
    size = options.size or round(DEPTH * characteristic_length(rock), 6)
    return size, options.dx or size / (QUICK_CELLS if options.quick else CELLS)


def plan_bend(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    depth, dx = _sizes(sheet, options)
    scene = bending_test(
        title="Three-point bending of a notched beam", rock=Rock.from_sheet(sheet, dx=dx), dx=dx, depth=depth,
        notch=NOTCH * depth, seeding=Jittered(amount=UNEVEN, seed=seed), output=OUTPUT,
    )  # fmt: skip
    facts = {"depth": depth, "span": 4.0 * depth, "notch": NOTCH * depth, "height": depth}
    return [Specimen(label=f"bend_seed{seed}", about=f"notched beam, seed {seed}", scene=scene, facts=facts)]


def read_bend(measured: list[Measured]) -> list[Quantity]:
    (one,) = measured
    facts = one.specimen.facts
    depth, span, notch = facts["depth"], facts["span"], facts["notch"]
    peak = largest_load(one)
    toughness = peak * span / depth**1.5 * shape_factor(notch / depth)
    nominal = 1.5 * peak * span / (depth - notch) ** 2
    crack = effective_crack(one)
    effective = peak * span / depth**1.5 * shape_factor(crack / depth)
    rock: Rock = one.specimen.scene.rock
    return [
        Quantity(
            name="K_Ic by the effective crack",
            unit="Pa m^0.5",
            value=effective,
            given=math.sqrt(energy_of(rock) * plane_modulus(rock)),
            about="by the crack that makes the beam as soft as it is at the peak",
        ),
        Quantity(name="effective crack", unit="m", value=crack, about="depth, the notch included"),
        *toughnesses(one, toughness, depth - notch),
        Quantity(name="nominal strength", unit="Pa", value=nominal, about="beam theory's stress over the notch"),
        *breakage(one),
    ]


def effective_crack(one: Measured) -> float:
    """Depth at which the crack mouth's compliance, over that of the notch, is what it is at the peak [m]."""
    from scipy.optimize import brentq

    facts, history = one.specimen.facts, one.history
    depth, notch, load, opening = facts["depth"], facts["notch"], history["force_top_N"], history["gauge_mouth_m"]
    peak = int(np.argmax(load))
    rows = np.arange(len(load))
    rising = (rows < peak) & (load > STRAIGHT[0] * load[peak]) & (load < STRAIGHT[1] * load[peak])
    if rising.sum() < 3:
        return math.nan
    softer = opening[peak] / load[peak] / float(np.polyfit(load[rising], opening[rising], 1)[0])

    def excess(crack: float) -> float:
        return mouth_compliance(crack / depth) / mouth_compliance(notch / depth) - softer

    return notch if softer <= 1.0 else brentq(excess, notch, 0.95 * depth) if excess(0.95 * depth) > 0.0 else math.nan


def mouth_compliance(ratio: float) -> float:
    """E' times the opening of a notch's mouth over the load per thickness, for a span of 4 depths: Tada, Paris & Irwin
    (2000), The Stress Analysis of Cracks Handbook, 3rd ed., 2.16; the crack's depth over the beam's."""
    v_1 = 0.76 - 2.28 * ratio + 3.87 * ratio**2 - 2.04 * ratio**3 + 0.66 / (1.0 - ratio) ** 2
    return 24.0 * ratio * v_1


def plan_scb(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    radius, dx = _sizes(sheet, options)
    scene = semicircular_test(
        title="Bending of a notched half disc", rock=Rock.from_sheet(sheet, dx=dx), dx=dx, radius=radius,
        notch=NOTCH * radius, seeding=Jittered(amount=UNEVEN, seed=seed), output=OUTPUT,
    )  # fmt: skip
    facts = {"radius": radius, "span": 2.0 * SPAN * radius, "notch": NOTCH * radius, "height": radius}
    return [Specimen(label=f"scb_seed{seed}", about=f"notched half disc, seed {seed}", scene=scene, facts=facts)]


def read_scb(measured: list[Measured]) -> list[Quantity]:
    (one,) = measured
    facts = one.specimen.facts
    radius, notch = facts["radius"], facts["notch"]
    toughness = stress_intensity(largest_load(one), radius=radius, notch=notch, span=facts["span"])
    return [*toughnesses(one, toughness, radius - notch), *breakage(one)]


def largest_load(one: Measured) -> float:
    """At the peak of the filtered load [N/m]; NaN where it has not fallen after it."""
    peak = one.summary["peak_filtered_Pa"]
    return math.nan if peak is None else peak * one.specimen.scene.loading.width


def work_of_fracture(one: Measured) -> float:
    """Area below load against displacement of the upper roller [J/m]; NaN where a tenth of the load is left."""
    load, way = one.history["force_top_N"], one.history["axial_strain"] * one.specimen.facts["height"]
    if abs(load[-1]) > 0.1 * np.max(load):
        return math.nan
    from scipy.integrate import trapezoid

    return float(trapezoid(load, way))


def toughnesses(one: Measured, toughness: float, ligament: float) -> list[Quantity]:
    rock: Rock = one.specimen.scene.rock
    modulus, energy = plane_modulus(rock), energy_of(rock)
    given = math.sqrt(energy * modulus)
    G_f = work_of_fracture(one) / ligament
    opening = float(one.history["gauge_mouth_m"][int(np.argmax(one.history["force_top_N"]))])
    return [
        Quantity(name="K_Ic by the work of fracture", unit="Pa m^0.5", value=math.sqrt(max(G_f, 0.0) * modulus),
                 given=given, about="sqrt(G_f E/(1 - nu^2))"),
        Quantity(name="K_Ic by the peak load", unit="Pa m^0.5", value=toughness, given=given,
                 about="by the depth of the notch as cut: apparent, of this size"),
        Quantity(name="work of fracture G_f", unit="J/m^2", value=G_f, given=energy,
                 about="area below the load curve over the ligament"),
        Quantity(name="peak load", unit="N/m", value=largest_load(one), about="per metre of thickness"),
        Quantity(name="crack mouth opening at the peak", unit="m", value=opening, about="between the notch's edges"),
    ]  # fmt: skip


def _limits(scene_of: str) -> tuple[str, ...]:
    return (f"{scene_of} in plane strain", "the notch is three cells wide with a round end, not a saw cut or a crack",
            "rollers do not rub")  # fmt: skip


BEND = LabTest(
    name="bend",
    about="toughness and work of fracture of a notched beam in three-point bending",
    method="RILEM (1985), Mater. Struct. 18:285; K_I of ASTM E399",
    limits=_limits("a beam"),
    plan=plan_bend,
    read=read_bend,
)
SCB = LabTest(
    name="scb",
    about="toughness of a notched half disc in three-point bending",
    method="ISRM (2014): Kuruppu et al., Rock Mech. Rock Eng. 47:267",
    limits=_limits("half a disc"),
    plan=plan_scb,
    read=read_scb,
)
