"""A weight that comes slowly, as a force field of the scene; what else may stand in its place."""

from dataclasses import dataclass
from typing import Annotated

import taichi as ti
from pydantic_core import core_schema

from rsmpm_ti.checks import Finite, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.loading_start import Duration
from rsmpm_ti.units import Acceleration


@ti.data_oriented
@checked("gravity")
@dataclass(frozen=True, kw_only=True)
class Gravity:
    """A body force that grows to `b` [m/s^2] during `ramp` [s] by the smooth step b (3 s^2 - 2 s^3), s = t/ramp.

    At once, as by `loading.body_force`, it doubles the stress for a moment. After a ramp that is longer than its period
    T a mode still swings by less than 12.6/(2 pi ramp/T)^2 of its part (docs/references.md, section 13). When it fails:
    a ramp no longer than the slowest period shakes. Good values: five of these, for a column of height H 20 H/c_p.
    """

    b: tuple[Annotated[Acceleration, Finite], ...]
    ramp: Duration

    @ti.func
    def acceleration(self, X, t):
        s = ti.max(0.0, ti.min(t / self.ramp, 1.0))
        return s * s * (3.0 - 2.0 * s) * ti.Vector(self.b)


class ForceField:
    """In the annotation of a field: a Gravity, also as a record has it, none, or an object of a scene's own."""

    @staticmethod
    def __get_pydantic_core_schema__(source, handler):
        def own(value, inner):
            named = value is None or isinstance(value, dict | Gravity | type)
            return inner(value) if named or not callable(getattr(value, "acceleration", None)) else value

        inner = core_schema.nullable_schema(handler.generate_schema(Gravity))
        return core_schema.no_info_wrap_validator_function(own, inner)


def check_gravity(scene) -> None:
    """Raises SceneError for a Gravity that does not fit its scene."""
    field = scene.loading.force_field
    if isinstance(field, Gravity) and len(field.b) != scene.dim:
        raise refuse("gravity.b", field.b, f"{scene.dim} components in m/s^2")
