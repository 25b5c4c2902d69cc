"""Cracks among made-up failures: which there are, where they began, how fast they grew and how far they opened."""

from dataclasses import replace

import numpy as np
import pytest
from broken_bands import SPACING, failures, history, lattice, scattered, snapshot, strip
from scipy.spatial import cKDTree

from rsmpm_ti.analysis.crack_bands import find_bands, measure_cracks, openings
from rsmpm_ti.analysis.crack_opening import jumps
from rsmpm_ti.analysis.crack_path import growth, rayleigh_speed, tip_speed
from rsmpm_ti.analysis.flaw_tips import first_angle, flaw_tips, initiations
from rsmpm_ti.analysis.load_curve import load_at
from rsmpm_ti.analysis.wing_cracks import MIN_PARTICLES
from rsmpm_ti.spec.regions import Slit

FLAWS = (
    Slit(centre=(0.02, 0.03), length=0.012, width=1e-3, angle=30.0),
    Slit(centre=(0.03, 0.07), length=0.012, width=1e-3, angle=120.0),
)
TIPS = flaw_tips(FLAWS)
DX = 2.0 * SPACING


def measured(table, tips=TIPS, time_scale=1.0):
    bands, graph = find_bands(table, SPACING)
    return measure_cracks(table, bands, graph, tips, SPACING, time_scale)


def wing(tip, leaving: float, length: float = 8e-3) -> np.ndarray:
    """A band from a flaw tip, `leaving` degrees from the flaw's continuation."""
    heading = np.degrees(np.arctan2(tip.outward[1], tip.outward[0])) + leaving
    return strip(heading, length, 3.0, start=tip.position)


def in_turn(parts, delay=1e-4, interval=1e-6):
    """Failures of several bands, each band's from its beginning on, the k-th band starting k delays later."""
    x = np.concatenate(parts)
    time = np.concatenate([k * delay + interval * np.arange(len(part)) for k, part in enumerate(parts)])
    return failures(x, time=time)


def test_tips_are_the_ends_of_every_flaw():
    assert [tip.name for tip in TIPS] == ["0+", "0-", "1+", "1-"]
    np.testing.assert_allclose(TIPS[1].position, (0.02 - 0.006 * np.cos(np.pi / 6), 0.03 - 0.003))
    np.testing.assert_allclose(TIPS[2].outward, (-0.5, np.sqrt(0.75)))


def test_cracks_of_two_flaws_know_their_tips_and_angles():
    leaving = (70.0, 50.0, 85.0, -60.0)
    cracks = measured(in_turn([wing(tip, angle) for tip, angle in zip(TIPS, leaving, strict=True)]))
    assert [crack.origin.tip for crack in cracks] == ["0+", "0-", "1+", "1-"]
    for crack, angle in zip(cracks, leaving, strict=True):
        assert crack.origin.angle == pytest.approx(abs(angle), abs=3.0)  # 3 mm of a scattered band 0.75 mm wide
        assert crack.course.length == pytest.approx(8e-3, abs=2.0 * SPACING)


def test_crack_away_from_flaws_belongs_to_none():
    (crack,) = measured(failures(strip(0.0, 8e-3, 3.0, start=(0.02, 0.05))))
    assert crack.origin.tip == "" and np.isnan(crack.origin.angle)


def test_a_wide_flaw_breaks_at_its_corners_and_they_belong_to_its_end():
    """A corner lies half a width from the middle of the end, which for a wide flaw is farther than from any crack."""
    wide = Slit(centre=(0.0, 0.0), length=0.02, width=8e-3, angle=0.0)
    for y, name in ((6e-3, "0+"), (8e-3, "")):
        (crack,) = measured(failures(strip(90.0, 8e-3, 3.0, start=(0.01, y))), tips=flaw_tips((wide,)))
        assert crack.origin.tip == name


