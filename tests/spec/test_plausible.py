"""What no rock and no test has is said, in the unit that it looks like; what rock has is not."""

import math
import re
from dataclasses import replace

import pytest
from small_scene import make

from rsmpm_ti import (
    Box,
    Clipped,
    Difference,
    Directional,
    Fairhurst,
    GPa,
    HoekBrown,
    HolePressure,
    Hooke,
    LinearSoftening,
    MohrCoulomb,
    MPa,
    Output,
    Platen,
    Rock,
    Schedule,
    Slit,
    load_scene,
)
from rsmpm_ti.checks import KNOWN, annotations, is_pressure
from rsmpm_ti.errors import SceneError
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.spec.ground.in_situ import InSitu
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.loading_start import AtRest
from rsmpm_ti.spec.review.plausible import LEAST_ROWS, RANGES, implausible
from rsmpm_ti.spec.scene import LEAST_ROWS as FEWEST_ROWS
from rsmpm_ti.spec.scene import ROW_STEPS

ROCKS = {
    # density, E [GPa], nu, uniaxial compressive and tensile strength [MPa], friction angle: orders of size of Goodman
    # (1989), Introduction to Rock Mechanics, chapters 2, 3 and 6, and Jaeger, Cook & Zimmerman (2007)
    "weak tuff": (1600.0, 1.0, 0.25, 5.0, 0.5, 30.0),
    "chalk": (1500.0, 2.0, 0.30, 8.0, 0.8, 25.0),
    "coal": (1400.0, 3.0, 0.30, 20.0, 1.0, 35.0),
    "Nevada Test Site tuff": (1900.0, 3.65, 0.29, 11.3, 1.1, 22.0),
    "rock salt": (2160.0, 4.4, 0.30, 21.0, 1.5, 45.0),
    "Bedford limestone": (2300.0, 28.5, 0.29, 51.0, 1.6, 42.0),
    "Berea sandstone": (2200.0, 19.3, 0.38, 73.8, 1.2, 27.8),
    "Solenhofen limestone": (2620.0, 63.7, 0.29, 245.0, 4.0, 35.0),
    "Cherokee marble": (2700.0, 55.8, 0.25, 66.9, 1.8, 50.0),
    "Micaceous shale": (2500.0, 11.1, 0.29, 75.2, 2.1, 22.0),
    "Pikes Peak granite": (2660.0, 70.6, 0.18, 226.0, 11.9, 53.0),
    "Nevada Test Site basalt": (2700.0, 34.9, 0.32, 148.0, 13.1, 31.0),
    "Baraboo quartzite": (2640.0, 88.4, 0.11, 300.0, 11.0, 48.0),
}


def mohr_coulomb(ucs: float, tensile: float, phi: float) -> MohrCoulomb:
    """By the uniaxial strength [Pa]: c = UCS (1 - sin phi)/(2 cos phi)."""
    angle = math.radians(phi)
    cohesion = ucs * (1.0 - math.sin(angle)) / (2.0 * math.cos(angle))
    return MohrCoulomb(cohesion=cohesion, friction_angle=phi, tensile_strength=tensile)


def specimen(rock: Rock, **loading):
    scene = load_scene("intact", quick=True)
    return replace(scene, rock=rock, loading=replace(scene.loading, **loading))


def paper(**changes) -> Rock:
    rock = load_scene("intact").rock
    parts = {"elasticity": {}, "criterion": {}, "": {}}
    for name, value in changes.items():
        owner = next((o for o in ("elasticity", "criterion") if hasattr(getattr(rock, o), name)), "")
        parts[owner][name] = value
    rock = replace(rock, elasticity=replace(rock.elasticity, **parts["elasticity"]), **parts[""])
    return replace(rock, criterion=replace(rock.criterion, **parts["criterion"]))


@pytest.mark.parametrize("name", ROCKS)
def test_ordinary_rock_is_not_warned_about(name):
    density, E, nu, ucs, tensile, phi = ROCKS[name]
    rock = Rock(
        density=density, elasticity=Hooke(E=E * GPa, nu=nu), criterion=mohr_coulomb(ucs * MPa, tensile * MPa, phi)
    )
    scene = specimen(rock)
    # to its failure, so that rows are as fine as they are for the paper's rock
    end = 1.1 * ucs * MPa * (1.0 - nu**2) / (E * GPa)
    assert implausible(replace(scene, schedule=replace(scene.schedule, strain_end=end))) == []


