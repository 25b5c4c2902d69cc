"""Units in texts: `--set flaw_length=15mm`."""

import subprocess
import sys

import pytest
from small_scene import refusal

from rsmpm_ti.scene import main
from rsmpm_ti.spec.loader import load_scene
from rsmpm_ti.units import COMMON, Unit, advice, percentage, quantity


def cube(**settings):
    return load_scene("cube", quick=True, settings=settings)


@pytest.mark.parametrize(
    "text, unit, number",
    [
        ("15mm", "m", 15e-3),
        ("55 GPa", "Pa", 55e9),
        ("+2.5e-1 um", "m", 0.25e-6),
        ("-5 mm", "m", -5e-3),
        ("0.5 rad", "degrees", 28.64788975654116),
        ("90 deg/s", "rad/s", 1.5707963267948966),
        ("2.6 g/cm^3", "kg/m^3", 2600.0),
        ("2.6 g/cm3", "kg/m^3", 2600.0),
        ("5 J/m2", "J/m^2", 5.0),
        ("5 N/m", "J/m^2", 5.0),
        ("4 cm^2", "m^2 or m^3", 4e-4),
        ("5 mm", "m or m^2", 5e-3),
        ("2600 kg m^-3", "kg/m^3", 2600.0),
        ("1.5 MPa sqrt(m)", "Pa*m^0.5", 1.5e6),
        ("1.5MPa√m", "Pa*m^0.5", 1.5e6),
        ("1.5 MN/m^(3/2)", "Pa*m^0.5", 1.5e6),
    ],
)
def test_number_with_a_unit_is_that_number_in_si(text, unit, number):
    assert quantity(text, Unit(unit)) == pytest.approx(number, rel=1e-15)  # one rounding of the factor


def test_unit_that_the_dimension_of_a_scene_decides_is_no_other(capsys):
    assert quantity("4 cm^3", Unit("m^2 or m^3"), dim=3) == pytest.approx(4e-6, rel=1e-15)
    assert quantity("4 cm^3", Unit("m^2 or m^3"), dim=2) is None and quantity("5 mm", Unit("m or m^2"), dim=3) is None
    assert main(["cube", "--quick", "--check", "--set", "loading.width=50mm^2"]) == 2
    assert "loading.width=50mm^2 is refused" in capsys.readouterr().err
    assert main(["cube", "--quick", "--check", "--set", "loading.width=50mm"]) == 0


@pytest.mark.parametrize(
    "text, unit",
    [
        ("15", "m"),
        ("15 MPa", "m"),
        ("1 m/m", "degrees"),  # a pure number is no angle, though both have no dimension
        ("1 Hz", "rad/s"),
        ("1e", "m"),  # the charge of an electron
        ("1 nosuch", "m"),
        ("1.5 MPa", "Pa*m^0.5"),
        ("1.5 MPa m", "Pa*m^0.5"),
        ("5 mm mm", "m"),
        ("5 dBm2", "m"),
        ("5 mdegC", "m"),
        ("1 k-0", "m"),  # the constant of Boltzmann, of which pint loses the power 0
        ("1/2 m", "m"),
        ("1..2 m", "m"),
        ("m", "m"),
        ("1 m^9^9^9^9", "m"),  # a number of 10^8 digits, were it computed
        ("1" + "m" * 10_000, "m"),
        ("1 __import__('os')", "m"),
    ],
)
def test_other_texts_are_no_quantity(text, unit):
    assert quantity(text, Unit(unit)) is None


def test_keywords_and_fields_of_a_scene_take_units():
    scene = cube(
        **{
            "flaw_length": "1.6 cm",
            "flaw_angle": "30 deg",
            "rock.elasticity.E": "55 GPa",
            "rock.density": "2.7 g/cm^3",
            "domain.lower": "-6mm, 0",
            "loading.width": "5 cm",
            "bodies.0.region.removed.0.width": "4mm",
        }
    )
    assert scene.bodies[0].region.removed[0].length == 0.016 and scene.bodies[0].region.removed[0].angle == 30.0
    assert scene.rock.elasticity.E == 55e9 and scene.rock.density == pytest.approx(2700.0, rel=1e-15)
    assert scene.domain.lower == (-0.006, 0.0) and scene.loading.width == 0.05
    assert scene.bodies[0].region.removed[0].width == 0.004


@pytest.mark.parametrize(
    "name, text, allowed",
    [
        ("flaw_length", "15MPa", "a number in m"),
        ("flaw_angle", "15 mm", "a number in degrees"),
        ("rock.elasticity.E", "55 m", "a positive number in [1e-12, 1e+18] Pa"),
        ("rock.elasticity.nu", "0.2 m", "a number in (-1, 0.5)"),
        ("domain.lower", "0 s,0", "2 to 3 numbers separated by commas in [-1e+09, 1e+09] m"),
        ("strain_end", "1 mm", "a number"),
    ],
)
def test_unit_of_another_dimension_is_refused(name, text, allowed):
    assert refusal(lambda: cube(**{name: text})).startswith(f"{name}={text} is refused: it must be {allowed}")


