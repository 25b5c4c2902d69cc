"""Calibrations against a laboratory of closed forms: what is found, what is not, and what is run."""

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from fake_laboratory import GRANITE, NAN, FakeLaboratory, measured, wanted

from rsmpm_ti.calibrate.calibration import calibrate
from rsmpm_ti.calibrate.experiment import laboratory
from rsmpm_ti.calibrate.targets.measured import Curve, Found
from rsmpm_ti.calibrate.targets.parameter import with_values
from rsmpm_ti.errors import SceneError
from rsmpm_ti.lab.running import Done
from rsmpm_ti.output.lock import FILE, Lock
from rsmpm_ti.rock.sheet.reading import read_sheet

E_AND_UCS = {"E": (20e9, 90e9), "UCS": (60e6, 300e6)}
STRENGTHS = E_AND_UCS | {"sigma_t": (2e6, 25e6)}
MODULUS, STRENGTH, TENSION, BTS = ("ucs", "E tangent"), ("ucs", "UCS"), ("tension", "tensile strength"), (
    "brazilian", "BTS",
)  # fmt: skip
TOUGHNESS = ("bend", "K_Ic by the work of fracture")


@pytest.mark.parametrize("rough", [0.0, 0.005])
def test_known_parameters_are_found_within_the_errors(tmp_path, rough):
    truth = replace(GRANITE, E=38e9, UCS=110e6, sigma_t=6.5e6)
    asked = wanted(STRENGTHS, measured(truth, MODULUS, STRENGTH, TENSION))
    found = calibrate(GRANITE, asked, measure=FakeLaboratory(rough), out=tmp_path)
    assert found.met and len(list(csv.reader(open(tmp_path / "evaluations.csv")))) < 20
    for key in STRENGTHS:
        interval, value = found.uncertainty.intervals[key], getattr(truth, key)
        assert interval.identifiable and interval.lower < value < interval.upper
        assert found.best.values[key] == pytest.approx(value, rel=0.02 + 5.0 * rough)


def test_interval_is_that_of_the_error_of_a_measurement(tmp_path):
    """Of E alone, from a modulus with an error of 5 %: 1.96 x 5 % either way."""
    asked = wanted({"E": (20e9, 90e9)}, measured(replace(GRANITE, E=40e9), MODULUS))
    found = calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    interval = found.uncertainty.intervals["E"]
    assert interval.upper - interval.lower == pytest.approx(2.0 * 1.96 * 0.05 * 40e9, rel=0.01)


def test_two_parameters_that_enter_as_a_product_are_named(tmp_path):
    """K_Ic = sqrt(G_f E'): on scales of factors +1 of the one goes with -1 of the other."""
    bounds = {"E": (10e9, 150e9), "G_f": (15.0, 225.0), "UCS": (60e6, 300e6)}
    asked = wanted(bounds, measured(replace(GRANITE, G_f=80.0), TOUGHNESS, STRENGTH))
    found = calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    known = found.uncertainty
    assert {key for key, one in known.intervals.items() if not one.identifiable} == {"E", "G_f"}
    (said,) = known.unseen
    assert "+0.71 E with -0.71 G_f" in said or "+0.71 G_f with -0.71 E" in said
    record = json.loads((tmp_path / "calibration.json").read_text())
    assert record["not_told_apart"] == [said] and record["met"]
    assert [p["identifiable"] for p in record["parameters"]] == [False, False, True]


def test_parameter_that_no_target_feels_is_told(tmp_path):
    asked = wanted({"E": (20e9, 90e9), "phi_r": (5.0, 45.0)}, measured(GRANITE, MODULUS))
    found = calibrate(replace(GRANITE, E=30e9), asked, measure=FakeLaboratory(), out=tmp_path)
    assert found.uncertainty.unseen == ("the targets hardly depend on phi_r within its bounds",)
    assert found.uncertainty.intervals["E"].identifiable


class Stopped(Exception):
    pass


def test_stopped_calibration_goes_on_and_runs_nothing_twice(tmp_path):
    asked = wanted(STRENGTHS, measured(replace(GRANITE, E=38e9, UCS=110e6), MODULUS, STRENGTH, BTS, TOUGHNESS))
    whole = FakeLaboratory()
    expected = calibrate(GRANITE, asked, measure=whole, out=tmp_path / "whole")

    def stops(sheet):
        if len(first.calls) > 5:
            raise Stopped
        return ""

    first, second, third = FakeLaboratory(fails=stops), FakeLaboratory(), FakeLaboratory()
    with pytest.raises(Stopped):
        calibrate(GRANITE, asked, measure=first, out=tmp_path / "parts")
    found = calibrate(GRANITE, asked, measure=second, out=tmp_path / "parts")
    assert len(second.calls) == len(whole.calls) - 5 and first.calls[:5] + second.calls == whole.calls
    assert found.best.values == expected.best.values and found.ended == expected.ended
    calibrate(GRANITE, asked, measure=third, out=tmp_path / "parts")
    assert third.calls == []