@pytest.mark.parametrize("quick", [False, True])
@pytest.mark.parametrize("name", available())
def test_shipped_scene_is_not_warned_about(name, quick):
    assert implausible(load_scene(name, quick=quick)) == []


@pytest.mark.parametrize(
    "changes, sentence",
    [
        ({"E": 17.0e6}, "rock.elasticity.E = 1.7e+07 Pa is not rock's, 0.1 to 150 GPa"),
        ({"E": 2.0e12}, "rock.elasticity.E = 2e+12 Pa is not rock's"),
        ({"nu": -0.2}, "rock.elasticity.nu = -0.2 is not rock's, 0 to 0.45"),
        ({"density": 2.6}, "rock.density = 2.6 kg/m^3 looks like g/cm^3: write 2600 or '2.6 g/cm^3'"),
        ({"density": 26000.0}, "rock.density = 26000 kg/m^3 is not rock's"),
        ({"friction_angle": 0.7}, "rock.criterion.friction_angle = 0.7 degrees looks like radians: write 40.11"),
        (
            {"friction_angle": 85.0, "tensile_strength": 0.4e6},
            "rock.criterion.friction_angle = 85 degrees is not rock's, 10 to 70 degrees",
        ),
        ({"tensile_strength": 2.0}, "rock.criterion.tensile_strength = 2 Pa looks like MPa: write 2e6 or '2 MPa'"),
        ({"tensile_strength": 2e3}, "rock.criterion.tensile_strength = 2000 Pa looks like kPa"),
        ({"cohesion": 5.95e9}, "rock.criterion.cohesion = 5.95e+09 Pa is not rock's, 0.05 to 150 MPa"),
        ({"cohesion": 149e6, "friction_angle": 60.0}, "a uniaxial strength of 1112 MPa is not rock's"),
        ({"tensile_strength": 0.1e6}, "its compressive over its tensile strength is 255"),
        ({"E": 0.5e9}, "E over its uniaxial strength is 19.6"),
    ],
)
def test_what_rock_does_not_have_is_said(changes, sentence):
    said = implausible(specimen(paper(**changes)))
    assert any(sentence in line for line in said), said
    assert all("\n" not in line for line in said)


def test_every_range_is_that_of_some_law_and_says_where_it_comes_from():
    softening = LinearSoftening(G_f_I=0.005, G_f_II=0.024)
    odd = replace(lab_rock(), after_failure=Directional(residual_friction_angle=0.5, softening=softening))
    with pytest.raises(SceneError) as refused:  # for the cells that so little energy asks for
        specimen(odd)
    said = str(refused.value)
    assert "rock.after_failure.softening.G_f_I = 0.005 J/m^2 looks like N/mm: write 5 or '0.005 N/mm'" in said
    assert "rock.after_failure.residual_friction_angle = 0.5 degrees looks like radians" in said
    assert all(r.low < r.high and re.search(r"\d{4}", r.source) for r in RANGES.values())


@pytest.mark.parametrize("number, unit, size", [(17.0, "GPa", 17e9), (0.2, "GPa", 0.2e9), (60.0, "GPa", 60e9)])
def test_refusal_that_comes_of_a_unit_names_it(number, unit, size):
    """A modulus of 17 Pa is refused for its number of steps, which says nothing to who wrote it."""
    with pytest.raises(SceneError) as refused:
        specimen(paper(E=number))
    written = re.search(r"rock\.elasticity\.E = \S+ Pa looks like (\w+): write (\S+) or '(.*)'", str(refused.value))
    assert (written[1], float(written[2]), written[3]) == (unit, pytest.approx(size), f"{number:g} {unit}")


def test_refusal_without_such_a_cause_stays_as_it_is():
    with pytest.raises(SceneError) as refused:
        load_scene("cube", settings={"schedule.cfl": "5"})
    assert "likely cause" not in str(refused.value)


def test_confining_pressure_in_megapascals():
    said = implausible(specimen(paper(), confinement=2.0))
    assert said == ["loading.confinement = 2 Pa looks like MPa: write 2e6 or '2 MPa'"]