@pytest.mark.parametrize(
    "name, text, remedy",
    [
        ("rock.criterion.cohesion", "14.63 mpa", "capital letters count: did you mean '14.63 MPa'?"),
        ("rock.criterion.cohesion", "14.63mPa", "capital letters count: did you mean '14.63 MPa'?"),
        ("rock.density", "2.6 G/CM3", "capital letters count: did you mean '2.6 g/cm^3'?"),
        ("flaw_length", "15 Mm", "capital letters count: did you mean '15 mm'?"),
        ("domain.lower", "0 mm, 1 KM", "capital letters count: did you mean '1 km'?"),
        ("rock.elasticity.E", "55 m", "its units are MPa, GPa, kPa, Pa, bar, psi, and others of that dimension"),
        ("rock.elasticity.E", "55 nosuch", "its units are MPa, GPa, kPa, Pa, bar, psi, and others of that dimension"),
        ("loading.width", "5 mm^2", "its units are mm, cm, um, m, km, in, and others of that dimension"),
        ("flaw_length", "15%", "give its unit, such as mm"),
        ("strain_end", "1 mm", "it has no unit"),
    ],
)
def test_refusal_of_a_unit_says_what_to_type(name, text, remedy):
    said = refusal(lambda: cube(**{name: text}))
    assert said.startswith(f"{name}={text} is refused: it must be ") and said.partition("; ")[2].startswith(remedy)


def test_common_units_are_units_and_no_two_differ_by_capitals_alone():
    for name, words in COMMON.items():
        for word in words.split():
            assert quantity(f"1 {word}", Unit(name)) is not None, word
            assert advice(f"1 {word.swapcase()}", Unit(name)) == (f"capital letters count: did you mean '1 {word}'?"), (
                word
            )
        assert len({word.lower() for word in words.split()}) == len(words.split())


@pytest.mark.parametrize(
    "text, number",
    [("0.35%", 0.0035), ("0.35 %", 0.0035), ("-7%", -0.07), ("5.%", 0.05), (".1%", 0.001), ("29%", 0.29)],
)
def test_percentage_is_the_number_that_one_would_have_typed(text, number):
    assert percentage(text) == number


@pytest.mark.parametrize("text", ["", "%", ".%", "1%%", "1 %m", "nan%", "1_0%", "1e-3%", "9" * 100 + "%"])
def test_other_texts_are_no_percentage(text):
    assert percentage(text) is None


def test_pure_numbers_take_percentages():
    scene = cube(**{"strain_end": "0.35%", "rock.elasticity.nu": "25%"})
    assert scene.schedule.strain_end == 0.0035 and scene.rock.elasticity.nu == 0.25
    assert "must be an integer" in refusal(lambda: cube(**{"schedule.rows": "50%"}))


def test_range_holds_for_numbers_with_units():
    assert "rock.elasticity.E = -55000000000.0 is refused" in refusal(lambda: cube(**{"rock.elasticity.E": "-55 GPa"}))


def test_settings_from_python_are_texts_or_numbers():
    assert cube(**{"rock.elasticity.E": 55e9, "flaw_angle": 30}) == cube(
        **{"rock.elasticity.E": "55 GPa", "flaw_angle": "30"}
    )
    assert "flaw_angle=True" in refusal(lambda: cube(flaw_angle=True))


KEYWORDS = """
from rsmpm_ti import Length, Scene, load_scene

def scene(*, typed: Length = 1e-3, plain: float = 1.0, bare=1.0, odd: 3 = 1.0, late: "float" = 1.0) -> Scene:
    return load_scene("intact", dx=typed * plain * bare * late)
"""


def test_keyword_of_a_users_scene_takes_the_unit_of_its_annotation(tmp_path):
    path = tmp_path / "mine.py"
    path.write_text(KEYWORDS)

    def dx(**settings):
        return load_scene(str(path), settings=settings).domain.dx

    assert dx(typed="2 mm") == 2e-3 and dx(typed="1mm", late="2") == 2e-3
    for name in ("plain", "bare"):  # which unit a pure number would be in, nobody knows
        assert f"{name}=2 mm is refused: it must be a number" in refusal(lambda name=name: dx(**{name: "2 mm"}))
    assert "odd=2 is refused: it is annotated 3" in refusal(lambda: dx(odd="2"))


def test_pint_is_loaded_only_for_a_text_with_a_unit():
    load = "load_scene('cube', settings={'flaw_length': %r})"
    code = (
        f"import sys; from rsmpm_ti import load_scene; {load % '0.016'}; a = 'pint' in sys.modules; {load % '16mm'}; "
    )
    code += "print(a, 'pint' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout == "False True\n"