def test_other_targets_use_what_is_kept_and_other_code_does_not(tmp_path, monkeypatch):
    targets = measured(GRANITE, MODULUS, STRENGTH)
    calibrate(GRANITE, wanted(E_AND_UCS, targets), measure=FakeLaboratory(), out=tmp_path)
    closer, other = FakeLaboratory(), FakeLaboratory()
    calibrate(GRANITE, wanted(E_AND_UCS, measured(GRANITE, MODULUS, STRENGTH, error=0.04)), measure=closer,
              out=tmp_path)  # fmt: skip
    assert closer.calls == []
    monkeypatch.setattr("rsmpm_ti.calibrate.evaluations.code", lambda: "changed")
    calibrate(GRANITE, wanted(E_AND_UCS, targets), measure=other, out=tmp_path)
    assert other.calls


def test_folder_is_of_one_calibration_at_a_time(tmp_path):
    asked = wanted(E_AND_UCS, measured(GRANITE, MODULUS, STRENGTH))
    with Lock(tmp_path), pytest.raises(SceneError, match="another process|process .* has"):
        calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    assert not (tmp_path / FILE).exists()


def test_trouble_of_the_machine_is_no_failure_of_the_rock(tmp_path, monkeypatch):
    """A full disk ends the calibration; an unstable specimen is a point that failed. Only the latter is kept."""
    asked = wanted(E_AND_UCS, measured(GRANITE, STRENGTH))
    done = Done("ucs_seed1", 1.0, "unstable at step 7", unstable=True)
    monkeypatch.setattr("rsmpm_ti.calibrate.experiment.run_all", lambda *_, **__: iter([done]))
    assert laboratory(asked)(GRANITE, tmp_path).problem == "ucs_seed1: unstable at step 7"
    done = Done("ucs_seed1", 1.0, "no space left on the disk")
    monkeypatch.setattr("rsmpm_ti.calibrate.experiment.run_all", lambda *_, **__: iter([done]))
    with pytest.raises(SceneError, match="no space left"):
        calibrate(GRANITE, asked, measure=laboratory(asked), out=tmp_path / "full")
    assert list((tmp_path / "full" / "evaluations").iterdir()) == []


def test_damaged_evaluation_is_run_again(tmp_path):
    asked = wanted(E_AND_UCS, measured(GRANITE, MODULUS, STRENGTH))
    calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    files = sorted((tmp_path / "evaluations").iterdir())
    for file, text in zip(files, ("", '{"quantities": 3}', "[[[["), strict=False):
        file.write_text(text)
    again = FakeLaboratory()
    calibrate(GRANITE, asked, measure=again, out=tmp_path)
    assert len(again.calls) == min(3, len(files))


@pytest.mark.parametrize("runs", [6, 9, 14])
def test_budget_is_kept_and_leaves_the_differences(tmp_path, runs):
    truth = replace(GRANITE, E=25e9, UCS=70e6)
    asked = wanted(E_AND_UCS, measured(truth, MODULUS, STRENGTH, error=1e-6), runs)
    laboratory = FakeLaboratory(rough=0.01)
    found = calibrate(GRANITE, asked, measure=laboratory, out=tmp_path)
    assert len(laboratory.calls) <= runs and found.uncertainty is not None
    assert not found.met and ("budget" in found.ended or len(laboratory.calls) < runs)


def test_larger_budget_goes_on_from_the_smaller(tmp_path):
    truth = replace(GRANITE, E=25e9, UCS=70e6)
    asked = wanted(E_AND_UCS, measured(truth, MODULUS, STRENGTH, error=1e-4), 6)
    first, second = FakeLaboratory(), FakeLaboratory()
    short = calibrate(GRANITE, asked, measure=first, out=tmp_path)
    long = calibrate(GRANITE, replace(asked, runs=30), measure=second, out=tmp_path)
    assert long.best.misfit < short.best.misfit
    assert not {str(sheet) for sheet in first.calls} & {str(sheet) for sheet in second.calls}


