"""What `checked` makes of a dataclass: refused where an annotation says so, else a dataclass as any other."""

import copy
import dataclasses
import pickle
from types import SimpleNamespace
from typing import Annotated, Literal

import numpy as np
import pytest
from annotated_types import Interval
from small_scene import BLOCK, body, make, refusal

from rsmpm_ti import SceneError, Schedule
from rsmpm_ti.checks import KNOWN, ByType, Remedy, checked
from rsmpm_ti.rock.after_failure import Void
from rsmpm_ti.rock.criteria import MohrCoulomb, Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.regions import Box, Difference, Union
from rsmpm_ti.spec.scene import Loading
from rsmpm_ti.spec.scene_json import to_plain
from rsmpm_ti.units import Length


@checked("layer")
@dataclasses.dataclass(frozen=True, kw_only=True)
class Layer:
    """A class as a user's file may hold one: with every kind of annotation."""

    thickness: Annotated[Length, Interval(gt=0.0, le=1.0), Remedy("a metre is much")]
    rock: Annotated[Hooke, ByType]
    kind: Literal["hard", "soft"] = "hard"
    count: Annotated[int, Interval(ge=1, le=3)] = 1
    span: tuple[float, float] | None = None

    def __post_init__(self):
        if self.kind == "soft" and self.count > 1:
            raise ValueError("soft layers come alone")


ROCK = Hooke(E=1e9, nu=0.2)


def test_class_stays_a_dataclass():
    layer = Layer(thickness=0.5, rock=ROCK, span=(0.0, 1.0))
    assert [f.name for f in dataclasses.fields(Layer)] == ["thickness", "rock", "kind", "count", "span"]
    assert layer == Layer(thickness=0.5, rock=Hooke(E=1e9, nu=0.2), span=(0.0, 1.0)) != Layer(thickness=0.4, rock=ROCK)
    assert hash(layer) == hash(dataclasses.replace(layer)) and dataclasses.replace(layer, count=2).count == 2
    assert repr(layer).startswith("Layer(thickness=0.5, rock=Hooke(E=1000000000.0, nu=0.2, plane_stress=False)")
    assert copy.deepcopy(ROCK) == pickle.loads(pickle.dumps(ROCK)) == ROCK
    assert layer.rock is ROCK  # kernels are compiled for an object, not for its value
    with pytest.raises(dataclasses.FrozenInstanceError):
        layer.count = 2


def test_whole_number_will_do_for_a_number_and_becomes_one():
    layer = Layer(thickness=1, rock=ROCK, span=(0, 1))
    assert type(layer.thickness) is float and list(map(type, layer.span)) == [float, float]


@pytest.mark.parametrize(
    "wrong, message",
    [
        ({"thickness": 0.0}, "layer.thickness = 0.0 is refused: it must be a positive number in (0, 1] m; a metre is"),
        ({"thickness": float("nan")}, "layer.thickness = nan is refused"),
        ({"thickness": True}, "layer.thickness = True is refused"),
        ({"thickness": "1"}, "layer.thickness = '1' is refused"),
        ({"rock": Void()}, "layer.rock = Void() is refused: it must be Hooke"),
        ({"kind": "wet"}, "layer.kind = 'wet' is refused: it must be 'hard' or 'soft'"),
        ({"count": 4}, "layer.count = 4 is refused: it must be an integer in [1, 3]"),
        ({"count": 1.0}, "layer.count = 1.0 is refused"),
        ({"span": (0.0,)}, "layer.span = (0.0,) is refused: it must be 2 numbers separated by commas or none"),
        ({"span": (0.0, float("inf"))}, "layer.span = (0.0, inf) is refused"),
        ({"span": [0.0, 1.0]}, "layer.span = [0.0, 1.0] is refused"),
        ({"kind": "soft", "count": 2}, "layer: Layer cannot be built: soft layers come alone"),
        ({"colour": 1}, "layer: Layer has no field ['colour']; it has ['count', 'kind', 'rock', 'span', 'thickness']"),
    ],
)
def test_wrong_field_is_refused_by_name_value_and_range(wrong, message):
    assert refusal(lambda: Layer(**({"thickness": 0.5, "rock": ROCK} | wrong))).startswith(message)


