"""Fields of the particles: those that a scene's physics needs, and no more."""

from typing import NamedTuple

import numpy as np
import taichi as ti

from rsmpm_ti.fields.nodes import components
from rsmpm_ti.rock.after_failure import Variable
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.spec.bodies.rocks import variables_of
from rsmpm_ti.spec.review.memory import averaging
from rsmpm_ti.spec.scene import Scene


@ti.data_oriented
class LawHistory:
    """What the law after failure remembers of each particle: a field for each of its variables, by its name."""

    def __init__(self, variables: tuple[Variable, ...], dim: int, count: int, real):
        self.variables = variables
        self.real_fields, self.whole_fields = [], []
        for variable in variables:
            kind, fields = (ti.i32, self.whole_fields) if variable.whole else (real, self.real_fields)
            layout = ti.Layout.SOA
            fields.append(
                ti.Vector.field(dim, kind, count, layout=layout) if variable.per_axis else ti.field(kind, count)
            )
            setattr(self, variable.name, fields[-1])
        self.components = tuple(c for field in (*self.real_fields, *self.whole_fields) for c in components(field))
        self.has_normal = any(variable.name == "crack_normal" for variable in variables)

    def to_numpy(self) -> dict[str, np.ndarray]:
        """The variables by name as they lie in memory, [n] or [n, dim]."""
        return {variable.name: getattr(self, variable.name).to_numpy() for variable in self.variables}


class Stored(NamedTuple):
    """A field of the particles that a run goes on with: name, number of components, whether of whole numbers."""

    name: str
    size: int
    whole: bool = False


def stored(scene: Scene) -> tuple[Stored, ...]:
    """What `Particles` stores of each particle of a scene, real numbers first, in its order."""
    dim, rocks = scene.dim, scene.rocks
    of_law = [Stored(v.name, dim if v.per_axis else 1, v.whole) for v in variables_of(scene)]
    found = [Stored("reference", dim), Stored("u", dim), Stored("v", dim), Stored("sigma", PACKED_LENGTH[dim])]
    found += [Stored("J", 1), Stored("volume", 1)]
    found += [Stored("C", dim * dim)] * scene.transfer.affine + [Stored("q", 1)] * any(
        rock.viscosity.acts for rock in rocks
    )
    found += [Stored("strength", 1)] * any(rock.heterogeneity.varies for rock in rocks)
    found += [entry for entry in of_law if not entry.whole]
    if any(averaging(scene)):
        found += [Stored("to_crack", dim), Stored("nearest_normal", dim)]
        found += [Stored("crack_strain_nonlocal", 1), Stored("crack_strain_max_nonlocal", 1)]
        found += [Stored("slip_nonlocal", 1), Stored("slip_max_nonlocal", 1)]
    found += [Stored("id", 1, True), *[Stored("rock", 1, True)] * (len(rocks) > 1)]
    found += [Stored("mode", 1, True)] * scene.breaks
    return (*found, *(entry for entry in of_law if entry.whole))


@ti.data_oriented
class Particles:
    """Particle fields, one array per component (SoA), in cell order. `id` is the seeding order.

    Position is reference + displacement: adding 1e-9 m to 0.1 m does nothing in float32. What any rock of the scene
    needs is there for all particles; `rock`, the index in `Scene.rocks`, only where there are several.
    """

    def __init__(self, scene: Scene, count: int, real):
        dim, self.count = scene.dim, count

        def vector(n):
            return ti.Vector.field(n, real, count, layout=ti.Layout.SOA)

        self.reference, self.u, self.v = vector(dim), vector(dim), vector(dim)
        self.sigma = vector(PACKED_LENGTH[dim])
        self.L = ti.Matrix.field(dim, dim, real, count, layout=ti.Layout.SOA)  # within a step only: grad v [1/s]
        self.J, self.volume = ti.field(real, count), ti.field(real, count)  # volume: stress-free [m^dim]
        self.id = ti.field(ti.i32, count)
        self.affine, self.viscous = scene.transfer.affine, any(rock.viscosity.acts for rock in scene.rocks)
        self.breaking = ti.field(ti.i32, ())  # 0 while bodies settle and may not fail yet
        if scene.loading.settle:
            self.breaking[None] = 1
        self.breaks, self.varied = scene.breaks, any(rock.heterogeneity.varies for rock in scene.rocks)
        real_fields = [self.reference, self.u, self.v, self.sigma, self.J, self.volume]
        whole_fields = [self.id]
        if len(scene.rocks) > 1:
            self.rock = ti.field(ti.i32, count)
            whole_fields.append(self.rock)
        if self.affine:
            self.C = ti.Matrix.field(dim, dim, real, count, layout=ti.Layout.SOA)
            real_fields.append(self.C)
        if self.viscous:
            self.q = ti.field(real, count)
            real_fields.append(self.q)
        if self.varied:
            self.strength = ti.field(real, count)  # factor on cohesion and tensile strength
            real_fields.append(self.strength)
        if self.breaks:
            self.mode = ti.field(ti.i32, count)
            whole_fields.append(self.mode)
        self.history = LawHistory(variables_of(scene), dim, count, real)
        real_fields += self.history.real_fields
        whole_fields += self.history.whole_fields
        if any(averaging(scene)):
            # overload is of one step only; from here to the nearest particle in which the mean stress began a crack,
            # and its normal, both as they were then, or 0 where none is near
            self.overload, self.to_crack, self.nearest_normal = ti.field(real, count), vector(dim), vector(dim)
            # crack strain of the rock around, by which tensile strength is lost: as last averaged, and the largest
            self.crack_strain_nonlocal, self.crack_strain_max_nonlocal = ti.field(real, count), ti.field(real, count)
            # the same of slip, by which cohesion is lost
            self.slip_nonlocal, self.slip_max_nonlocal = ti.field(real, count), ti.field(real, count)
            real_fields += [self.to_crack, self.nearest_normal]
            real_fields += [self.crack_strain_nonlocal, self.crack_strain_max_nonlocal]
            real_fields += [self.slip_nonlocal, self.slip_max_nonlocal]
        # what is 0 in a particle at rest without stress, and what a particle that can break has besides
        resting = [self.v, self.sigma, *([self.C] if self.affine else []), *([self.q] if self.viscous else [])]
        self.resting_components = (*(c for field in resting for c in components(field)), *self.history.components)
        self.modes = (self.mode,) if self.breaks else ()
        self.real_components = tuple(c for field in real_fields for c in components(field))
        self.whole_components = tuple(c for field in whole_fields for c in components(field))
        # cell key at the last sort and now, and room for sorting
        self.key, self.base, self.order = (ti.field(ti.i32, count) for _ in range(3))
        self.scratch = ti.field(real, count)
