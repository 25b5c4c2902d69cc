"""What makes a result doubtful is said, and nothing else."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rsmpm_ti import Rock
from rsmpm_ti.lab.bending import plan_bend
from rsmpm_ti.lab.standard import Measured, Options, Specimen
from rsmpm_ti.lab.tension import plan_brazilian
from rsmpm_ti.lab.validity import doubts_of
from rsmpm_ti.rock.sheet.data_sheet import DataSheet
from rsmpm_ti.setups.uniaxial import uniaxial_test

SHEET = dict(density=2650.0, E=55e9, nu=0.25, UCS=160e6, sigma_t=9e6, phi=50.0)
STRONG = SHEET | {"G_f": 64.0, "G_f_II": 6400.0}


def measured(scene=None, **summary) -> Measured:
    """A test of 100 rows whose load falls at 60 % of its strain, without anything wrong."""
    if scene is None:
        rock = Rock.from_lab(**STRONG, dx=1e-3)
        scene = uniaxial_test(title="t", rock=rock, dx=1e-3, strain_end=5e-3, width=20e-3, height=40e-3)
    numbers = {
        "peak_filtered_Pa": 160e6, "peak_filtered_strain": 3e-3, "first_failure_position_m": [0.01, 0.02],
        "energy_balance_error": 1e-3, "numerical_fracture": None, "warnings": [],
    }  # fmt: skip
    history = np.zeros(100, dtype=[(n, float) for n in ("axial_strain", "energy_elastic_J", "energy_kinetic_J")])
    history["axial_strain"] = np.linspace(0.0, 5e-3, 100)
    history["energy_elastic_J"] = 100.0 * np.minimum(history["axial_strain"], 3e-3) / 3e-3
    history["energy_kinetic_J"] = np.where(history["axial_strain"] > 3.1e-3, 50.0, 0.1)  # a collapse after the peak
    one = Specimen(label="one", about="", scene=scene)
    return Measured(specimen=one, history=history, summary=numbers | summary, folder=Path("one"))


def test_sound_test_is_not_doubted():
    assert doubts_of("ucs", measured()) == []


@pytest.mark.parametrize(
    ("changed", "grave", "words"),
    [
        ({"peak_filtered_Pa": None, "peak_filtered_strain": None}, True, "no peak"),
        ({"peak_filtered_strain": 4.95e-3}, True, "of the run's strain"),
        ({"energy_balance_error": 0.03}, False, "3 % of the energy"),
        ({"numerical_fracture": "intact particles have parted"}, True, "have parted"),
        ({"warnings": ["the first failure is 0.5 cells from the platen at 0 mm: ..."]}, True, "cells from the platen"),
    ],
)
def test_each_fault_is_said(changed, grave, words):
    one = measured(**changed)
    one.history["energy_kinetic_J"] = 0.1
    (doubt,) = doubts_of("ucs", one)
    assert doubt.grave == grave and words in doubt.sentence and doubt.label == "one"


def test_load_that_is_inertia_is_no_strength():
    one = measured()
    one.history["energy_kinetic_J"][40] = 10.0
    (doubt,) = doubts_of("ucs", one)
    assert doubt.grave and "quasi-static" in doubt.sentence


def test_cells_that_are_too_coarse_for_the_process_zone_are_said():
    """l_ch = E' G_f/sigma_t^2 = 46 mm: half of it is 4 cells of 5.8 mm."""
    rock = Rock.from_lab(**STRONG | {"averaging_length": 20e-3})
    scene = uniaxial_test(title="t", rock=rock, dx=6e-3, strain_end=5e-3, width=60e-3, height=120e-3)
    assert any("process zone" in doubt.sentence for doubt in doubts_of("ucs", measured(scene)))
    finer = uniaxial_test(title="t", rock=rock, dx=5e-3, strain_end=5e-3, width=60e-3, height=120e-3)
    assert doubts_of("ucs", measured(finer)) == []


def test_beam_that_is_not_broken_through_has_no_work_of_fracture():
    """Two lengths l_ch deep, with a notch of half of that: its ligament is one length."""
    (one,) = plan_bend(DataSheet(**STRONG), Options(quick=True), 1)
    found = replace(measured(one.scene), specimen=one)
    found.summary["peak_filtered_strain"] = 0.5 * one.scene.schedule.strain_end
    load = np.where(found.history["axial_strain"] < 3e-3, found.history["axial_strain"], 1e-3)
    names = [*found.history.dtype.names, "force_top_N"]
    history = np.zeros(100, dtype=[(name, float) for name in names])
    for name in names:
        history[name] = load if name == "force_top_N" else found.history[name]
    said = " ".join(doubt.sentence for doubt in doubts_of("bend", replace(found, history=history)))
    assert "34 % of the largest load is left" in said and "the ligament is 1 times" in said
    history["force_top_N"][-1] = 0.0
    assert "is left" not in " ".join(d.sentence for d in doubts_of("bend", replace(found, history=history)))


def test_disc_that_breaks_beside_the_jaws_is_no_brazilian_test():
    (one,) = plan_brazilian(DataSheet(**STRONG), Options(quick=True), 1)
    found = replace(measured(one.scene), specimen=one)
    found.summary["peak_filtered_strain"] = 0.5 * one.scene.schedule.strain_end
    found.summary["first_failure_position_m"] = [27e-3, 50e-3]
    assert any(
        doubt.grave and "radii from the disc's middle" in doubt.sentence for doubt in doubts_of("brazilian", found)
    )
    found.summary["first_failure_position_m"] = [27e-3, 28e-3]
    assert not any("radii" in doubt.sentence for doubt in doubts_of("brazilian", found))
