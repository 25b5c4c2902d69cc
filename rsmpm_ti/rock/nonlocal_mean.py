"""Which stress decides on tensile failure, and which opening on loss of strength: a particle's own, or the rock's."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np
import taichi as ti
from annotated_types import Interval

from rsmpm_ti.checks import Positive, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.rock.tensors import extreme_principals, in_frame
from rsmpm_ti.units import Length

MIN_CELLS = 2.0
"""Shortest length of the mean [cells]: over one it is hardly a mean, and paths scatter by eight (docs/studies.md)."""

MAX_CELLS = 64
"""Longest length of the mean [cells]; every node then sums 450 others along each axis."""

AHEAD = math.tan(math.radians(15.0))
"""Distance along a crack over that across it from which on rock is ahead of it and not beside: cracks turn by 70.5
degrees at most (Erdogan & Sih 1963), and what pulls along the faces of a sheared one is not what makes it longer."""

OVERSHOOT = 1.5
"""Most that rock near a crack bears of its own tension, over its strength. About a tip sigma_1 is at most 1.30 times
the tension that makes the crack grow (Williams 1957, J. Appl. Mech. 24:109: at 60 degrees off its line): what bears
more is not of the tip's field, and no other rule would let it crack."""


@ti.data_oriented
@checked("nonlocal_mean")
@dataclass(frozen=True, kw_only=True)
class Local:
    """Each particle's own stress and crack strain decide: what fails first then depends on cell size and edges."""

    acts = False

    @ti.func
    def own_part(self, sim: ti.template(), p, normal):
        """Part of a particle's own tension, with the larger in-plane stress along `normal`, that counts in its check
        of every step: 1 where its own stress decides."""
        return 1.0

    @ti.func
    def own_tension(self, sim: ti.template(), sigma_1):
        """What of a particle's own largest stress counts in its check for shear."""
        return sigma_1

    @ti.func
    def begin_crack(self, sim: ti.template(), p, strain):
        """A crack begins in the particle, marked by a crack strain."""

    @ti.func
    def begin_slip(self, sim: ti.template(), p, strain):
        """Slip begins in the particle, marked by a strain."""

    @ti.func
    def follow(self, sim: ti.template(), p):
        """Before the response of a cracked particle in a step."""

    @ti.func
    def softening_strain(self, sim: ti.template(), p):
        """Crack strain by which a particle's crack has lost tensile strength."""
        return sim.particles.history.crack_strain_max[p][0]

    @ti.func
    def softening_slip(self, sim: ti.template(), p):
        """Slip by which a particle has lost cohesion."""
        return sim.particles.history.slip[p]


