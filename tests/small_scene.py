"""One small scene that tests change in one place, and what refuses it."""

from dataclasses import replace

import pytest
from exact import p_wave_speed

from rsmpm_ti.errors import SceneError
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.criteria import Unbreakable
from rsmpm_ti.rock.elasticity import Hooke
from rsmpm_ti.rock.rock import Rock
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.library.places import available
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice

NAN, INF = float("nan"), float("inf")
SPEED = p_wave_speed(17e9, 0.14, 2600.0)
DX = 0.5e-3
BLOCK = Box(lower=(0.0, 0.0), upper=(0.05, 0.1))
SHIPPED = sorted(available())


def make(**changes) -> Scene:
    """Example 1 of the paper without its flaw, true density; `changes` by field, or by domain_, loading_ ... field."""
    platens = (
        Platen(axis=1, side="lower", position=0.0, speed=2.5e-3),
        Platen(axis=1, side="upper", position=0.1, speed=-2.5e-3),
    )
    fields = {
        "title": "block",
        "domain": {"lower": (-0.005, 0.0), "upper": (0.055, 0.1), "dx": DX},
        "bodies": (Body(region=BLOCK, seeding=Lattice()),),
        "rock": Rock(density=2600.0, elasticity=Hooke(E=17e9, nu=0.14), criterion=Unbreakable()),
        "loading": {"boundaries": platens, "start": Affine(), "width": 0.05},
        "schedule": {"strain_end": 1e-3},
        "shape": Linear(),
    }
    for name, value in changes.items():
        owner, _, field = name.partition("_")
        if field and owner in ("domain", "loading", "schedule"):
            fields[owner][field] = value
        else:
            fields[name] = value
    kinds = {"domain": Domain, "loading": Loading, "schedule": Schedule}
    return Scene(**{k: kinds[k](**v) if isinstance(v, dict) else v for k, v in fields.items()})


def platens(**changes) -> tuple[Platen, Platen]:
    lower, upper = make().loading.boundaries
    return lower, replace(upper, **changes)


def body(**changes) -> tuple[Body]:
    return (replace(make().bodies[0], **changes),)


def refusal(build) -> str:
    with pytest.raises(SceneError) as refused:
        build()
    message = str(refused.value)
    assert "\n" not in message
    return message
