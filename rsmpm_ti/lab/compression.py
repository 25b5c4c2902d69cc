"""Compression of intact specimens: uniaxial strength and moduli, and the strength envelope from jacketed ones."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from rsmpm_ti.lab.curve import curve_of
from rsmpm_ti.lab.drawing import cells_of, check_connected
from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.lab.standard import LabTest, Measured, Options, Specimen
from rsmpm_ti.records.history_table import nominal_stress
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.setups.uniaxial import uniaxial_test
from rsmpm_ti.spec.loading_start import Ramp
from rsmpm_ti.spec.quasi_static.servo import Servo
from rsmpm_ti.spec.scene import Output, Scene
from rsmpm_ti.spec.seeding import Jittered

WIDTH = 50e-3
"""Of a specimen, which is twice as high [m]: ASTM D7012 asks for 47 mm and a ratio of 2 to 2.5."""

CELLS, QUICK_CELLS = 50, 25
"""Across the width."""

UNEVEN = 0.01
"""Jitter of the particles, of their spacing: on a lattice two faults cross and hold each other."""

BEYOND = {False: 1.3, True: 2.2}
"""Strain at the end over that at the peak, without and with a jacket: there a fault slips until friction is left."""

DRAWN = 0.25
"""Time scale of a drawn specimen over that of an intact one of its size: it cracks at a part of the load, and a servo
slows the platens then. Of the paper's rock that is 15; `cube_lab` goes at 16, and its peak is within a per cent of slow
loading's (docs/method.md). Of other specimens and rocks that was not measured."""

LATE = 0.9
"""Fraction of the final strain from which the load is the residual one."""

PRESSURES = (0.0, 1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0)
"""Of the jackets of a triaxial set, over UCS: within 0 to UCS/2, ISRM (1983), Int. J. Rock Mech. Min. Sci. 20:285."""


def _specimen(sheet: DataSheet, options: Options, seed: int, pressure: float) -> Scene:
    drawing, width = options.drawing, options.size or WIDTH
    height, room = 2.0 * width, 0.2 * width
    outlined = drawing is not None and not drawing.is_traces
    outline, width, height = drawing.outline() if outlined else (None, width, height)
    dx = options.dx or width / (QUICK_CELLS if options.quick else CELLS)
    if outlined:
        dx, room = cells_of(width, height, dx)
    flaws = drawing.flaws(dx) if drawing is not None and drawing.is_traces else ()
    rock = Rock.from_sheet(sheet, dx=dx)
    strain = BEYOND[pressure > 0.0] * peak_strain(rock, pressure)

    def compressed(**how) -> Scene:
        scene = uniaxial_test(
            title=f"Compression of {_name(options)}{f' at {1e-6 * pressure:.4g} MPa' if pressure else ''}",
            rock=rock, dx=dx, strain_end=strain, width=width, height=height, room=room, confinement=pressure,
            output=Output(frames=20, vtu=2), **how,
        )  # fmt: skip
        return replace(scene, schedule=replace(scene.schedule, stop_after_drop=None if pressure else 0.8))

    if drawing is None:
        return compressed(seeding=Jittered(amount=UNEVEN, seed=seed), time_scale="auto")
    scene = compressed(
        seeding=Jittered(seed=seed, fitted=True), outline=outline, flaws=flaws,
        time_scale=max(1.0, DRAWN * compressed(time_scale="auto").time_scale), servo=Servo(),
    )  # fmt: skip
    check_connected(drawing.file, scene)
    return scene


def _name(options: Options) -> str:
    return "intact rock" if options.drawing is None else Path(options.drawing.file).name


def peak_strain(rock: Rock, pressure: float) -> float:
    """By Hooke and Mohr-Coulomb in plane strain, counted from the state under the pressure [Pa]."""
    elastic, criterion = rock.elasticity, rock.criterion
    added = criterion.strength(pressure) - pressure
    return added * (1.0 if elastic.plane_stress else 1.0 - elastic.nu**2) / elastic.E


def _curve(one: Measured):
    summary, scene = one.summary, one.specimen.scene
    pressure = one.specimen.facts.get("pressure", 0.0)
    peak = summary["peak_filtered_Pa"] or summary["largest_stress_Pa"]
    return curve_of(one.history, pressure=pressure, peak=peak, plane_stress=scene.rock.elasticity.plane_stress)


