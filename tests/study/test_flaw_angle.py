"""Reading the beginning of a crack from places, and the table of the flaw-angle study, on cracks that are known."""

import math

import numpy as np
import pytest

from rsmpm_ti.study import flaw_angle, mean_stress
from rsmpm_ti.study.flaw_angle import STUDIES, fit, mean_stress_rows, predict, trend
from rsmpm_ti.study.flaw_cracks import GROWN, flawed_scene, read_beginning, wings
from rsmpm_ti.study.gmts import critical_distance, sif_cube
from rsmpm_ti.study.mean_stress import HALF

SPACING = 0.25e-3
RATE = 1e9


def straight(specimen: str, angle: float, stress: float, length: float = 6e-3, middle: bool = False) -> dict:
    """What `crack` returns for two straight wings, two particles wide, that leave the flaw at `angle` when a load that
    rises by RATE [Pa/s] is at `stress`; from its ends, or from the middle of its faces."""
    half, turn = HALF[specimen], math.radians(angle)
    direction = np.array([math.cos(turn), math.sin(turn)])
    start = np.array([0.0, 1.5e-3]) if middle else np.array([half - 0.3e-3, 1.4e-3])
    s = np.arange(0.0, length, SPACING)
    across = np.array([-direction[1], direction[0]])
    wing = np.concatenate([np.stack([start + r * direction, start + r * direction + SPACING * across]) for r in s])
    x = np.stack([wing, -wing], axis=1).reshape(-1, 2)  # by turns, as they grow
    begun = np.stack([start, -start])
    time = np.linspace(0.0, 1.2 * stress / RATE, 400)[1:]
    return {
        "time": time,
        "stress": RATE * time,
        "onset": np.array(stress / RATE),
        "begun": begun,
        "normal": np.full(2, turn - 0.5 * math.pi),
        "x": x,
        "spacing": np.array(SPACING),
        "half": np.array(half),
    }


NOTHING = {"begun": np.zeros((0, 2)), "normal": np.zeros(0), "x": np.zeros((0, 2))}
"""Of a flaw that did not crack."""


def results(onset=None) -> dict:
    """A study in which rock does what the criterion with r_c = 1 mm says."""
    out = {}
    for run in STUDIES[0].runs(True):
        specimen, angle = run.settings["specimen"], run.settings["angle"]
        expected = predict(specimen, angle, 1e-3)
        middle = expected.middle > expected.end
        load = expected.load if onset is None else onset(specimen, angle)
        if not math.isfinite(expected.load):
            out[run.tag] = straight(specimen, 90.0, 3e6) | NOTHING
            continue
        out[run.tag] = straight(specimen, 90.0 if middle else expected.angle, load, middle=middle)
    return out


@pytest.fixture
def criterion_only(monkeypatch):
    """Nothing from finite elements to compare with: the rock of `results` obeys another criterion."""
    monkeypatch.setattr(mean_stress, "kept", lambda: dict.fromkeys(HALF, {}))


def rows_of(outcome, part: str) -> list:
    return [row for row in outcome.rows if part in row.quantity]


@pytest.mark.parametrize("angle", [0.0, 30.0, 74.0, 91.0, 130.0])
def test_angle_of_a_straight_crack_is_read_back(angle):
    got = read_beginning(straight("cube", angle, 3e6))
    assert got.first == pytest.approx(angle, abs=1e-4)  # arccos near 1
    # its particles begin on one side of the line through the first of them, which a fit over 3 mm sees
    assert got.path == pytest.approx(angle, abs=2.0)
    assert got.along == pytest.approx(7.2 / 7.5)


def test_onset_is_the_load_when_the_first_particle_lost_strength():
    result = straight("cube", 80.0, 3e6)
    result["stress"] = np.minimum(result["stress"], 3e6)  # from then on the load rests
    assert read_beginning(result).stress == pytest.approx(3e6, rel=1e-9)  # a straight line until then


def test_crack_from_the_middle_is_not_taken_for_one_from_an_end():
    result = straight("disc", 90.0, 1e6, middle=True)
    result["begun"] = np.array([[-4.2e-3, -1.7e-3], [4.2e-3, 1.7e-3], [0.2e-3, 1.7e-3], [-0.2e-3, 1.7e-3]])
    result["normal"] = np.zeros(4)
    # a first failure off the middle: the line from the flaw's centre to it is no border between the two cracks
    result["x"] = result["x"] + np.array([-1.2e-3, 0.0])
    got = read_beginning(result)
    assert got.along == pytest.approx(2.2 / 15.0)
    above, below = wings(result["begun"], result["x"], SPACING, HALF["disc"])
    assert above.length == pytest.approx(below.length)
    assert got.path == pytest.approx(90.0, abs=2.0)