def test_cracks_come_in_the_order_in_which_they_began():
    early, late = strip(0.0, 5e-3, 2.0), strip(0.0, 8e-3, 2.0, start=(0.0, 0.05))
    table = in_turn([late, early], delay=-5e-5)  # the second list begins first
    cracks = measured(table)
    assert [crack.origin.position[1] > 0.02 for crack in cracks] == [False, True]
    assert cracks[0].origin.time == table.time[0]


def test_fewer_particles_than_a_line_needs_are_no_crack_even_when_all_fail_twice():
    few = strip(0.0, 5e-3, 1.2)[: MIN_PARTICLES - 1]
    twice = failures(np.concatenate([few, few]), ids=np.tile(np.arange(MIN_PARTICLES - 1), 2))
    assert measured(failures(few)) == [] and measured(twice) == []
    assert len(measured(failures(strip(0.0, 5e-3, 1.2)[:MIN_PARTICLES]))) == 1


def test_counts_and_energies_by_mode_and_particles_that_fail_twice():
    x = strip(0.0, 8e-3, 2.0)
    n = len(x)
    table = failures(
        np.concatenate([x, x[:10]]),
        time=np.arange(n + 10),
        mode=np.repeat([1, 2], [n, 10]),
        released=np.repeat([1e-5, 3e-5], [n, 10]),
        ids=np.concatenate([np.arange(n), np.arange(10)]),
    )
    (crack,) = measured(table)
    assert (crack.particles, crack.tension, crack.shear) == (n, n, 10)
    assert crack.released == pytest.approx(n * 1e-5 + 30e-5) and crack.shear_energy == pytest.approx(30e-5)
    assert crack.course.width == pytest.approx(n * SPACING**2 / crack.course.length)


def test_first_failure_gives_mode_time_and_place_of_origin():
    x = strip(0.0, 8e-3, 2.0)
    (crack,) = measured(failures(x, time=np.arange(len(x))[::-1] + 3.0, mode=np.where(np.arange(len(x)) > 60, 2, 1)))
    np.testing.assert_array_equal(crack.origin.position, x[-1])
    assert crack.origin.time == 3.0 and crack.origin.mode == 2


def test_crack_that_grows_steadily_has_that_tip_speed():
    speed = 500.0
    x = strip(20.0, 30e-3, 3.0)
    t = np.radians(20.0)
    time = (x @ np.array([np.cos(t), np.sin(t)])) / speed
    (crack,) = measured(failures(x, time=time))
    # ways within the band are up to 3 % longer than straight, and a window of 10 mm loses or gains a particle
    assert crack.speed_at.max() == pytest.approx(speed, rel=0.06)
    assert crack.length_at[-1] == pytest.approx(30e-3, rel=0.04)
    assert (np.diff(crack.length_at) >= 0.0).all() and crack.length_at[0] == 0.0
    # mass scaling by k slows every wave k times, and the window is k times as long
    (slow,) = measured(failures(x, time=10.0 * time), time_scale=10.0)
    np.testing.assert_allclose(slow.speed_at, 0.1 * crack.speed_at, rtol=1e-9)


def test_growth_counts_all_failures_of_an_instant_at_once():
    np.testing.assert_array_equal(growth(np.array([0.0, 1.0, 1.0, 2.0]), np.array([0.0, 1.0, 4.0, 2.0])), [0, 4, 4, 4])


def test_tip_speed_is_growth_over_the_window():
    time, length = np.array([0.0, 1.0, 2.0, 10.0]), np.array([0.0, 1.0, 3.0, 4.0])
    np.testing.assert_allclose(tip_speed(time, length, 2.0), [0.0, 0.5, 1.5, 0.5])


def test_rayleigh_speed_is_that_of_the_papers_rock():
    E, nu, density = 17e9, 0.14, 2600.0
    shear = np.sqrt(E / (2.0 * (1.0 + nu)) / density)
    strain = np.sqrt(E * (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) / density)
    stress = np.sqrt(E / (1.0 - nu**2) / density)
    # docs/references.md, section 1, to one digit after the point
    assert rayleigh_speed(shear, strain) == pytest.approx(1524.8, abs=0.05)
    assert rayleigh_speed(shear, stress) == pytest.approx(1519.5, abs=0.05)