CLIPPED = Clipped(tension_limit=0.5, compression_limit=100e6)
HELD = Platen(axis=1, side="upper", position=0.1, stress=20.0)
FLUID = HolePressure(region=Box(lower=(0.02, 0.04), upper=(0.03, 0.06)), times=(0.0, 1e-3), pressures=(0.0, 20.0))
PRESSURES = {
    ("Hooke", "E"): lambda: specimen(paper(E=17.0)),
    ("MohrCoulomb", "cohesion"): lambda: specimen(paper(cohesion=14.63, tensile_strength=2.0)),
    ("MohrCoulomb", "tensile_strength"): lambda: specimen(paper(tensile_strength=2.0)),
    ("HoekBrown", "intact_strength"): lambda: HoekBrown(intact_strength=108.0, m=17.0, tensile_strength=5e6),
    ("HoekBrown", "tensile_strength"): lambda: specimen(
        replace(paper(), criterion=HoekBrown(intact_strength=108e6, m=17.0, tensile_strength=5.0))
    ),
    ("Fairhurst", "compressive_strength"): lambda: Fairhurst(compressive_strength=130.0, tensile_strength=8e6),
    ("Fairhurst", "tensile_strength"): lambda: specimen(
        replace(paper(), criterion=Fairhurst(compressive_strength=130e6, tensile_strength=8.0))
    ),
    ("Clipped", "tension_limit"): lambda: specimen(replace(paper(), after_failure=CLIPPED)),
    ("Clipped", "compression_limit"): lambda: specimen(
        replace(paper(), after_failure=replace(CLIPPED, tension_limit=0.0, compression_limit=100.0))
    ),
    ("InSitu", "overburden"): lambda: specimen(
        paper(), initial_stress=InSitu(axis=1, surface=0.1, overburden=3.0, K0=0.5), start=AtRest()
    ),
    ("Platen", "stress"): lambda: held(HELD),
    ("HolePressure", "pressures"): lambda: specimen(paper(), holes=(FLUID,)),
    ("Loading", "confinement"): lambda: specimen(paper(), confinement=2.0),
    ("Output", "stress_limit"): lambda: replace(specimen(paper()), output=Output(stress_limit=3.0)),
}


def held(platen: Platen):
    scene = specimen(paper())
    loading = replace(scene.loading, boundaries=(scene.loading.boundaries[0], platen))
    return replace(scene, loading=loading, schedule=Schedule(t_end=1e-4))


def test_every_pressure_of_a_scene_is_among_them():
    assert set(PRESSURES) == {
        (kind.__name__, n) for kind in KNOWN.values() for n in annotations(kind) if is_pressure(kind, n)
    }


@pytest.mark.parametrize("owner, name", PRESSURES)
def test_pressure_that_lost_its_unit_looks_like_megapascals(owner, name):
    """As a warning, or as the likely cause of a refusal."""
    try:
        said = "\n".join(implausible(PRESSURES[owner, name]()))
    except SceneError as error:
        said = str(error)
    number = re.search(rf"{name} = (\S+) Pa looks like [GM]Pa: write (\S+) or '(\S+) [GM]Pa'", said)
    assert number and number[1] == number[3] and float(number[2]) in (1e6 * float(number[1]), 1e9 * float(number[1]))


def test_refusal_of_a_law_says_which_of_its_numbers_has_lost_its_unit():
    for number, written in ((14.63, "14.63e6"), (1.463e-5, "14.63")):
        with pytest.raises(SceneError) as refused:
            MohrCoulomb(cohesion=number, friction_angle=40.0, tensile_strength=2e6)
        said = f"; likely cause: cohesion = {number:g} Pa looks like MPa: write {written} or '{number:g} MPa'"
        assert str(refused.value).endswith(said)
    with pytest.raises(SceneError) as refused:
        load_scene("cube", settings={"rock.criterion.cohesion": "14.63"})
    assert str(refused.value).count("looks like MPa") == 1