def strength_of(one: Measured) -> float:
    """Peak of the filtered load, the jacket's pressure included [Pa]; NaN where the load has not fallen after it."""
    peak = one.summary["peak_filtered_Pa"]
    return math.nan if peak is None else peak


def residual_of(one: Measured) -> float:
    """Mean stress over the last tenth of the strain [Pa]; NaN where the test ended before."""
    late = one.history["axial_strain"] > LATE * final_strain(one.specimen.scene)
    return float(nominal_stress(one.history)[late].mean()) if late.any() else math.nan


def final_strain(scene: Scene) -> float:
    """Of the platens at the end of a run that nothing stops."""
    schedule, start = scene.schedule, scene.loading.start
    if schedule.strain_end is not None:
        return schedule.strain_end
    ramp = start.time if isinstance(start, Ramp) else 0.0
    return scene.loading.strain_rate * (scene.t_end - 0.5 * ramp)


def plan_ucs(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    scene = _specimen(sheet, options, seed, 0.0)
    drawn = options.drawing is not None
    of = f" of {_name(options)}, stress over a width of {1e3 * scene.loading.width:.4g} mm" if drawn else ""
    return [Specimen(label=f"ucs_seed{seed}", about=f"uniaxial compression{of}, seed {seed}", scene=scene,
                     facts={"drawn": 1.0} if drawn else {})]  # fmt: skip


def read_ucs(measured: list[Measured]) -> list[Quantity]:
    (one,) = measured
    rock = one.specimen.scene.rock
    curve, summary = _curve(one), one.summary
    initiation, drawn = summary["onset_stress_Pa"], "drawn" in one.specimen.facts
    within = "not defined of a drawn specimen: its flaws and sides strain on their own" if drawn else ""
    return [
        Quantity(name="UCS", unit="Pa", value=strength_of(one), given=rock.criterion.ucs,
                 about="peak of the axial stress, filtered over a quarter of a wave transit"),
        Quantity(name="E tangent", unit="Pa", value=curve.tangent, given=rock.elasticity.E,
                 about="slope between 40 and 60 % of the peak, plane strain taken out"),
        Quantity(name="E secant", unit="Pa", value=curve.secant, given=rock.elasticity.E,
                 about="from the start to half of the peak"),
        Quantity(name="E average", unit="Pa", value=curve.average, given=rock.elasticity.E,
                 about="slope between 20 and 80 % of the peak"),
        Quantity(name="Poisson's ratio", unit="1", value=curve.nu, given=rock.elasticity.nu,
                 about="of the slopes of lateral and axial strain between 20 and 80 % of the peak"),
        Quantity(name="crack closure stress", unit="Pa", value=math.nan,
                 about="not defined: the model's rock has no open cracks to close"),
        Quantity(name="crack initiation stress", unit="Pa", value=math.nan if drawn else curve.initiation(),
                 about=within or "from which crack volumetric strain exceeds a per cent of the elastic at the peak"),
        Quantity(name="first loss of strength", unit="Pa", value=math.nan if initiation is None else initiation,
                 about="axial stress at which the first particle begins to soften, as acoustic emission would hear it"),
        Quantity(name="crack damage stress", unit="Pa", value=math.nan if drawn else curve.damage(),
                 about=within or "at which the volumetric strain turns round"),
        Quantity(name="axial strain at the peak", unit="1", value=float(curve.axial[-1]), given=peak_strain(rock, 0.0),
                 about="platen displacement over height; plane strain"),
        *breakage(one),
    ]  # fmt: skip


def breakage(one: Measured) -> list[Quantity]:
    """What broke, of any test: failures by kind, pieces, acoustic events, energies per metre of thickness."""
    summary, history = one.summary, one.history
    nan = math.nan
    counts = (
        ("failures in tension", summary["failed_tension"], "particles that lost half of their tensile strength"),
        ("failures in shear", summary["failed_shear"], "particles that lost half of their cohesion"),
        ("fragments", summary["fragments"], "pieces of intact rock at the end"),
        ("acoustic events", summary["acoustic_events"], "failures near each other in space and time are one"),
    )
    last = history[-1]
    energies = (
        ("work of the load", float(last["work_J"]), "of platens and jacket, to the end of the run"),
        ("energy dissipated", float(last["energy_dissipated_J"]), "by cracks, friction and damping"),
        ("energy stored at most", float(np.max(history["energy_elastic_J"])), "elastic energy"),
    )
    return [
        *(Quantity(name=n, unit="1", value=nan if v is None else float(v), about=about) for n, v, about in counts),
        *(Quantity(name=n, unit="J/m", value=v, about=about) for n, v, about in energies),
    ]


def pressures_of(rock: Rock, options: Options) -> tuple[float, ...]:
    """Of the jackets [Pa]: what is asked for, else parts of UCS in two digits."""
    if options.confinements is not None:
        return options.confinements
    ucs = rock.criterion.ucs
    return tuple(float(f"{fraction * ucs:.2g}") for fraction in PRESSURES)


def plan_triaxial(sheet: DataSheet, options: Options, seed: int) -> list[Specimen]:
    return [
        Specimen(
            label=f"p{1e-6 * pressure:g}_seed{seed}", about=f"confining pressure {1e-6 * pressure:g} MPa, seed {seed}",
            scene=_specimen(sheet, options, seed, pressure), facts={"pressure": pressure},
        )
        for pressure in pressures_of(Rock.from_sheet(sheet), options)
    ]  # fmt: skip


def read_triaxial(measured: list[Measured]) -> list[Quantity]:
    pressure = np.array([one.specimen.facts["pressure"] for one in measured])
    peak, residual = np.array([strength_of(one) for one in measured]), np.array([residual_of(one) for one in measured])
    rock = measured[0].specimen.scene.rock
    criterion = rock.criterion
    jacket = [f"at {1e-6 * p:g} MPa" for p in pressure]
    peaks = [
        Quantity(name=f"peak {where}", unit="Pa", value=float(s), given=criterion.strength(p),
                 about="axial stress, the pressure included")
        for where, s, p in zip(jacket, peak, pressure, strict=True)
    ]  # fmt: skip
    residuals = [
        Quantity(name=f"residual {where}", unit="Pa", value=float(s), about="mean over the last tenth of the strain")
        for where, s, p in zip(jacket, residual, pressure, strict=True)
        if p > 0.0
    ]
    return [*envelope(rock, pressure, peak), *peaks, *residuals]


def envelope(rock: Rock, pressure: np.ndarray, peak: np.ndarray) -> list[Quantity]:
    """Cohesion and friction angle of the line sigma_1 = UCS + N sigma_3 by least squares, with 95 % confidence by the
    scatter of the points about it. pressure, peak: [n] [Pa]; NaN where fewer than two are known."""
    from scipy.stats import linregress, t

    known, nan = np.isfinite(peak), math.nan
    phi = cohesion = error_phi = error_c = nan
    if known.sum() >= 2 and np.ptp(pressure[known]) > 0.0:
        line = linregress(pressure[known], peak[known])
        N, ucs, root = line.slope, line.intercept, math.sqrt(max(line.slope, 1e-12))
        phi, cohesion = math.degrees(math.asin((N - 1.0) / (N + 1.0))), ucs / (2.0 * root)
        if known.sum() > 2:
            wide = t.ppf(0.975, known.sum() - 2)
            error_phi = math.degrees(float(wide) * line.stderr / (root * (N + 1.0)))
            error_c = float(wide) * math.hypot(
                line.intercept_stderr / (2.0 * root), ucs * line.stderr / (4.0 * root**3)
            )
    about = f"of a straight line through {int(known.sum())} peaks, with 95 % confidence"
    criterion = rock.criterion
    return [
        Quantity(name="cohesion", unit="Pa", value=cohesion, error=error_c, given=criterion.cohesion, about=about),
        Quantity(name="friction angle", unit="degrees", value=phi, error=error_phi, given=criterion.friction_angle,
                 about=about),
    ]  # fmt: skip


PLANE = "plane strain: sigma_2 = nu (sigma_1 + sigma_3) follows from the load, and is not that of a cylinder"

UCS = LabTest(
    name="ucs",
    about="uniaxial compressive strength, moduli, crack stresses",
    method="ASTM D7012 method D; ISRM (1979), Int. J. Rock Mech. Min. Sci. 16:135",
    limits=(PLANE, "platens are smooth: no cone of confined rock below them", "no bedding of the ends, no open cracks"),
    plan=plan_ucs,
    read=read_ucs,
)
TRIAXIAL = LabTest(
    name="triaxial",
    about="cohesion and friction angle from specimens at several confining pressures, residual strength",
    method="ASTM D7012 method B; ISRM (1983), Int. J. Rock Mech. Min. Sci. 20:285",
    limits=(PLANE, "dry rock: no pore pressure", "the jacket follows the surface as it was at the start"),
    plan=plan_triaxial,
    read=read_triaxial,
)