def test_rayleigh_speed_of_a_poisson_solid():
    """lambda = mu: c_R/c_s = sqrt(2 - 2/sqrt(3)), in closed form (Rayleigh 1885)."""
    assert rayleigh_speed(1.0, np.sqrt(3.0)) == pytest.approx(np.sqrt(2.0 - 2.0 / np.sqrt(3.0)), rel=1e-12)


def test_load_at_is_read_from_the_middle_of_each_rows_interval():
    stress, strain = load_at(history(stress_rate=1e9, strain_rate=0.05), np.array([2.34e-3, 7.777e-3]))
    np.testing.assert_allclose(stress, [2.34e6, 7.777e6], rtol=1e-9)
    np.testing.assert_allclose(strain, [1.17e-4, 3.8885e-4], rtol=1e-9)


@pytest.mark.parametrize("rows", [0, 5])
def test_load_without_platens_or_rows_is_nan(rows):
    table = history(rows=max(rows, 1))[:rows]
    for name in ("stress_top_Pa", "stress_bottom_Pa", "axial_strain"):
        table[name] = np.nan
    assert np.isnan(load_at(table, np.array([1e-3, 2e-3]))).all()


def test_initiation_has_an_entry_for_every_tip():
    table = in_turn([wing(TIPS[3], 70.0), wing(TIPS[0], 40.0)], delay=2e-3)
    bands, _ = find_bands(table, SPACING)
    entries = initiations(table, bands, TIPS, history(stress_rate=1e9))
    assert [entry["tip"] for entry in entries] == ["0+", "0-", "1+", "1-"]
    assert [entry["flaw"] for entry in entries] == [0, 0, 1, 1]
    assert [entry["mode"] for entry in entries] == ["tension", None, None, "tension"]
    assert entries[1]["angle_deg"] is None and entries[1]["stress_Pa"] is None
    assert entries[0]["stress_Pa"] == pytest.approx(2e6, rel=1e-6)
    assert entries[0]["angle_deg"] == pytest.approx(40.0, abs=3.0)
    assert (entries[0]["crack"], entries[3]["crack"]) == (1, 0)
    np.testing.assert_allclose(entries[3]["position_m"], TIPS[3].position, atol=2.0 * SPACING)


def test_cracks_with_a_direction_leave_at_the_median_of_the_first_ones():
    """Failures all over the tip, as of half-broken rock, whose cracks lie at 72 degrees, one in five anyhow."""
    tip, dice = TIPS[0], np.random.default_rng(3)
    x = tip.position + dice.uniform(-2e-3, 2e-3, (60, 2))
    x = x[np.argsort(dice.random(60))]
    lean = np.radians(72.0 + dice.uniform(-4.0, 4.0, 60))
    lean[::5] = dice.uniform(0.0, np.pi, 12)
    across = np.radians(FLAWS[0].angle) + lean + 0.5 * np.pi
    # a line at 72 degrees has two senses; beside the face below the flaw it leads away to the other side
    below = FLAWS[0].frame(x)[:, 1] < 0.0
    across[below] = np.radians(FLAWS[0].angle) - lean[below] + 0.5 * np.pi
    table = failures(x)
    table.crack_angle = across
    bands, _ = find_bands(table, SPACING * 3.0)
    angle = initiations(table, bands, TIPS, history())[0]["angle_deg"]
    assert angle == pytest.approx(72.0, abs=2.0)
    table.crack_angle = None
    by_places = initiations(table, bands, TIPS, history())[0]["angle_deg"]
    assert abs(by_places - 72.0) > 2.0, "places alone know no direction here"


