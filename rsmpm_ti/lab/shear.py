"""Direct shear of intact rock under constant normal stresses."""

import math

import numpy as np

from rsmpm_ti.lab.compression import UNEVEN, residual_of, strength_of
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import LabTest, Measured, Options, Specimen
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.setups.direct_shear import shear_test
from rsmpm_ti.spec.scene import Output
from rsmpm_ti.spec.seeding import Jittered

LENGTH, CELLS, QUICK_CELLS = 50e-3, 50, 25
"""Of the block, as high as long [m], and cells along it."""

STRESSES = (0.05, 0.1, 0.2)
"""Normal stresses over UCS."""

BEYOND = 3.0
"""Displacement at the end over that of the elastic block at failure."""


def plan_shear(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    length = options.size or LENGTH
    dx = options.dx or length / (QUICK_CELLS if options.quick else CELLS)
    rock = Rock.from_sheet(sheet, dx=dx)
    criterion, elastic = rock.criterion, rock.elasticity
    asked = options.confinements
    stresses = asked or tuple(float(f"{fraction * criterion.ucs:.2g}") for fraction in STRESSES)
    found = []
    for normal in stresses:
        strength = criterion.cohesion + normal * math.tan(math.radians(criterion.friction_angle))
        reach = 2.0 * (1.0 + elastic.nu) * strength / elastic.E * length
        scene = shear_test(
            title=f"Direct shear of intact rock under {1e-6 * normal:.4g} MPa", rock=rock, dx=dx, normal_stress=normal,
            displacement_end=BEYOND * reach, length=length, height=length,
            seeding=Jittered(amount=UNEVEN, seed=seed), output=Output(frames=20, vtu=2),
        )  # fmt: skip
        label, about = f"n{1e-6 * normal:g}_seed{seed}", f"normal stress {1e-6 * normal:g} MPa, seed {seed}"
        found.append(Specimen(label=label, about=about, scene=scene, facts={"normal": normal}))
    return found


def read_shear(measured: list[Measured]) -> list[Quantity]:
    """Peaks and residuals, and the line tau = c + sigma_n tan(phi) through the peaks by least squares."""
    rock: Rock = measured[0].specimen.scene.rock
    normal = np.array([one.specimen.facts["normal"] for one in measured])
    peak = np.array([strength_of(one) for one in measured])
    known, criterion = np.isfinite(peak), rock.criterion
    slope = intercept = math.nan
    if known.sum() >= 2:
        slope, intercept = np.polyfit(normal[known], peak[known], 1)
    where = [f"at {1e-6 * n:g} MPa" for n in normal]
    peaks = [
        Quantity(name=f"peak shear stress {at}", unit="Pa", value=float(s), about="shear force over the length",
                 given=criterion.cohesion + n * math.tan(math.radians(criterion.friction_angle)))
        for at, n, s in zip(where, normal, peak, strict=True)
    ]  # fmt: skip
    residuals = [
        Quantity(name=f"residual shear stress {at}", unit="Pa", value=residual_of(one),
                 about="mean over the last tenth of the displacement")
        for at, one in zip(where, measured, strict=True)
    ]  # fmt: skip
    about = f"of a straight line through {int(known.sum())} peaks"
    return [
        Quantity(name="cohesion", unit="Pa", value=float(intercept), given=criterion.cohesion, about=about),
        Quantity(name="friction angle", unit="degrees", value=math.degrees(math.atan(slope)),
                 given=criterion.friction_angle, about=about),
        *peaks,
        *residuals,
    ]  # fmt: skip


SHEAR = LabTest(
    name="shear",
    about="shear strength of intact rock under constant normal stresses",
    method="ASTM D5607; ISRM (2014): Muralha et al., Rock Mech. Rock Eng. 47:291",
    limits=("walls press on opposite ends, so stress is uneven along the plane and rock may split before it shears: "
            "cohesion comes out too low", "walls do not rub", "a block in plane strain"),
    plan=plan_shear,
    read=read_shear,
)  # fmt: skip