def test_missing_fields_are_named():
    assert refusal(Layer) == "layer: Layer needs thickness, rock"
    assert "has no field ['thicknes']" in refusal(lambda: Layer(thicknes=1.0, rock=ROCK))


def test_dict_that_names_its_class_stands_for_an_object_and_is_refused_by_place():
    criterion = {"type": "MohrCoulomb", "cohesion": 6e6, "friction_angle": 40.0, "tensile_strength": 2e6}
    rock = {"density": 2600.0, "elasticity": to_plain(ROCK)}
    built = Rock(**rock, criterion=criterion)
    assert built.criterion == MohrCoulomb(cohesion=6e6, friction_angle=40.0, tensile_strength=2e6)
    wrong = [
        ({"friction_angle": 90.0}, "rock.criterion.friction_angle = 90.0 is refused: it must be a number in [0, 89]"),
        ({"tensile_strength": 8e6}, "rock.criterion: criterion.tensile_strength = 8000000.0 is refused"),
        ({"phi": 1.0}, "rock.criterion: MohrCoulomb has no field ['phi']"),
        ({"type": "Void"}, "rock.criterion = {'type': 'Void'"),
    ]
    for change, message in wrong:
        assert refusal(lambda change=change: Rock(**rock, criterion=criterion | change)).startswith(message)


class Wedge:
    """A region of a scene file's own."""

    def contains(self, x):
        return x[:, 1] < 0.05 + 0.5 * x[:, 0]

    def bounds(self):
        return np.array([0.0, 0.0]), np.array([0.05, 0.1])


class Sticky:
    """A law after failure of a scene file's own, as far as the checks look: all that those of the package share."""

    def __getattr__(self, name):
        if name in dir(Void):
            return getattr(Void(), name)
        raise AttributeError(name)


def test_object_of_a_class_from_outside_will_do_where_it_has_what_is_asked():
    scene = make(bodies=body(region=Wedge()))
    assert isinstance(scene.bodies[0].region, Wedge) and len(scene.particles()[0].x) > 1000
    assert isinstance(Union(parts=(BLOCK, Wedge())).parts[1], Wedge)
    assert isinstance(Difference(whole=Wedge(), removed=()).whole, Wedge)
    assert isinstance(dataclasses.replace(make().rock, after_failure=Sticky()).after_failure, Sticky)
    assert to_plain(Difference(whole=BLOCK, removed=()))["whole"] == to_plain(BLOCK)


STRANGERS = [SimpleNamespace(contains=3), Box, Unbreakable(), Hooke, "Box", 3, None, {"type": "Wedge"}, {}]


@pytest.mark.parametrize("stranger", STRANGERS)
def test_other_objects_will_not_do(stranger):
    assert "body.region = " in refusal(lambda: body(region=stranger))


def test_class_from_outside_is_not_one_that_a_record_may_name():
    assert "Layer" not in KNOWN and "Wedge" not in KNOWN
    assert "force_field" in refusal(lambda: Loading(force_field=Wedge()))


def test_heir_of_scene_data_is_refused_since_nobody_would_check_it():
    with pytest.raises(TypeError, match="Hooke is final"):
        type("Stiffer", (Hooke,), {})


def test_scalars_of_numpy_are_pythons_own():
    rock = Hooke(E=np.float32(17e9), nu=np.float64(0.25))
    assert (type(rock.E), type(rock.nu)) == (float, float)
    assert Schedule(t_end=1.0, rows=np.int64(5)).rows == 5
    with pytest.raises(SceneError, match="elasticity.E = True is refused"):
        Hooke(E=np.True_, nu=0.25)