def test_too_few_first_cracks_give_no_direction():
    table = failures(np.concatenate([wing(TIPS[0], 70.0)[:1], wing(TIPS[0], 70.0, length=20e-3)[-60:]]))
    table.crack_angle = np.zeros(len(table))
    assert np.isnan(first_angle(table, np.arange(len(table)), TIPS[0]))


def test_a_stray_failure_near_a_tip_is_no_initiation():
    stray = TIPS[0].position[None, :] + (0.0, -2e-3)
    table = in_turn([stray, wing(TIPS[0], 70.0)])
    bands, _ = find_bands(table, SPACING)
    entry = initiations(table, bands, TIPS, history())[0]
    assert entry["time_s"] == pytest.approx(1e-4) and entry["angle_deg"] == pytest.approx(70.0, abs=3.0)


def test_what_breaks_at_the_tip_later_does_not_turn_the_angle_of_leaving():
    """A second crack from the same tip, and shear beside the first: one band in the end, but the first left at 70."""
    first, later = wing(TIPS[0], 70.0), wing(TIPS[0], 130.0)
    crushed = wing(TIPS[0], -20.0, length=3e-3)
    x = np.concatenate([first, later, crushed])
    time = np.concatenate([np.arange(len(first)), 1e4 + np.arange(len(later)), 0.5 + np.arange(len(crushed))])
    table = failures(x, time=time, mode=np.repeat([1, 1, 2], [len(first), len(later), len(crushed)]))
    (crack,) = measured(table)
    bands, _ = find_bands(table, SPACING)
    assert crack.origin.angle == pytest.approx(70.0, abs=3.0)
    assert initiations(table, bands, TIPS, history())[0]["angle_deg"] == pytest.approx(70.0, abs=3.0)


def test_two_bands_that_meet_are_one_crack_with_two_initiations():
    """A bridge of rock between flaws breaks from both sides: one crack, which began at the tip that broke first."""
    gap = TIPS[2].position - TIPS[0].position
    heading, length = np.degrees(np.arctan2(gap[1], gap[0])), np.linalg.norm(gap)
    x = strip(heading, length, 3.0, start=TIPS[0].position)
    along = (x - TIPS[0].position) @ gap / length
    table = failures(x, time=np.where(along < 0.5 * length, along, 1e-3 + length - along))
    bands, _ = find_bands(table, SPACING)
    (crack,) = measured(table)
    assert crack.origin.tip == "0+"
    entries = initiations(table, bands, TIPS, history())
    assert [entry["crack"] for entry in entries] == [0, None, 0, None]
    assert entries[2]["time_s"] > entries[0]["time_s"]
    for entry, tip, heading in ((entries[0], TIPS[0], gap), (entries[2], TIPS[2], -gap)):
        angle = np.degrees(np.arccos(heading @ tip.outward / length))
        assert entry["angle_deg"] == pytest.approx(angle, abs=3.0)  # each from its own tip


def test_failures_of_a_solid_have_bands_but_no_course():
    flat = strip(0.0, 8e-3, 3.0)
    x = np.concatenate([np.column_stack([flat, np.full(len(flat), z)]) for z in (0.0, SPACING)])
    time = np.tile(flat[:, 0] / 300.0, 2)
    (crack,) = measured(failures(x, time=time), tips=())
    assert crack.course is None and crack.origin.position.shape == (3,)
    assert crack.length_at[-1] == pytest.approx(8e-3, rel=0.05)


@pytest.mark.parametrize("dim", [2, 3])
def test_no_failures_are_no_cracks(dim):
    assert measured(failures(np.zeros((0, dim)))) == []
    bands, _ = find_bands(failures(np.zeros((0, dim))), SPACING)
    assert initiations(failures(np.zeros((0, dim))), bands, TIPS, history())[0]["mode"] is None


# --- opening and slip ---

OPENING, SLIP = 6e-6, 2e-6