@pytest.mark.parametrize("nan", [False, True])
def test_points_that_fail_are_penalised_and_told(tmp_path, nan):
    """Rock below 80 MPa comes to no end, and the search, which steps there, comes back."""

    class Failing(FakeLaboratory):
        def __call__(self, sheet, folder):
            found = super().__call__(sheet, folder)
            if sheet.UCS >= 80e6:
                return found
            if not nan:
                return Found(problem="unstable")
            found.quantities["ucs"]["UCS"] = NAN
            return found

    truth = replace(GRANITE, E=30e9, UCS=82e6)
    asked = wanted(E_AND_UCS, measured(truth, MODULUS, STRENGTH, error=0.01))
    found = calibrate(replace(GRANITE, UCS=84e6), asked, measure=Failing(), out=tmp_path)
    assert found.met and found.best.values["UCS"] == pytest.approx(82e6, rel=0.02)
    record = json.loads((tmp_path / "calibration.json").read_text())
    problem = "ucs.UCS is not defined" if nan else "unstable"
    start = replace(GRANITE, UCS=70e6)
    begun = calibrate(start, asked, measure=Failing(), out=tmp_path / "from_below")
    assert begun.best.values["UCS"] > 80e6
    record = json.loads((tmp_path / "from_below" / "calibration.json").read_text())
    assert {one["problem"] for one in record["failed"]} == {problem} and record["failed"][0]["number"] == 1


def test_rock_that_contradicts_itself_costs_no_run_and_is_told(tmp_path):
    """phi above what UCS and sigma_t allow: the sheet refuses it."""
    asked = wanted({"UCS": (20e6, 200e6), "sigma_t": (2e6, 60e6)}, measured(GRANITE, STRENGTH, TENSION))
    laboratory = FakeLaboratory()
    found = calibrate(replace(GRANITE, UCS=180e6, sigma_t=12e6), asked, measure=laboratory, out=tmp_path)
    assert found.met
    worst = wanted({"sigma_t": (30e6, 60e6)}, measured(GRANITE, TENSION), runs=6)
    assert calibrate(GRANITE, worst, measure=laboratory, out=tmp_path / "never") is None
    with open(tmp_path / "never" / "evaluations.csv") as file:
        rows = list(csv.DictReader(file))
    assert rows and all("Mohr-Coulomb" in row["problem"] for row in rows)


def test_none_is_fitted_where_nothing_comes_to_an_end(tmp_path):
    laboratory = FakeLaboratory(fails=lambda sheet: "unstable")
    asked = wanted(E_AND_UCS, measured(GRANITE, STRENGTH), runs=6)
    assert calibrate(GRANITE, asked, measure=laboratory, out=tmp_path) is None
    assert len(laboratory.calls) == 6 and not (tmp_path / "fitted.toml").exists()


def test_fitted_sheet_is_the_rock_that_was_run(tmp_path):
    sheet = replace(
        GRANITE, G_f=None, K_Ic=1.4e6, estimated=("K_Ic", "phi"), source='Report "12"',
        sources=(("K_Ic", "a guess"), ("phi", "a middle\nvalue")),
    )  # fmt: skip
    asked = wanted({"E": (20e9, 90e9), "G_f": (10.0, 200.0)}, measured(GRANITE, MODULUS, TOUGHNESS))
    found = calibrate(sheet, asked, measure=FakeLaboratory(), out=tmp_path)
    fitted = read_sheet(tmp_path / "fitted.toml")
    assert fitted == found.fitted() == with_values(sheet, found.best.values, why=dict(fitted.sources)["E"])
    assert fitted.K_Ic is None and set(fitted.estimated) == {"phi", "E", "G_f"}
    assert dict(fitted.sources)["G_f"].startswith("calibrated to ucs.E tangent 54.45 ± 2.7 GPa, bend.K_Ic by")
    assert dict(fitted.sources)["phi"] == "a middle\nvalue"


def test_curve_fixes_what_comes_after_the_peak(tmp_path):
    truth = replace(GRANITE, UCS=140e6, G_f_II=9e4, E=45e9)
    strain, stress = FakeLaboratory()(truth, None).curves["ucs"]
    curve = Curve(test="ucs", file="c.csv", strain=strain[::5], stress=stress[::5], error=2e6)
    bounds = E_AND_UCS | {"G_f_II": (1e4, 1e5)}
    targets = [curve, *measured(truth, MODULUS, STRENGTH, error=0.01)]
    found = calibrate(replace(GRANITE, G_f_II=5e4), wanted(bounds, targets, 60), measure=FakeLaboratory(), out=tmp_path)
    assert found.met
    for key in bounds:
        assert found.best.values[key] == pytest.approx(getattr(truth, key), rel=0.05)


def test_picture_and_table_are_written(tmp_path):
    asked = wanted(E_AND_UCS, measured(GRANITE, MODULUS, STRENGTH))
    calibrate(GRANITE, asked, measure=FakeLaboratory(), out=tmp_path)
    assert (tmp_path / "convergence.png").stat().st_size > 10_000
    with open(tmp_path / "evaluations.csv") as file:
        rows = list(csv.DictReader(file))
    assert [int(row["number"]) for row in rows] == list(range(1, len(rows) + 1))
    assert np.isfinite([float(row["ucs.UCS [Pa]"]) for row in rows]).all()
