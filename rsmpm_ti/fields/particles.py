"""Fields of the particles: those that a scene's physics needs, and no more."""

import taichi as ti

from rsmpm_ti.fields.nodes import components
from rsmpm_ti.rock.tensors import PACKED_LENGTH
from rsmpm_ti.spec.scene import Scene


@ti.data_oriented
class Particles:
    """Particle fields, one array per component (SoA), in cell order. `id` is the seeding order.

    Position is reference + displacement: adding 1e-9 m to 0.1 m does nothing in float32.
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
        self.affine, self.viscous = scene.transfer.affine, scene.rock.viscosity.acts
        self.breaks, self.varied = scene.rock.criterion.breaks, scene.rock.heterogeneity.varies
        real_fields = [self.reference, self.u, self.v, self.sigma, self.J, self.volume]
        whole_fields = [self.id]
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
        self.cracks = self.breaks and scene.rock.after_failure.directional
        if self.cracks:
            # angle of the crack's normal [rad]; opening strains across it and along it, and their largest; slip strain
            self.crack_angle, self.slip = ti.field(real, count), ti.field(real, count)
            self.opening, self.widest = vector(2), vector(2)
            # energy lost so far [J]; `failed`: the mode by which the particle itself opened or slipped by what costs
            # half of the strength, while `mode` starts with the loss
            self.lost, self.failed = ti.field(real, count), ti.field(ti.i32, count)
            real_fields += [self.crack_angle, self.slip, self.opening, self.widest, self.lost]
            whole_fields.append(self.failed)
        if self.breaks and scene.rock.averaging.acts:
            # overload is of one step only; shade_angle: normal of the crack beside [rad]
            self.overload, self.shade_angle = ti.field(real, count), ti.field(real, count)
            # crack strain of the rock around, by which tensile strength is lost: as last averaged, and the largest
            self.mean_opening, self.worn = ti.field(real, count), ti.field(real, count)
            real_fields += [self.shade_angle, self.mean_opening, self.worn]
        self.real_components = tuple(c for field in real_fields for c in components(field))
        self.whole_components = tuple(whole_fields)
        # cell key at the last sort and now, and room for sorting
        self.key, self.base, self.order = (ti.field(ti.i32, count) for _ in range(3))
        self.scratch = ti.field(real, count)
