"""The names of targets are those of the reports, by readings of a crafted test."""

import math

import numpy as np
import pytest

from rsmpm_ti.calibrate.experiment import found_of, planned, with_pressures
from rsmpm_ti.calibrate.targets.measured import Number, Wanted
from rsmpm_ti.calibrate.targets.names import AT, QUANTITIES, name_at, pressure_in, unit_of_name
from rsmpm_ti.calibrate.targets.parameter import Parameter, own_value
from rsmpm_ti.lab.catalogue import TESTS
from rsmpm_ti.lab.standard import Measured, Specimen
from rsmpm_ti.records.history_table import HISTORY
from rsmpm_ti.rock.sheet.data_sheet import DataSheet

GRANITE = DataSheet(density=2650.0, E=55e9, nu=0.25, UCS=160e6, sigma_t=9e6, phi=50.0, G_f=60.0, G_f_II=6e3)


def asked(*tests: str) -> Wanted:
    targets = [Number(test=test, name="UCS", unit="Pa", value=1.0, error=1.0) for test in tests]
    bounds = Parameter(key="E", lower=20e9, upper=90e9)
    return with_pressures(Wanted(parameters=(bounds,), targets=tuple(targets), runs=40, seeds=1), GRANITE)


def run_of(one: Specimen) -> Measured:
    """A load that rises straight to 100 MPa and falls to nothing."""
    names = [*(column.name for column in HISTORY.columns), "gauge_mouth_m"]
    history = np.zeros(201, dtype=[(name, float) for name in names])
    strain = np.linspace(0.0, 4e-3, 201)
    load = np.interp(strain, [0.0, 2e-3, 3e-3], [0.0, 1.0, 0.0])
    history["axial_strain"], history["lateral_strain"], history["volumetric_strain"] = (
        strain,
        -0.3 * strain,
        0.5 * strain,
    )
    history["gauge_mouth_m"] = 0.1 * strain
    for name in ("stress_top_Pa", "stress_bottom_Pa", "force_top_N", "force_bottom_N"):
        history[name] = 100e6 * load
    summary = {
        "peak_filtered_Pa": 100e6, "largest_stress_Pa": 100e6, "first_failure_stress_Pa": 90e6, "onset_stress_Pa": 80e6,
        "first_failure_position_m": [0.0, 0.0], "failed_tension": 3, "failed_shear": 4, "fragments": 2,
        "acoustic_events": 5,
    }  # fmt: skip
    if one.label.startswith("tension"):
        summary["peak_filtered_Pa"] = -100e6
        for name in ("axial_strain", "stress_top_Pa", "stress_bottom_Pa"):
            history[name] *= -1.0
    return Measured(specimen=one, history=history, summary=summary, folder=None)


@pytest.mark.parametrize("name", TESTS)
def test_names_and_units_are_those_of_the_report(name):
    plan = planned(asked(name), GRANITE)
    (seed,) = plan[name]
    measured = [run_of(one) for one in seed]
    reported = {q.name: q.unit for q in TESTS[name].read(measured) if q.name != "crack closure stress"}
    assert {q: unit_of_name(name, q) for q in reported} == reported
    assert {q for q in reported if pressure_in(name, q) is None} == set(QUANTITIES[name])
    assert set(found_of({name: [measured]}).quantities[name]) >= set(reported)


def test_pressures_stay_those_of_the_start():
    wanted = asked("triaxial", "shear", "ucs")
    assert wanted.confinements == {"triaxial": (0.0, 10e6, 20e6, 40e6), "shear": (8e6, 16e6, 32e6)}
    assert name_at("peak", 12.5e6) == "peak at 12.5 MPa" and pressure_in("triaxial", "peak at 12.5 MPa") == 12.5e6
    assert pressure_in("ucs", "peak at 12.5 MPa") is None and set(AT) == {"triaxial", "shear"}


def test_labels_of_all_tests_differ_and_write_numbers_alone():
    plan = planned(asked(*TESTS), GRANITE)
    every = [one for seeds in plan.values() for seed in seeds for one in seed]
    assert len({one.label for one in every}) == len(every) == 12
    assert all((one.scene.output.frames, one.scene.output.vtu) == (0, 0) for one in every)


def test_curve_of_a_plate_has_the_slope_of_its_rock():
    """A plate in plane strain that follows E/(1 - nu^2) is that of a rock with E."""
    (seed,) = planned(asked("ucs"), GRANITE)["ucs"]
    run = run_of(seed[0])
    strain, stress = found_of({"ucs": [[run]]}).curves["ucs"]
    plane = 1.0 - GRANITE.nu**2
    assert stress.max() == pytest.approx(100e6, rel=0.02)
    assert np.interp(0.5e-3, strain, stress) == pytest.approx(50e9 * plane * 0.5e-3, rel=0.02)
    (tension,) = planned(asked("tension"), GRANITE)["tension"]
    strain, stress = found_of({"tension": [[run_of(tension[0])]]}).curves["tension"]
    assert strain[-1] == pytest.approx(4e-3 / plane) and stress.max() == pytest.approx(100e6, rel=0.02)


COHESION = 0.5 * 160e6 * math.tan(math.radians(45.0 - 0.5 * 50.0))


@pytest.mark.parametrize(
    ("key", "value"), [("cohesion", COHESION), ("G_f", 60.0), ("phi_r", 30.0), ("averaging_length", 1e-3), ("E", 55e9)]
)
def test_start_is_what_the_sheet_says_or_what_follows(key, value):
    assert own_value(GRANITE, key) == pytest.approx(value)


def test_places_of_wide_bounds_are_by_factors():
    wide, narrow = Parameter(key="G_f", lower=1.0, upper=100.0), Parameter(key="E", lower=20e9, upper=90e9)
    assert wide.logarithmic and wide.at(0.5) == 10.0 and wide.place(10.0) == pytest.approx(0.5)
    assert not narrow.logarithmic and narrow.at(0.5) == 55e9 and narrow.place(55e9) == 0.5
    assert Parameter(key="phi_r", lower=0.0, upper=40.0).at(0.25) == 10.0
