"""A laboratory of closed forms, which counts what it is asked: for tests of calibration."""

import math

import numpy as np

from rsmpm_ti.calibrate.targets.measured import Curve, Found, Number, Wanted
from rsmpm_ti.calibrate.targets.parameter import Parameter
from rsmpm_ti.rock.sheet.data_sheet import DataSheet

GRANITE = DataSheet(name="granite", density=2650.0, E=55e9, nu=0.25, UCS=160e6, sigma_t=9e6, phi=50.0, G_f=60.0)

NAN = float("nan")


class FakeLaboratory:
    """Simulated strengths are a little off those of the sheet, as real ones are. rough: relative roughness of every
    number; fails: of a sheet, why it comes to no end."""

    def __init__(self, rough: float = 0.0, fails=lambda sheet: ""):
        self.calls: list[DataSheet] = []
        self.rough, self.fails = rough, fails

    def __call__(self, sheet: DataSheet, folder) -> Found:
        self.calls.append(sheet)
        if problem := self.fails(sheet):
            return Found(problem=problem, seconds=1.0)
        modulus = sheet.E / (1.0 - sheet.nu**2)
        ucs, tension = 0.97 * sheet.compressive_strength, 1.04 * sheet.tensile_strength
        strain = np.linspace(0.0, 2.0 * ucs / sheet.E, 400)
        stress = np.interp(strain, [0.0, ucs / sheet.E, ucs / sheet.E + sheet.shear_energy / ucs], [0.0, ucs, 0.0])
        quantities = {
            "ucs": {
                "UCS": ucs, "E tangent": 0.99 * sheet.E,
                "crack initiation stress": 0.4 * ucs + 2.0 * tension,
            },
            "brazilian": {"BTS": 1.1 * tension * (1.0 + 0.1 * (sheet.tension_energy / 60.0 - 1.0))},
            "tension": {"tensile strength": tension},
            "bend": {"K_Ic by the work of fracture": math.sqrt(sheet.tension_energy * modulus)},
        }  # fmt: skip
        if self.rough:
            seed = int(1e6 * (sheet.E / 1e9 + ucs / 1e6 + tension / 1e6 + sheet.tension_energy)) % 2**32
            factor = iter(1.0 + self.rough * np.random.default_rng(seed).standard_normal(20))
            quantities = {test: {name: value * next(factor) for name, value in names.items()}
                          for test, names in quantities.items()}  # fmt: skip
        return Found(quantities=quantities, curves={"ucs": (strain, stress)}, seconds=1.0)


UNITS = {"K_Ic by the work of fracture": "Pa m^0.5"}


def number(test: str, name: str, value: float, error: float) -> Number:
    """error: over the value."""
    return Number(test=test, name=name, unit=UNITS.get(name, "Pa"), value=value, error=error * value)


def wanted(bounds: dict[str, tuple[float, float]], targets: list[Number | Curve], runs: int = 40) -> Wanted:
    parameters = tuple(Parameter(key=key, lower=low, upper=high) for key, (low, high) in bounds.items())
    return Wanted(parameters=parameters, targets=tuple(targets), runs=runs, seeds=1)


def measured(truth: DataSheet, *names: tuple[str, str], error: float = 0.05) -> list[Number]:
    """Targets as a laboratory finds them of a rock."""
    found = FakeLaboratory()(truth, None).quantities
    return [number(test, name, found[test][name], error) for test, name in names]
