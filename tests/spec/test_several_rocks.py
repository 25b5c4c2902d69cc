"""Several rocks in one scene: what is refused, in one line, and what a record, a check and `--rock` make of them."""

from dataclasses import dataclass, replace

import pytest
import taichi as ti
from small_scene import make, refusal

from rsmpm_ti.errors import RockWarning
from rsmpm_ti.rock.after_failure import AfterFailure, CompressionOnly, Variable
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.nonlocal_mean import Local
from rsmpm_ti.rock.presets import lab_rock
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Absorbing
from rsmpm_ti.spec.ground.in_situ import InSitu
from rsmpm_ti.spec.library.rocks import with_rock
from rsmpm_ti.spec.loading_start import Affine, AtRest
from rsmpm_ti.spec.regions import Box, Difference, Disc
from rsmpm_ti.spec.review.plausible import implausible
from rsmpm_ti.spec.scene import Body
from rsmpm_ti.spec.scene_json import from_plain, to_plain

HARD = Rock(density=2900.0, elasticity=Hooke(E=60e9, nu=0.2), criterion=Unbreakable())
DISC = Disc(centre=(0.025, 0.05), radius=0.01)
AROUND = Difference(whole=Box(lower=(0.0, 0.0), upper=(0.05, 0.1)), removed=(DISC,))


def scene(inner: Rock = HARD, **changes):
    """A block with an inclusion."""
    bodies = (Body(region=AROUND), Body(region=DISC, rock=inner))
    return make(**{"bodies": bodies, "loading_start": AtRest()} | changes)


def same(**elsewhere) -> Rock:
    """The rock of the block, but for some fields."""
    return replace(make().rock, **elsewhere)


def test_rocks_are_told_apart_by_their_values():
    plain = make().rock
    assert scene().rocks == (plain, HARD)
    assert scene(inner=replace(plain)).rocks == (plain,)
    twice = replace(scene(), bodies=(*scene().bodies[:1], replace(scene().bodies[1], rock=replace(HARD))))
    assert twice.rocks == (plain, HARD) and twice.rock_of(twice.bodies[0]) == plain


def test_steps_suit_the_fastest_rock():
    assert scene().wave_speed == HARD.wave_speed() > make().wave_speed
    assert scene().density == HARD.density


def test_a_record_brings_back_each_rock():
    assert from_plain(to_plain(scene())) == scene()
    old = to_plain(make())
    for body in old["bodies"]:
        del body["rock"]  # as versions of one rock wrote it
    assert from_plain(old) == make()


def test_elastic_is_without_failure_in_every_rock():
    elastic = scene(inner=lab_rock()).elastic()
    assert not elastic.breaks and len(elastic.rocks) == 2


def test_another_rock_takes_the_place_of_the_scenes_alone():
    with pytest.warns(RockWarning, match=r"^bodies\[1\].rock: kept"):
        changed = with_rock(scene(), lab_rock())
    assert changed.rocks == (lab_rock(), HARD)


def test_doubts_name_the_body():
    said = implausible(scene(inner=replace(HARD, elasticity=Hooke(E=60.0, nu=0.2))))
    assert [line for line in said if line.startswith("bodies[1].rock.elasticity.E")]
    weak = MohrCoulomb(cohesion=1e6, friction_angle=30.0, tensile_strength=1e6)
    said = implausible(scene(inner=replace(HARD, criterion=weak)))
    assert [line for line in said if line.startswith("bodies[1].rock")]


@ti.data_oriented
@dataclass(frozen=True, kw_only=True)
class Counts(AfterFailure):
    """Remembers a whole number under a name that lab rock has for a strain."""

    history = (Variable(name="slip", unit="1", about="a count", whole=True),)


BREAKS = MohrCoulomb(cohesion=6e6, friction_angle=40.0, tensile_strength=2e6)
ODD = Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=BREAKS, after_failure=Counts())
PLATE = Hooke(E=17e9, nu=0.14, plane_stress=True)
SOON = {"t_end": 1e-4}
GROUND = {"initial_stress": InSitu(axis=1, surface=0.1, K0=0.5), "body_force": (0.0, -9.81), "boundaries": ()}


@pytest.mark.parametrize(
    "build, words",
    [
        (lambda: make(bodies=(Body(region=AROUND, rock=HARD),)), ["scene.rock", "that of a body"]),
        (lambda: scene(loading_start=Affine()), ["loading.start", "Affine", "bodies[1].rock", "Ramp"]),
        (lambda: scene(inner=same(elasticity=PLATE)), ["bodies[1].rock.elasticity.plane_stress", "False"]),
        (
            lambda: scene(inner=same(density=2700.0), loading_confinement=1e6),
            ["bodies[1].rock.density = 2700", "2600 kg/m^3", "pulls = True"],
        ),
        (
            lambda: scene(inner=same(density=2700.0), **{f"loading_{k}": v for k, v in GROUND.items()}, schedule={
                "t_end": 1e-4}),
            ["bodies[1].rock.density = 2700", "in the ground"],
        ),
        (lambda: scene(inner=replace(lab_rock(length=1e-4))), ["bodies[1].rock: rock.nonlocal_mean.length"]),
        (
            lambda: scene(inner=same(elasticity=Hooke(E=1e6, nu=0.2)), loading_confinement=1e6),
            ["bodies[1].rock: loading.confinement", "bulk modulus"],
        ),
        (lambda: scene(inner=ODD, rock=lab_rock()), ["bodies[1].rock.after_failure", "'slip'", "rename"]),
        (lambda: scene(inner=same(viscosity=None)), ["rock", "viscosity"]),
        (lambda: scene(inner=3.0), ["body", "rock"]),
        (
            lambda: scene(loading_boundaries=(Absorbing(axis=1, side="upper", position=0.1),), schedule=SOON),
            ["loading.boundaries", "bodies[1].rock has other waves"],
        ),
        (lambda: scene(loading_time_scale="auto"), ["time_scale = 'auto'", "one body"]),
    ],
)  # fmt: skip
def test_wrong_input_is_refused_in_one_line(build, words):
    message = refusal(build)
    assert [word for word in words if word not in message] == []


def test_there_may_be_only_so_many():
    strips = [Box(lower=(0.0, 0.01 * k), upper=(0.05, 0.01 * (k + 1))) for k in range(10)]
    bodies = [Body(region=strip, rock=same(density=2600.0 + k)) for k, strip in enumerate(strips)]
    assert "at most 8 different rocks, not 10" in refusal(lambda: make(bodies=tuple(bodies), loading_start=AtRest()))


def test_overlapping_bodies_are_refused():
    whole = scene(bodies=(Body(region=AROUND.whole), Body(region=DISC, rock=HARD)))
    assert "overlaps" in refusal(whole.particles)


def test_laws_that_remember_alike_go_together():
    softer = replace(lab_rock(), after_failure=CompressionOnly(), nonlocal_mean=Local())
    assert len(scene(inner=softer, rock=lab_rock()).rocks) == 2
