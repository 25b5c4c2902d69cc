"""A rock from its data sheet: closed forms of what is derived, and one line for what is wrong."""

import dataclasses
import math

import pytest
from hypothesis import given
from hypothesis import strategies as st
from small_scene import refusal

from rsmpm_ti.errors import RockWarning
from rsmpm_ti.rock.after_failure import CompressionOnly
from rsmpm_ti.rock.criteria import MohrCoulomb
from rsmpm_ti.rock.nonlocal_mean import Local
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.rock.sheet.data_sheet import DEFAULTS, DataSheet
from rsmpm_ti.rock.sheet.reading import KEYS, OTHER_NAMES, from_keywords
from rsmpm_ti.rock.softening import ExponentialSoftening
from rsmpm_ti.units import GPa, MPa, mm

pytestmark = pytest.mark.filterwarnings("error::rsmpm_ti.errors.RockWarning")

GRANITE = {
    "density": 2650.0, "E": 55 * GPa, "nu": 0.25, "UCS": 160 * MPa, "phi": 50.0, "sigma_t": 9 * MPa, "K_Ic": 1.4e6,
}  # fmt: skip


def granite(**changed) -> Rock:
    return Rock.from_lab(**(GRANITE | changed))


def said(**changed) -> str:
    return refusal(lambda: granite(**changed))


@given(
    UCS=st.floats(1e6, 400e6),
    phi=st.floats(5.0, 70.0),
    brittleness=st.floats(8.0, 60.0),
    E=st.floats(1e9, 150e9),
    nu=st.floats(0.0, 0.45),
    K_Ic=st.floats(0.02e6, 5e6),
)
def test_strengths_and_energy_of_the_rock_are_those_of_the_sheet(UCS, phi, brittleness, E, nu, K_Ic):
    apex = UCS * (1.0 - math.sin(math.radians(phi))) / (2.0 * math.sin(math.radians(phi)))
    sigma_t = max(min(UCS / brittleness, 0.99 * apex, 99e6), 0.011e6)
    sheet = from_keywords(density=2600, E=E, nu=nu, UCS=UCS, phi=phi, sigma_t=sigma_t, K_Ic=K_Ic)
    laws = sheet.laws()
    assert laws["criterion"].ucs == pytest.approx(UCS, rel=1e-12)
    assert laws["criterion"].tensile_strength == sigma_t and laws["criterion"].friction_angle == phi
    softening = laws["after_failure"].softening
    assert softening.G_f_I == pytest.approx(K_Ic**2 * (1.0 - nu**2) / E, rel=1e-12)
    assert softening.G_f_II == pytest.approx(4.8 * softening.G_f_I, rel=1e-12)
    zone = laws["elasticity"].E / (1.0 - nu**2) * softening.G_f_I / sigma_t**2
    assert sheet.zones[0] == pytest.approx(zone, rel=1e-12)


def test_cohesion_and_ucs_say_the_same():
    by_ucs = granite().criterion
    by_cohesion = granite(UCS=None, cohesion=by_ucs.cohesion).criterion
    assert by_cohesion == by_ucs and by_cohesion.ucs == pytest.approx(160e6, rel=1e-12)
    assert MohrCoulomb(cohesion=by_ucs.cohesion, friction_angle=50.0, tensile_strength=9e6) == by_ucs


def test_energy_is_taken_as_it_is_and_from_toughness_or_from_tensile_strength():
    assert granite(K_Ic=None, G_f=35.0).after_failure.softening.G_f_I == 35.0
    by_zhang = granite(K_Ic=None, G_f_II=900.0).after_failure.softening.G_f_I
    assert by_zhang == pytest.approx((9e6 / 6.88) ** 2 * (1.0 - 0.25**2) / 55e9, rel=1e-12)
    sheet = from_keywords(**(GRANITE | {"K_Ic": None, "G_f": 30.0}))
    assert sheet.toughness**2 * (1.0 - 0.25**2) / 55e9 == pytest.approx(30.0, rel=1e-12)


@pytest.mark.parametrize("kind, ratio", [("metamorphic", 0.9), ("igneous", 0.8), ("sedimentary", 0.7)])
def test_brazilian_strength_is_reduced_by_the_kind_of_rock(kind, ratio):
    rock = granite(sigma_t=None, BTS="10 MPa", kind=kind)
    assert rock.criterion.tensile_strength == pytest.approx(ratio * 10e6, rel=1e-12)


def test_defaults_of_what_a_sheet_lacks():
    rock = granite()
    assert rock.after_failure.residual_friction_angle == 30.0
    assert granite(phi=20, G_f_II=900.0).after_failure.residual_friction_angle == 20.0
    assert rock.nonlocal_mean.length == 1 * mm
    assert granite(dx=1 * mm, G_f_II=900.0).nonlocal_mean.length == 2 * mm
    assert granite(dx=0.1 * mm).nonlocal_mean.length == 1 * mm
    assert granite(averaging_length=3 * mm, dx=2 * mm, G_f_II=2000.0).nonlocal_mean.length == 3 * mm


def test_every_default_is_derived_in_words():
    bare = from_keywords(**(GRANITE | {"K_Ic": None, "sigma_t": None, "BTS": "10 MPa", "kind": "igneous"}))
    lines = " ".join(bare.derived())
    assert all(key in lines for key in DEFAULTS) and all(len(row) == 3 for row in DEFAULTS.values())
    full = {"phi_r": 32.0, "G_f_II": 900.0, "averaging_length": 1 * mm}
    assert len(from_keywords(**(GRANITE | full)).derived()) == 3  # cohesion, G_f, and how long the zones are


