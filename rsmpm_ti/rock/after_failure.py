"""What rock that has failed still carries: the questions that kernels ask of a law, and the paper's three laws.

A law owns what it must remember of each particle (`history`) and answers a fixed set of questions. Whoever needs an
answer asks; nobody asks which law it is. A new law is a class with `AfterFailure` as its base, in a file of its own.
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
import taichi as ti

from rsmpm_ti.checks import NotNegative, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.tensors import isotropic
from rsmpm_ti.units import Pressure


@dataclass(frozen=True, kw_only=True)
class Variable:
    """Something that a law remembers of each particle; 0 until the particle fails.

    It is kept in memory, in checkpoints and in VTU files. Kernels reach it as `sim.particles.history.NAME[p]`.
    """

    name: str
    unit: str  # "1" where it has none
    about: str  # in a few words
    per_axis: bool = False  # a vector with a number for each axis of the scene
    whole: bool = False  # a whole number


RESERVED = {"variables", "components", "real_fields", "whole_fields", "has_normal", "to_numpy"}
"""Names that `fields.particles.LawHistory` has for itself."""


def check_law(law) -> None:
    """Raise SceneError for a law whose history cannot be kept."""
    owner, variables = type(law).__name__, law.history
    if not isinstance(variables, tuple) or not all(isinstance(v, Variable) for v in variables):
        raise refuse(f"{owner}.history", variables, "a tuple of Variable(...)", "a tuple of one ends in a comma")
    names = [v.name for v in variables]
    for name in names:
        if not name.isidentifier() or name.startswith("_") or name in RESERVED or names.count(name) > 1:
            remedy = f"{', '.join(sorted(RESERVED))} are taken"
            raise refuse(f"{owner}.history", name, "a name of letters, digits and _ that no other variable has", remedy)
    needed = {v.name for v in variables if v.per_axis}
    if law.oriented and not {"crack_normal", "crack_strain_max"} <= needed:
        allowed = "with crack_normal and crack_strain_max, both per_axis, since the law is oriented"
        raise refuse(f"{owner}.history", tuple(names), allowed)


class AfterFailure:
    """The questions, with the answers of a law that remembers nothing.

    `sim` is a `fields.state.Simulation`, in a scene of several rocks its view of the particle's own rock, and p a
    particle with mode 1 (tension) or 2 (shear); before `begin` it is 0. Energies are per stress-free volume [J/m^3]. A
    particle's Cauchy stress in `sim.particles.sigma[p]` is packed as in tensors.py, tension positive [Pa].
    """

    history = ()  # of `Variable`; without an annotation, since it is no field
    dimensions = (2, 3)  # of scenes that the law is for
    oriented = False  # a crack has a normal: the history holds `crack_normal` and `crack_strain_max`, across it first
    max_events = 1  # of one particle
    softens = False  # strength is lost while the rock cracks, not at once

    def check(self, rock, shape, dx: float) -> None:
        """Raise SceneError for rock that cells of size dx [m] cannot break as this law says."""

    def aperture(self, history: dict[str, np.ndarray], band: float) -> np.ndarray | None:
        """Opening of the crack in each particle [m], [n]; None for a law that does not know it.

        history: the variables by name, [n] or [n, dim]; band: width that a crack opens over [m].
        """
        return None

    @ti.func
    def begin(self, sim: ti.template(), p, mode, normal):
        """A particle fails by `mode`; `normal`: unit vector along its larger in-plane principal stress, 0 in 3D.

        Sets the history. Returns the energy that is lost at once.
        """
        return 0.0

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        """(stress, energy lost) after a step of dt [s] with displacement gradient G; sigma[p] is the elastic trial.

        It may change the mode of a particle from tension to shear.
        """
        return sim.particles.sigma[p], 0.0

    @ti.func
    def stored(self, sim: ti.template(), p):
        """Energy that the particle would give back."""
        return sim.particles.J[p] * sim.rock.elasticity.energy(sim.particles.sigma[p])

    @ti.func
    def carrying_ratio(self, sim: ti.template(), p):
        """Volume that carries the stress over the stress-free volume. It is asked of whole rock too, in every step."""
        return sim.particles.J[p]

    @ti.func
    def damage(self, sim: ti.template(), p):
        """Fraction of strength that is lost, 0 to 1."""
        return 1.0

    @ti.func
    def is_open(self, sim: ti.template(), p):
        """1 where pieces on both sides may part as far as they like, so that a large J warns of nothing; else 0."""
        return 1

    @ti.func
    def failed_mode(self, sim: ti.template(), p):
        """The mode by which the particle counts as failed, 0 for one that has only begun to lose strength.

        When it changes, that is an event.
        """
        return sim.particles.mode[p]

    @ti.func
    def released(self, sim: ti.template(), p, dissipated):
        """Energy that an event reports; dissipated: in the step of the event."""
        return dissipated


class Fluid(AfterFailure):
    """A failed particle keeps no deviatoric stress, and a `pressure(bulk, J)` from its total J (paper sec. 3.2)."""

    @ti.func
    def begin(self, sim: ti.template(), p, mode, normal):
        J, elasticity = sim.particles.J[p], sim.rock.elasticity
        return J * elasticity.energy(sim.particles.sigma[p]) - self.stored(sim, p)

    @ti.func
    def respond(self, sim: ti.template(), p, G, dt):
        bulk = ti.static(sim.rock.elasticity.bulk)
        return isotropic(-self.pressure(bulk, sim.particles.J[p]), sim.particles.sigma.n), 0.0

    @ti.func
    def stored(self, sim: ti.template(), p):
        bulk, J = ti.static(sim.rock.elasticity.bulk), sim.particles.J[p]
        return pressure_energy(self.pressure(bulk, J), bulk, J)

    @ti.func
    def is_open(self, sim: ti.template(), p):
        """What J still makes pull is no gap."""
        carried = self.pressure(ti.static(sim.rock.elasticity.bulk), sim.particles.J[p])
        return ti.select(carried == 0.0, 1, 0)


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class CompressionOnly(Fluid):
    """Choice 1 of the paper, sec. 3.2: a failed particle is a fluid without tension, p = max(K (1 - J), 0)."""

    @ti.func
    def pressure(self, bulk, J):
        return ti.max(bulk * (1.0 - J), 0.0)


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Void(Fluid):
    """Choice 2 of the paper, sec. 3.2: a failed particle carries nothing; only its mass stays."""

    @ti.func
    def pressure(self, bulk, J):
        return 0.0 * J


@ti.data_oriented
@checked("after_failure")
@dataclass(frozen=True, kw_only=True)
class Clipped(Fluid):
    """Choice 3 of the paper, sec. 3.2: p = clip(K (1 - J), -tension_limit, compression_limit), both limits [Pa]."""

    tension_limit: Annotated[Pressure, NotNegative]
    compression_limit: Annotated[Pressure, NotNegative]

    @ti.func
    def pressure(self, bulk, J):
        return ti.min(ti.max(bulk * (1.0 - J), -self.tension_limit), self.compression_limit)


@ti.func
def pressure_energy(p, bulk, J):
    """Energy stored by a pressure p(J) that is K (1 - J) up to a cap and the cap beyond it, per initial volume."""
    return p * (1.0 - J) - 0.5 * p * p / bulk