@pytest.mark.parametrize("degrees", [15.0, 30.0, 45.0, 60.0, 90.0, -45.0, 180.0])
def test_angle_in_radians(degrees):
    radians = round(math.radians(degrees), 3)

    def angles_said(angle: float) -> list[str]:
        scene = load_scene("intact", quick=True)
        flaw = Slit(centre=(0.025, 0.05), length=0.015, width=3e-3, angle=angle)
        region = Difference(whole=Box(lower=(0.0, 0.0), upper=(0.05, 0.1)), removed=(flaw,))
        said = implausible(replace(scene, bodies=(replace(scene.bodies[0], region=region),)))
        return [line for line in said if "slit.angle" in line]

    (line,) = angles_said(radians)
    assert f"slit.angle = {radians:g} degrees looks like radians: write {degrees:g}" in line
    assert angles_said(degrees) == []
    assert angles_said(math.copysign(1.0, degrees)) == []


def test_a_rate_that_no_quasi_static_test_has():
    scene = load_scene("cube", quick=True)
    assert implausible(scene) == []
    fast = tuple(replace(platen, speed=10.0 * platen.speed) for platen in scene.loading.boundaries)
    (line,) = implausible(replace(scene, loading=replace(scene.loading, boundaries=fast)))
    assert line.startswith("the strain rate of 0.5 1/s with time_scale = 16 is no quasi-static test: inertia")
    # without an estimate: two bodies
    half = Box(lower=(0.0, 0.0), upper=(0.05, 0.05)), Box(lower=(0.0, 0.05), upper=(0.05, 0.1))
    two = replace(scene, bodies=tuple(replace(scene.bodies[0], region=region) for region in half))
    assert implausible(two) == []
    faster = tuple(replace(platen, speed=20.0 * platen.speed) for platen in scene.loading.boundaries)
    (line,) = implausible(replace(two, loading=replace(two.loading, boundaries=faster)))
    assert line.startswith("the strain rate of 16 1/s (with time_scale = 16) is that of a dynamic test")


def test_run_that_ends_before_anything_fails_is_told_so_and_is_no_test_that_is_too_fast():
    scene = load_scene("cube", quick=True)
    short = replace(scene, schedule=replace(scene.schedule, strain_end=1e-6, rows=5))
    (line,) = implausible(short)
    assert "the first failure is expected at a strain of" in line and line.endswith("raise schedule.strain_end")
    assert implausible(short.elastic()) == []


def test_rows_too_coarse_for_the_first_failure():
    scene = load_scene("cube", quick=True)

    def with_rows(rows: int):
        return replace(scene, schedule=replace(scene.schedule, rows=rows))

    (line,) = implausible(with_rows(20))
    needed = int(re.search(r"raise schedule.rows to (\d+) or more", line)[1])
    assert 20 < needed <= 4 * LEAST_ROWS + 1
    assert implausible(with_rows(2 * needed)) == []


def test_own_law_that_lacks_what_is_asked_for_is_left_alone():
    class Never:
        breaks = False

        def mode(self, sigma_1, sigma_3):
            return 0

        def reached(self, sigma_1, sigma_3):
            return 0

    scene = specimen(paper())
    assert implausible(replace(scene, rock=replace(scene.rock, criterion=Never()))) == []


@pytest.mark.parametrize("steps", [2, 10, 150, 399, 818, 2585, 10_470, 100_000])
def test_rows_are_no_finer_than_the_steps_bear(steps):
    scene = load_scene("intact", quick=True)
    end = scene.schedule.strain_end * steps / scene.steps
    scene = replace(scene, schedule=replace(scene.schedule, strain_end=end))
    assert scene.steps == pytest.approx(steps, abs=1, rel=1e-4)
    between, rows = scene.row_steps, scene.steps / scene.row_steps
    assert between >= ROW_STEPS or rows < 1.5 * FEWEST_ROWS or between == 1  # else rows are dearer than need be
    assert rows >= min(FEWEST_ROWS, scene.steps)
    assert rows <= 1100.0
    asked = replace(scene, schedule=replace(scene.schedule, rows=max(1, scene.steps)))
    assert asked.row_steps == 1


def test_overburden_that_nothing_holds_is_said():
    ground = InSitu(axis=1, surface=0.1, overburden=2e6, K0=0.3)
    floor, _ = make().loading.boundaries
    still = {"loading_start": AtRest(), "loading_initial_stress": ground, "schedule": {"t_end": 1e-5}}
    scene = make(loading_boundaries=(floor,), **still)
    (line,) = [said for said in implausible(scene) if "overburden" in said]
    assert "= 2 MPa presses at the start and nothing does afterwards" in line
    held = make(**still)
    assert not [said for said in implausible(held) if "overburden" in said]