def test_law_and_softening_are_chosen_by_a_word():
    paper = granite(law="paper")
    assert paper.after_failure == CompressionOnly() and paper.nonlocal_mean == Local()
    assert isinstance(granite(softening="exponential").after_failure.softening, ExponentialSoftening)


def test_sheet_of_the_papers_rock_is_the_rock_of_the_lab_scenes():
    sheet = {"density": 2600, "E": "17 GPa", "nu": 0.14, "cohesion": "5.95 MPa", "phi": "40 deg", "sigma_t": "2 MPa"}
    assert Rock.from_lab(**sheet, G_f=5, G_f_II=240) == lab_rock()


@pytest.mark.parametrize(
    "text", ["1.4 MPa*m^0.5", "1.4MPa√m", "1.4 MPa sqrt(m)", "1.4 MPa m^(1/2)", "1.4 MPa·m^0.5", "1.4 MN m^-3/2"]
)
def test_toughness_takes_the_ways_in_which_it_is_written(text):
    assert granite(K_Ic=text) == granite()


@pytest.mark.parametrize(
    "changed, words",
    [
        ({"E": "55 MPa"}, "E = '55 MPa' is refused: it must be 0.1 GPa to 200 GPa; did you mean 55 GPa?"),
        ({"E": 55}, "did you mean 55 GPa?"),
        ({"density": 2.65}, "did you mean 2650 kg/m^3?"),
        ({"phi": 0.8}, "did you mean 45.8366 deg?"),
        ({"K_Ic": 1.4}, "did you mean 1.4 MPa*m^0.5?"),
        ({"K_Ic": "1.4 MPa"}, "its units are MPa*m^0.5"),
        ({"E": "55 gpa"}, "capital letters count: did you mean '55 GPa'?"),
        ({"nu": "0.2 m"}, "it has no unit"),
        ({"nu": 0.6}, "it must be a number from 0 to 0.49"),
        ({"phi": 75}, "it must be 5 deg to 70 deg"),
        ({"kic": 1e6}, "did you mean K_Ic?"),
        ({"tensile strength": 1e6}, "did you mean sigma_t?"),
        ({"G_f": 30}, "K_Ic and G_f: give one of them; they say the same"),
        ({"cohesion": 20e6}, "UCS and cohesion: give one of them"),
        ({"UCS": None}, "UCS and cohesion: give one of them, neither is there"),
        ({"BTS": 10e6}, "sigma_t and BTS: give one of them"),
        ({"sigma_t": None, "BTS": 10e6}, "kind = None is refused"),
        ({"kind": "Granite"}, "it must be 'igneous', 'metamorphic' or 'sedimentary'"),
        ({"sigma_t": 30e6}, "at most 24.43 MPa, where Mohr-Coulomb of this strength and phi = 50 degrees ends"),
        ({"UCS": 8e6}, "are the two exchanged?"),
        ({"phi_r": 55}, "at most phi = 50 degrees; rock that broke is no stronger"),
        ({"E": None}, "E is missing"),
        ({"E": True}, "E = True is refused"),
        ({"E": math.nan}, "E = nan is refused"),
    ],
)  # fmt: skip
def test_wrong_number_is_refused_in_the_words_of_a_laboratory(changed, words):
    assert words in said(**changed)


def test_angle_that_a_refusal_names_is_the_widest():
    """The remedy of a tensile strength beyond the apex can be typed."""
    assert "phi is at most 46.6 degrees" in said(sigma_t=30e6)
    with pytest.warns(RockWarning, match="UCS over sigma_t is 5.33"):
        granite(sigma_t=30e6, phi=46.6, K_Ic=2.2e6, law="paper")
    assert "is refused" in said(sigma_t=30e6, phi=46.7)


@pytest.mark.parametrize(
    "changed, words",
    [
        ({"UCS": 60e6, "phi": 30}, "UCS over sigma_t is 6.67, and open cracks alone make it 8"),
        (
            {"E": "90 GPa", "K_Ic": 1e6, "G_f_II": 5.0, "UCS": "10 MPa", "phi": 30, "sigma_t": 1e6},
            "G_f_II = 5 J/m2 is below G_f = 10.42 J/m2",
        ),
        ({"K_Ic": 0.5e6, "G_f_II": 900.0}, "strength is lost over 3.09 mm in tension"),
        ({"UCS": "300 MPa"}, "in shear"),
    ],
)
def test_what_is_hard_to_believe_is_said_in_one_line_and_taken(changed, words):
    with pytest.warns(RockWarning) as warned:
        granite(**changed)
    (line,) = [str(w.message) for w in warned]
    assert words in line and line.startswith("rock rock: ") and "\n" not in line


def test_names_of_values_are_no_keys_of_another():
    assert set(OTHER_NAMES.values()) <= set(KEYS)
    assert not {name for name in OTHER_NAMES} & {key.lower() for key in KEYS if key != OTHER_NAMES.get(key.lower())}


def test_sheet_is_frozen_and_checked_when_it_is_built():
    sheet = DataSheet(**GRANITE)
    with pytest.raises(dataclasses.FrozenInstanceError):
        sheet.E = 1.0
    assert "sheet.E = '55 GPa' is refused" in refusal(lambda: DataSheet(**(GRANITE | {"E": "55 GPa"})))