def split_block(angle: float, cut: float, x: np.ndarray):
    """Displacement of a strained block cut along a line through its middle, `angle` degrees from +x: the part to the
    left has moved off by OPENING, and back along the line by SLIP, which is sinistral. And who is in a band `cut` wide.
    """
    t = np.radians(angle)
    along, normal = np.array([np.cos(t), np.sin(t)]), np.array([-np.sin(t), np.cos(t)])
    strain = np.array([[3e-4, 1e-4], [-0.5e-4, -8e-4]])  # 0.2 % times millimetres: as large as the jump
    across = (x - 0.01) @ normal
    u = x @ strain.T + np.where(across[:, None] > 0.0, OPENING * normal - SLIP * along, 0.0)
    return u, np.abs(across) < 0.5 * cut


@pytest.mark.parametrize("angle", [0.0, 45.0, 80.0])
def test_known_jump_is_found_in_strained_rock(angle):
    reference = scattered(lattice((0.0, 0.0), (0.02, 0.02)))
    u, failed = split_block(angle, 3.0 * SPACING, reference)
    x = reference + u
    inside = failed & (np.abs(x - 0.01).max(axis=1) < 8e-3)
    bands = failures(x[inside], ids=np.flatnonzero(inside))
    cracks = measured(bands, tips=())
    (found,) = openings(cracks, bands, snapshot(x, failed, displacement=u), DX)
    assert len(found) > 20 and np.isfinite(found).all()
    # u is linear on each side, so only the path's direction is not exact: 5 degrees turn 2 um of slip into 0.2 um
    np.testing.assert_allclose(found[2:-2, 0], OPENING, rtol=0.04)
    np.testing.assert_allclose(found[2:-2, 1], -SLIP, rtol=0.25)


def test_opening_follows_the_crack_where_the_specimen_has_moved():
    """Places are compared as seeded: a specimen that flies off after it broke keeps its openings."""
    reference = scattered(lattice((0.0, 0.0), (0.02, 0.02)))
    u, failed = split_block(0.0, 3.0 * SPACING, reference)
    bands = failures((reference + u)[failed], ids=np.flatnonzero(failed))
    flown = u + (0.3, -0.1)
    (found,) = openings(measured(bands, tips=()), bands, snapshot(reference + flown, failed, displacement=flown), DX)
    np.testing.assert_allclose(np.nanmean(found[:, 0]), OPENING, rtol=0.02)


def test_opening_is_found_though_particles_of_the_crack_have_left_the_domain():
    """The same crack; every third of its particles is gone, then all of them."""
    reference = scattered(lattice((0.0, 0.0), (0.02, 0.02)))
    u, failed = split_block(0.0, 3.0 * SPACING, reference)
    bands, flown, n = failures((reference + u)[failed], ids=np.flatnonzero(failed)), u + (0.3, -0.1), np.arange(len(u))
    cracks = measured(bands, tips=())
    for gone, opening in ((failed & (n % 3 == 0), OPENING), (failed, np.nan)):
        left = snapshot((reference + flown)[~gone], failed[~gone], displacement=flown[~gone])
        (found,) = openings(cracks, bands, replace(left, id=n[~gone]), DX)
        np.testing.assert_allclose(found[2:-2, 0], opening, rtol=0.04)


def test_closed_crack_has_no_opening():
    x = lattice((0.0, 0.0), (0.02, 0.02))
    path = np.column_stack([np.linspace(5e-3, 15e-3, 20), np.full(20, 0.01)])
    found = jumps(path, cKDTree(x), x @ np.array([[3e-4, 0.0], [1e-4, -8e-4]]), DX)
    np.testing.assert_allclose(found, 0.0, atol=1e-15)


def test_no_jump_where_a_side_is_missing():
    x = lattice((0.0, 0.0), (0.02, 0.01))
    path = np.column_stack([np.linspace(5e-3, 15e-3, 20), np.full(20, 0.01)])  # along the free edge
    assert np.isnan(jumps(path, cKDTree(x), np.zeros_like(x), DX)).all()
    assert np.isnan(jumps(path, cKDTree(np.zeros((0, 2))), np.zeros((0, 2)), DX)).all()