def test_short_wing_has_no_angle_and_far_failures_are_not_of_it():
    short = straight("cube", 80.0, 3e6, length=0.8 * GROWN)
    assert math.isnan(read_beginning(short).path)
    short["x"] = np.concatenate([short["x"], [[7e-3, 12e-3], [-7e-3, -12e-3]]])
    assert math.isnan(read_beginning(short).path)


def test_flaw_that_did_not_crack_has_no_numbers():
    got = read_beginning(straight("cube", 80.0, 3e6) | NOTHING)
    assert all(map(math.isnan, (got.stress, got.along, got.first, got.path)))


def test_study_of_rock_that_obeys_the_criterion_finds_its_distance_and_passes(criterion_only):
    outcome = STUDIES[0].finish(results())
    assert all(row.passed for row in outcome.rows), [row for row in outcome.rows if not row.passed]
    assert rows_of(outcome, "r_c")[0].got == pytest.approx(1e-3, rel=1e-6)
    assert rows_of(outcome, "disc: correlation")[0].got == pytest.approx(1.0)
    assert rows_of(outcome, "disc: onset load")[0].error == pytest.approx(0.0, abs=1e-6)


def test_study_misses_cracks_at_other_angles():
    made = results()
    made["lab_cube_30"] = straight("cube", 60.0, 3e6)
    missed = {row.quantity for row in STUDIES[0].finish(made).rows if not row.passed}
    assert "cube: angle of first cracks, flaw at 30 degrees [deg]" in missed


def test_first_cracks_are_held_against_finite_elements():
    exact = mean_stress.kept()["cube"]
    same = {
        angle: read_beginning(straight("cube", exact[angle]["first"], exact[angle]["stress"])) for angle in (30.0, 45.0)
    }
    rows = mean_stress_rows("cube", same)
    assert len(rows) == 4 and all(row.passed for row in rows)
    assert max(abs(row.error) for row in rows) < 1e-3
    off = {45.0: read_beginning(straight("cube", exact[45.0]["first"] + 6.0, 1.2 * exact[45.0]["stress"]))}
    assert [row.passed for row in mean_stress_rows("cube", off)] == [False, False]


def test_study_misses_a_flaw_across_the_load_that_cracks_from_its_ends():
    made = results()
    made["lab_disc_90"] = straight("disc", 90.0, 0.5e6)
    missed = {row.quantity for row in STUDIES[0].finish(made).rows if not row.passed}
    assert "disc: onset, along/half length, flaw across the load" in missed


def test_study_misses_onset_loads_of_the_opposite_trend():
    made = results(lambda specimen, angle: 9e12 / predict(specimen, angle, 1e-3).load)
    missed = {row.quantity for row in STUDIES[0].finish(made).rows if not row.passed}
    assert "cube: correlation of log onset loads with the criterion's" in missed


def test_distance_is_fitted_at_one_angle_of_the_cube():
    found = {45.0: read_beginning(straight("cube", 80.0, 3e6))}
    assert fit(found) == pytest.approx(critical_distance(sif_cube(45.0), 7.5e-3, 2.0 / 3.0), rel=1e-8)
    assert all(map(math.isnan, trend("cube", found, fit(found))))  # one angle has no trend


@pytest.mark.parametrize("quick", [True, False])
def test_runs_are_named_apart_and_can_be_built(quick):
    runs = STUDIES[0].runs(quick)
    assert len({run.tag for run in runs}) == len(runs)
    for specimen in HALF:
        angles = [run.settings["angle"] for run in runs if run.tag.startswith(f"lab_{specimen}")]
        assert {flaw_angle.FITTED, flaw_angle.ACROSS[specimen]} <= set(angles)
    for run in runs:
        scene = flawed_scene(**run.settings)
        (slit,) = scene.bodies[0].region.removed
        specimen, angle = run.settings["specimen"], run.settings["angle"]
        assert 0.5 * slit.length == pytest.approx(HALF[specimen])
        axis = {"cube": (1.0, 0.0), "disc": (0.0, 1.0)}[specimen]  # of the platens; of the load
        assert abs(slit.direction @ axis) == pytest.approx(math.cos(math.radians(angle)))
        assert slit.rounded == (not run.settings["paper"])
        assert scene.rock.after_failure.oriented == (not run.settings["paper"])


def test_picture_draws_every_family(tmp_path):
    from matplotlib.figure import Figure

    made = results()
    made |= {tag.replace("lab", "paper"): result | {"normal": np.full(2, np.nan)} for tag, result in made.items()}
    figure = Figure()
    STUDIES[0].finish(made).draw(figure)
    figure.savefig(tmp_path / "flaw_angle.png")
    assert len(figure.axes) == 4