@ti.data_oriented
@checked("nonlocal_mean")
@dataclass(frozen=True, kw_only=True)
class Nonlocal:
    """The mean stress over a length of the rock decides on tension; its most overloaded particle fails first.

    The mean is weighted by a Gaussian of standard deviation `length` [m], a property of the rock like its grain, over
    the rock that is there: free faces and flaws weigh nothing. Bazant & Jirasek (2002), J. Eng. Mech. 128:1119, eq. 1.

    A crack grows as a line, not as the blob in which the smooth stress is high. Nearer to one than `exclusion` lengths
    the tension across the line to it decides, not sigma_1, which about a tip is largest 60 degrees off its line: the
    hoop stress of Erdogan & Sih (1963), J. Basic Eng. 85:519. What lies beside a crack is relieved of it: an exclusion
    radius, as of Cervera & Chiumenti (2006), Comput. Methods Appl. Mech. Eng. 196:304, sec. 4. At a tip, no farther
    than a crack band is wide, a particle's own tension across that line says when, since the mean, part of it over
    what the crack has relieved, is late; the mean says which. What lies in the band of a crack cracks by its own
    stress, since a band opens as a whole, and so does what is near a crack once its own tension is OVERSHOOT times its
    strength: a crack that is shut or only begins to open relieves nothing, and rock beside it would bear any tension.

    A cracked particle loses tensile strength by the opening of the crack that it is part of, and cohesion by the slip
    of the band that it is part of, read from the mean crack strain and the mean slip over the same length, not by its
    own fraction of them: then a crack costs G_f per area however many rows of particles it runs through. Bazant & Lin
    (1988), J. Struct. Eng. 114:2493. So `length` must be short against the zone
    in which strength is lost, about E G_f/sigma_t^2; where it is not, a crack's tip is robbed of strength by the crack
    behind it.
    """

    length: Annotated[Length, Positive]
    exclusion: Annotated[float, Interval(ge=0.0, le=100.0)] = 4.0

    acts = True

    @ti.func
    def own_part(self, sim: ti.template(), p, normal):
        """1 beside a crack whose normal is within 45 degrees, in its band, and no farther along it than a cell; 0 where
        no crack is near; 1/OVERSHOOT elsewhere.

        The check of every step asks with the normal of own tension, that of the mean stress with its own normal.
        """
        n, d = sim.particles.nearest_normal[p], sim.particles.to_crack[p]
        across, along, turned = ti.abs(d.dot(n)), ti.abs(d[0] * n[1] - d[1] * n[0]), normal.dot(n)
        beside = along <= ti.min(across, ti.static(sim.grid.dx)) and across <= sim.band
        near = ti.select(d.norm() > 0.0, 1.0 / OVERSHOOT, 0.0)
        return ti.select(beside and 2.0 * turned * turned > 1.0, 1.0, near)

    @ti.func
    def at_tip(self, sim: ti.template(), p):
        """Whether it is so near to a crack, and ahead of it, that its own tension says when it becomes part of it."""
        n, d = sim.particles.nearest_normal[p], sim.particles.to_crack[p]
        ahead = ti.abs(d[0] * n[1] - d[1] * n[0]) > AHEAD * ti.abs(d.dot(n))
        return ahead and d.norm() <= sim.band

    @ti.func
    def tension_across(self, sim: ti.template(), p, sigma):
        """Of a stress at a particle: sigma_1 or, near a crack, the tension across the line to it."""
        tension, d = extreme_principals(sigma)[0], sim.particles.to_crack[p]
        away = d.norm()
        if away > 0.0:
            tension = in_frame(sigma, ti.Vector([-d[1], d[0]]) / away)[0]
        return tension

    @ti.func
    def own_tension(self, sim: ti.template(), sigma_1):
        """Tension beyond the cut-off counts as the cut-off: what it does is for the mean stress to judge.

        It would reach Mohr-Coulomb by itself, and rock on a flaw's face would slip where it ought to open.
        """
        return ti.min(sigma_1, sim.rock.criterion.tensile_strength)

    @ti.func
    def begin_crack(self, sim: ti.template(), p, strain):
        sim.particles.crack_strain_max_nonlocal[p] = strain

    @ti.func
    def begin_slip(self, sim: ti.template(), p, strain):
        sim.particles.slip_max_nonlocal[p] = ti.max(sim.particles.slip_max_nonlocal[p], strain)

    @ti.func
    def follow(self, sim: ti.template(), p):
        particles = sim.particles
        largest = ti.max(particles.crack_strain_max_nonlocal[p], particles.crack_strain_nonlocal[p])
        particles.crack_strain_max_nonlocal[p] = largest
        particles.slip_max_nonlocal[p] = ti.max(particles.slip_max_nonlocal[p], particles.slip_nonlocal[p])

    @ti.func
    def softening_strain(self, sim: ti.template(), p):
        """That of the rock around."""
        return sim.particles.crack_strain_max_nonlocal[p]

    @ti.func
    def softening_slip(self, sim: ti.template(), p):
        """That of the rock around."""
        return sim.particles.slip_max_nonlocal[p]

    @property
    def radius(self) -> float:
        """Distance from a crack up to which the tension across the line to it counts [m]."""
        return self.exclusion * self.length

    def filter_weights(self, dx: float, variance: float) -> tuple[float, ...]:
        """Weights of a row of nodes, symmetric about the middle one, whose variance with that of spreading to nodes
        and reading back, `variance` cells^2 each, is length^2."""
        spare = (self.length / dx) ** 2 - 2.0 * variance  # 3.5 at least: wide enough for a Gaussian to be sampled
        reach = math.ceil(3.5 * math.sqrt(spare))
        weight = np.exp(-0.5 * np.arange(-reach, reach + 1) ** 2 / spare)
        return tuple((weight / weight.sum()).tolist())

    def band_fraction(self, width: float) -> float:
        """What the mean leaves, in its middle, of a strain that is 1 in a band `width` [m] wide and 0 beside it."""
        return math.erf(width / (2.0 * math.sqrt(2.0) * self.length))

    def band_variance(self, width: float) -> float:
        """Variance of such a band after the mean is taken [m^2]."""
        return self.length**2 + width**2 / 12.0

    def check(self, dx: float) -> None:
        """Raise SceneError where cells of size dx [m] are too large or too small for this length."""
        least = MIN_CELLS * dx
        if not self.length >= least * (1.0 - 1e-9):
            allowed = f"at least {least:.4g} m, two cells, or what cracks and where follows the grid"
            remedy = f"use dx of at most {self.length / MIN_CELLS:.4g} m, or a longer length where that is the rock's"
            raise refuse("rock.nonlocal_mean.length", self.length, allowed, remedy)
        if not self.length <= MAX_CELLS * dx:
            remedy = f"use dx of at least {self.length / MAX_CELLS:.4g} m"
            raise refuse("rock.nonlocal_mean.length", self.length, f"at most {MAX_CELLS} cells", remedy)
