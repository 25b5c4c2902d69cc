"""Rows of the page's tables: numbers as texts, in units that people read."""

import math

from rsmpm_ti.lab.quantity import Quantity
from rsmpm_ti.records.files import known

UNDEFINED = "not defined"

SHEET = {
    "density": (1.0, "kg/m³", "density"),
    "E": (1e9, "GPa", "Young's modulus"),
    "nu": (1.0, "", "Poisson's ratio"),
    "phi": (1.0, "°", "friction angle"),
    "UCS": (1e6, "MPa", "uniaxial compressive strength"),
    "cohesion": (1e6, "MPa", "cohesion"),
    "sigma_t": (1e6, "MPa", "direct tensile strength"),
    "BTS": (1e6, "MPa", "Brazilian tensile strength"),
    "kind": (None, "", "kind of rock"),
    "K_Ic": (1e6, "MPa√m", "toughness"),
    "G_f": (1.0, "J/m²", "fracture energy in tension"),
    "G_f_II": (1.0, "J/m²", "fracture energy in shear"),
    "phi_r": (1.0, "°", "friction angle of broken rock"),
    "averaging_length": (1e-3, "mm", "length of the mean stress"),
    "law": (None, "", "law after failure"),
    "softening": (None, "", "softening"),
}
"""Key of a data sheet -> by what it is divided (None: a word), its unit, what it is."""


def number(value: float | None, scale: float = 1.0, digits: int = 4) -> str:
    """A number over `scale`; words where it is not defined."""
    value = known(value)
    return UNDEFINED if value is None else f"{value / scale:.{digits}g}"


def quantity_rows(report: dict) -> list[dict]:
    """Name, value, the sheet's own, difference, how it is read, and the value of each seed where there are several."""
    rows = []
    for one in report["quantities"]:
        value, given = known(one["value"]), known(one["given"])
        by_sheet, off = "", ""
        if given:
            by_sheet = shown(given, one["unit"])
            off = "" if value is None else f"{100.0 * (value / given - 1.0):+.2g} %"
        each = (
            [shown(value, one["unit"]) for value in one["values"]]
            if len(one["values"]) > 1 and value is not None
            else []
        )
        text = UNDEFINED if value is None else f"{one['shown']} {printed(one['shown_unit'])}".strip()
        rows.append({
            "name": one["name"], "value": text, "given": by_sheet, "off": off, "about": one["about"],
            "each": ", ".join(each),
        })  # fmt: skip
    return rows


def shown(value: float | None, unit: str) -> str:
    """With its unit, as the value of a `Quantity` is shown."""
    value = known(value)
    text, scaled = Quantity(name="", unit=unit, value=math.nan if value is None else value, about="").shown()
    return f"{text} {printed(scaled)}".strip()


def printed(unit: str) -> str:
    """Of a `Quantity`, as books print it."""
    return unit.replace(" m^0.5", "√m").replace("m^2", "m²")


def sheet_rows(rock: dict) -> list[dict]:
    """What the sheet holds of a rock: key, meaning, value, whether it is estimated, where it is from."""
    rows = []
    for key, (scale, unit, meaning) in SHEET.items():
        value = rock.get(key)
        if value is None:
            continue
        text = str(value) if scale is None else f"{number(value, scale)}{'' if unit in ('', '°') else ' '}{unit}"
        rows.append({
            "key": key, "meaning": meaning, "value": text, "estimated": key in rock["estimated"],
            "source": rock["sources"].get(key, ""),
        })  # fmt: skip
    return rows


RUN_NUMBERS = (
    ("particles", "particles", 1.0, 9),
    ("steps", "steps", 1.0, 9),
    ("peak [MPa]", "peak_filtered_Pa", 1e6, 4),
    ("first failure [MPa]", "first_failure_stress_Pa", 1e6, 4),
    ("failures in tension", "failed_tension", 1.0, 9),
    ("failures in shear", "failed_shear", 1.0, 9),
    ("fragments", "fragments", 1.0, 9),
    ("acoustic events", "acoustic_events", 1.0, 9),
    ("time scale", "time_scale", 1.0, 3),
    ("energy missing [%]", "energy_balance_error", 1e-2, 2),
    ("wall time [s]", "wall_s", 1.0, 3),
)
"""Heading, name in summary.json, by what it is divided, digits."""


def run_rows(report: dict) -> list[dict]:
    """One per run: where it is, what it is, its numbers as texts."""
    return [
        {
            "label": run["label"], "about": run["about"], "folder": run["folder"],
            "dx": number(run["dx_m"], 1e-3),
            "numbers": [number(run["numbers"].get(name), scale, digits) for _, name, scale, digits in RUN_NUMBERS],
            "stopped": run["numbers"].get("stopped") or "", "warnings": run["warnings"],
        }
        for run in report["runs"]
    ]  # fmt: skip


def scene_rows(report: dict) -> list[tuple[str, str]]:
    """How the first run is computed; the others differ in seed and pressure."""
    run = report["runs"][0]
    scene = run["scene"]
    sides = scene["boundaries"]
    counted = ", ".join(f"{sides.count(kind)} x {kind}" for kind in dict.fromkeys(sides))
    rows = [
        ("cell", f"{number(run['dx_m'], 1e-3)} mm"),
        ("particles", number(run["numbers"].get("particles"), digits=9)),
        ("time step", f"{number(scene['dt_s'])} s"),
        ("time scale (mass scaling)", number(run["numbers"].get("time_scale"), digits=3)),
        ("shape functions", scene["shape"]),
        ("transfer", scene["transfer"]),
        ("order of the step", scene["order"]),
        ("boundaries", counted or "none"),
        ("confining pressure", f"{number(scene['confinement_Pa'], 1e6)} MPa"),
        ("servo on the platens", "yes" if scene["servo"] else "no"),
        ("local damping", number(scene["local_damping"])),
        ("plane", "plane stress" if scene["plane_stress"] else "plane strain"),
        ("seeding", "; ".join(dict.fromkeys(scene["seeding"]))),
    ]
    turn = scene["grid_turn_deg"]
    return [*rows, ("grid turned by", f"{number(turn)}°")] if turn else rows
