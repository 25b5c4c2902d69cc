"""The stress that rock in the ground starts with: the weight of what lies above it, and K0 times that sideways.

    sigma along the axis = -p,  p = overburden + rho b (x - surface),        sigma in all other directions = -K0 p

with b the body force along the axis and x a particle's coordinate: under gravity, depth below the surface. The stress
balances the body force, d sigma/dx + rho b = 0, so that a body stays at rest where walls hold its sides and the
overburden, or nothing, presses on its top. Free sides start to move: they were not free in the ground.

J counts from the stress-free state, as in `confinement.py`: K (1 - J) = (1 + 2 K0) p/3. So failed rock keeps the
pressure that it had. The weight is that of the scene's density as it lies in the ground, true to the last bit in sum;
in a single particle it errs by its 1 - J less their mean, 1e-4 for 100 m of rock.

Brady & Brown (2004), Rock Mechanics for Underground Mining, sec. 5.2. Elastic rock that was never strained sideways has
K0 = nu/(1 - nu).
"""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from annotated_types import Interval

from rsmpm_ti.checks import Coordinate, NotNegative, Remedy, checked
from rsmpm_ti.errors import refuse
from rsmpm_ti.spec.boundaries import Axis
from rsmpm_ti.spec.confinement import MAX_FRACTION
from rsmpm_ti.units import Pressure

MAX_RATIO = 100.0
"""Largest K0: 1500/z + 0.5 bounds what was measured at a depth of z metres (Brown & Hoek 1978); this is at 15 m."""


@checked("initial_stress")
@dataclass(frozen=True, kw_only=True)
class InSitu:
    """Stress of the ground: along `axis` the weight of the rock up to `surface` [m], at which `overburden` [Pa]
    presses; K0 times as much in the other directions, out of the plane too.

    `surface` may be left out where no body force acts along the axis. When it fails: it knows one layer, and principal
    stresses along the axes. Good values: K0 = nu/(1 - nu) where nothing but weight acted; 0.5 to 3 was measured below
    300 m.
    """

    axis: Axis
    surface: Coordinate | None = None
    overburden: Annotated[Pressure, NotNegative, Remedy("it is compression positive")] = 0.0
    K0: Annotated[float, Interval(ge=0.0, le=MAX_RATIO), Remedy("it is sigma across over sigma along the axis")]

    def pressure(self, x: np.ndarray, weight: float) -> np.ndarray:
        """p [Pa] at coordinates along the axis [m]; weight: rho b along it [N/m^3]."""
        if self.surface is None:
            return np.full(np.shape(x), self.overburden)
        return self.overburden + weight * (np.asarray(x) - self.surface)

    def mean(self, p):
        """Mean pressure where the one along the axis is p [Pa]."""
        return (1.0 + 2.0 * self.K0) / 3.0 * p

    def normal_stresses(self, p: np.ndarray) -> np.ndarray:
        """sigma_xx, sigma_yy, sigma_zz [Pa], [n, 3]."""
        ratios = np.full(3, self.K0)
        ratios[self.axis] = 1.0
        return -p[:, None] * ratios


def weight_along(scene, axis: int) -> float:
    """rho b of a scene along an axis [N/m^3]; mass scaling leaves it unchanged."""
    force = scene.loading.body_force
    return 0.0 if force is None else scene.rock.density * force[axis]


def start_stress(scene, x: np.ndarray, bulk: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """sigma_xx, sigma_yy, sigma_zz [Pa], [n, 3], and J, [n], of particles at x [m], [n, dim]; bulk: modulus of the
    rock of each [Pa], [n]."""
    stress = scene.loading.initial_stress
    p = stress.pressure(x[:, stress.axis], weight_along(scene, stress.axis))
    return stress.normal_stresses(p), 1.0 - stress.mean(p) / bulk


def check_initial_stress(scene) -> None:
    """Raises SceneError for a stress that no rock of the scene can start with."""
    stress, loading = scene.loading.initial_stress, scene.loading
    if stress is None:
        return
    if stress.axis >= scene.dim:
        raise refuse("initial_stress.axis", stress.axis, f"below the dimension {scene.dim}")
    if loading.confinement > 0.0:
        remedy = "an equal pressure from all sides is overburden with K0 = 1"
        raise refuse("loading.confinement", loading.confinement, "0 where there is an initial_stress", remedy)
    if scene.rock.elasticity.plane_stress:  # then all rocks are
        remedy = "the ground presses on the faces of a plate too; use plane strain"
        raise refuse("loading.initial_stress", stress, "none in plane stress", remedy)
    weight = weight_along(scene, stress.axis)
    if weight != 0.0 and stress.surface is None:
        raise refuse("initial_stress.surface", None, "a coordinate [m] where a body force acts along the axis")
    bounds = [np.array(body.region.bounds())[:, stress.axis] for body in scene.bodies]
    ends = stress.pressure(np.array(bounds), weight)
    if ends.min() < -1e-9 * max(1.0, np.abs(ends).max()):
        allowed = f"such that the ground presses everywhere; at an end of a body it is {ends.min():.4g} Pa"
        raise refuse("initial_stress.surface", stress.surface, allowed, "put the surface above the bodies")
    most = MAX_FRACTION * min(rock.elasticity.bulk for rock in scene.rocks)
    if stress.mean(ends.max()) > most:
        allowed = f"such that the mean pressure, {stress.mean(ends.max()):.4g} Pa, is at most {most:.4g} Pa, "
        raise refuse("loading.initial_stress", stress, f"{allowed}{MAX_FRACTION:g} of the bulk modulus")
    for k, body in enumerate(scene.bodies):
        _check_strength(scene.rock_of(body).criterion, stress, ends[k])


def _check_strength(criterion, stress: InSitu, ends: np.ndarray) -> None:
    """Rock that is there has not failed. Criteria of a scene's own may not say their strength. ends: pressure at both
    ends of a body [Pa]."""
    strength = getattr(criterion, "strength", None)
    if not criterion.breaks or strength is None:
        return
    for p in (float(ends.min()), float(ends.max())):
        least, largest = sorted((max(p, 0.0), stress.K0 * max(p, 0.0)))
        if largest >= strength(least):
            allowed = f"such that rock bears it: held by {least:.4g} Pa it fails at {strength(least):.4g} Pa"
            raise refuse("initial_stress.K0", stress.K0, f"{allowed}, and {largest:.4g} Pa press")
