"""The slit specimen with directional cracks, coarse and short: its stiffness, and how it begins to crack."""

import math
from dataclasses import replace

import numpy as np
import pytest

from rsmpm_ti import load_scene, simulate

DX = 1.25e-3


@pytest.fixture(scope="module")
def result(coarse_run):
    return coarse_run("cube_lab")


def test_specimen_is_softer_than_rock_by_its_flaw(result):
    """Elliptical hole at 45 degrees with half axes a and b: 1/E' grows by pi (a^2 + a b + b^2)/(A E').

    Kachanov (1993), Adv. Appl. Mech. 30:259, of the hole's compliance in its own axes; a body of area A far larger.
    """
    a, b, area = 7.5e-3, 1.875e-3, 50e-3 * 100e-3
    expected = 17e9 / (1.0 - 0.14**2) / (1.0 + math.pi * (a * a + a * b + b * b) / area)
    # the flaw is fuller than an ellipse, by 16 % of its area and of its part of 4.6 %; the specimen ends 17 mm away
    assert result.summary["apparent_modulus_Pa"] == pytest.approx(expected, rel=0.02)


def test_it_cracks_in_tension_at_the_flaw_and_begins_to_before_it_fails(result):
    events, centre = result.events, np.array([25e-3, 50e-3])
    assert len(events) > 0 and events.mode[0] == 1
    distance = np.hypot(*(events.x[0] - centre))
    assert distance < 7.5e-3 + 2 * DX  # the flaw's end, and the cells in which it is resolved
    assert np.isfinite(result.snapshot.sigma).all()
    begun, failed = ~np.isnan(result.snapshot.crack_angle), result.snapshot.failure_mode > 0
    assert (begun | ~failed).all() and begun.sum() > failed.sum()  # some have lost less than half of their strength
    # the hoop tension of a round end opens cracks 70 to 97 degrees from the flaw (docs/references.md, section 9);
    # coarse: 10 more
    angles = result.summary["first_crack_angles_deg"]
    assert len(angles) == 2 and all(60.0 < angle < 107.0 for angle in angles)
    leaving = [angle for angle in result.summary["initiation_angles_deg"] if angle is not None]
    assert all(60.0 < angle < 107.0 for angle in leaving)
    assert result.summary["energy_balance_error"] < 0.02  # as every scene: docs/references.md, section 16


@pytest.mark.validation
def test_angles_of_leaving_do_not_depend_on_seed_and_time_scale():
    """Runs whose first cracks agree within a degree gave 1 to 103 degrees by the places where particles failed.

    Each is the median of 20 directions that scatter by 4 degrees: its own standard error is 1.1 degrees, and the
    largest of twelve lies 3 of those apart from their mean at most.
    """
    angles = []
    for seed, time_scale in ((1, 16.0), (2, 16.0), (3, 16.0), (1, 24.0), (2, 24.0), (1, 32.0)):
        scene = load_scene("cube_lab", quick=True, seed=seed, time_scale=time_scale, strain_end=6.5e-4)
        scene = replace(scene, schedule=replace(scene.schedule, rows=50))
        angles += simulate(scene, threads=1).summary["initiation_angles_deg"]
    assert None not in angles and np.abs(np.array(angles) - np.mean(angles)).max() < 3.3
