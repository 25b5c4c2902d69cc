"""Mass scaling by a tolerance: what inertia adds to the load at first failure, and the largest time scale within it.

A time scale k multiplies the density by k^2, so waves run k times slower and their impedance is k rho c. Platens that
close with a strain rate e' load the rock by rho c^2 e' per second, and whatever takes a wave the time l k/c to reach
errs by k rho c e' l (the stress jump rho c v of a wave: Kolsky 1963, Stress Waves in Solids). So, over the
stress s at first failure, with rate e', height H, closing speed e' H and the start's factor on it:

- Affine start: the velocities are those of uniform strain, which is exact but for a flaw. Its faces learn of the load
  from its tips, so l is its length 2a: k rho c e' 2a/s. That bounds what was measured; see the README.
- Ramp of time T, or AtRest (T = 0): the first mode of the column between the platens, w = pi c/(k H), is left ringing
  by k rho c e' H F/s, F = 3 |sin(x) - x cos(x)|/x^3 <= 3 sqrt(1 + x^2)/x^3, x = w T/2, being the spectrum of the
  smooth step's acceleration, at most 1; and while the platens still accelerate, the stress in the middle is behind that
  on them by k^2 rho (de'/dt) H^2/8.
- In every case a step is a wave's way through part of a cell, and loads are found to within a step: l grows by dx.
- The load is read as a median over a quarter of a transit (`analysis/load_curve.py`), which takes half of that from a
  peak that breaks off at once: e' k H/(8 c) over the strain at failure.
- The motion itself: kinetic over elastic energy, k^2 rho <v^2>/(s e), with the mean square of the affine velocities.

The estimate is the largest of these three: the last two, and the sum of the others.

First failure is expected at s by the uniform stress of a box, or that in the middle of a disc, -3 along the load and 1
across it in units of P/(pi R) (Hondros 1959), and at the tip of a flaw by the mean of the hoop stress of a sharp crack
over a distance d (Novozhilov 1969, J. Appl. Math. Mech. 33:201; Seweryn 1994, Eng. Fract. Mech. 47:673), sqrt(2a/d)
cos(t/2) (s_n cos^2(t/2) - 3/2 tau sin(t)) at its worst angle t, plus the stress along the flaw that its blunt end
turns into tension, as at an elliptic hole (Inglis 1913). d is the length of the mean, or a cell, which the grid
averages over. Platen strain of a disc: Hertz between plates (Johnson 1985, Contact Mechanics, sec. 5.6).

When it fails: it knows one flaw at a time, straight and alone, and no failure beside the platens; after the first
failure a collapse is as violent as the mass that was added, but for a servo (`quasi_static/servo.py`).
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti.errors import SceneError
from rsmpm_ti.spec.loading_start import Affine, AtRest, Press, Ramp
from rsmpm_ti.spec.regions import Box, Difference, Disc, Slit, cuts_of, slits_of

MAX_TIME_SCALE = 1000.0
"""Largest time scale; the smallest is 1, the true density."""

READING_TRANSITS = 0.125
"""Transits of loading that a peak is read too low by at most."""

MIN_TRANSITS = 5.0
"""Wave transits of the specimen that a ramp must last."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """What is expected of a test between two platens at its true density. SI, sizes without sign."""

    density: float
    wave_speed: float
    strain_rate: float
    height: float
    path: float  # of a wave until stress is what uniform strain says [m]: a cell, and the longest flaw
    speed_squared: float  # mean of |v|^2 over the specimen at full speed of the platens
    stress: float  # nominal, at first failure or, if that comes before, at the end: P/(pi R) in a disc
    strain: float  # of the platens then
    start: Affine | Ramp | AtRest

    @property
    def _fraction(self) -> float:
        """Fraction of a ramp that is over at that strain: e'T (s^3 - s^4/2) is the strain of a smooth step."""
        assert isinstance(self.start, Ramp)
        reached = self.strain / (self.strain_rate * self.start.time)
        return 1.0 if reached >= 0.5 else _root(lambda s: s**3 - 0.5 * s**4 - reached, 0.0, 1.0)

    def error(self, time_scale: float) -> float:
        """Estimated fraction of the load at first failure that is inertia's; grows with time_scale."""
        k, factor = time_scale, 1.0
        impedance = k * self.density * self.wave_speed * self.strain_rate
        added = impedance * self.path
        read = self.strain_rate * READING_TRANSITS * k * self.height / self.wave_speed / self.strain
        if isinstance(self.start, Ramp):
            x, s = 0.5 * math.pi * self.wave_speed * self.start.time / (k * self.height), self._fraction
            factor = self.start.factor(s * self.start.time)
            added += impedance * self.height * min(1.0, 3.0 * math.sqrt(1.0 + x * x) / x**3)
            jolt = self.strain_rate * 6.0 * s * (1.0 - s) / self.start.time
            added += k * k * self.density * jolt * self.height**2 / 8.0
        elif isinstance(self.start, AtRest):
            added += impedance * self.height
        kinetic = k * k * self.density * factor**2 * self.speed_squared / (self.stress * self.strain)
        return max(added / self.stress, read, kinetic)

    def largest(self, tolerance: float) -> float:
        """The largest time scale with an error of at most `tolerance`, in [1, MAX_TIME_SCALE]; 1 if that errs more."""
        most = MAX_TIME_SCALE
        if isinstance(self.start, Ramp):
            most = min(most, self.start.time * self.wave_speed / (MIN_TRANSITS * self.height))
        if most <= 1.0 or self.error(1.0) >= tolerance:
            return 1.0
        if self.error(most) <= tolerance:
            return most
        return _root(lambda k: self.error(k) - tolerance, 1.0, most)


def _root(function, low: float, high: float) -> float:
    from scipy.optimize import brentq  # a third of a second, which a run with a time_scale of its own need not wait for

    return brentq(function, low, high)


def estimate(scene) -> Estimate:
    """Of a `Scene`. Raises SceneError for one that is no test of one box or disc between platens that move."""
    loading, body, whole = scene.loading, scene.bodies[0], _specimen(scene)
    rate, axis = abs(loading.strain_rate), loading.platens[0].axis
    sign = math.copysign(1.0, -loading.strain_rate)  # of the load, tension positive
    modulus, along, across = scene.rock.elasticity.uniaxial_modulus(scene.dim), sign, 0.0
    if isinstance(whole, Disc):
        along, across = 3.0 * sign, -sign
        contact = math.sqrt(2.0 * whole.radius * scene.domain.dx)  # half of the arc within a cell of a platen
        spans = [platen.span for platen in loading.platens if platen.span is not None]
        contact = min([contact, *(0.5 * (span[1] - span[0]) for span in spans)])
        modulus /= 2.0 * math.log(4.0 * whole.radius / contact) - 1.0
    flaws = [slit.length for slit in slits_of(body.region)] if isinstance(loading.start, Affine) else []
    end = abs(scene.schedule.strain_end or rate * scene.schedule.t_end)
    stress = min(_failure_stress(scene, whole, axis, along, across), modulus * end)
    low, high = (platen.speed for platen in loading.platens)
    sides = [edge for d, edge in enumerate(np.subtract(*whole.bounds()[::-1])) if d != axis]
    lateral = (scene.rock.elasticity.lateral_ratio(scene.dim) * rate) ** 2 * sum(edge**2 for edge in sides) / 12.0
    return Estimate(
        density=scene.rock.density, wave_speed=scene.rock.wave_speed(), strain_rate=rate, height=loading.height,
        path=max(flaws, default=0.0) + scene.domain.dx,
        speed_squared=(low**2 + low * high + high**2) / 3.0 + lateral, stress=stress, strain=stress / modulus,
        start=loading.start,
    )  # fmt: skip


def _specimen(scene) -> Box | Disc:
    """The box or disc, flaws filled, that reaches from platen to platen; SceneError where there is none."""
    loading = scene.loading
    problem = ""
    if loading.platens is None or not loading.height > 0.0 or loading.strain_rate == 0.0:
        problem = "it needs two platens that face each other and move at a strain rate"
    elif isinstance(loading.start, Press):
        problem = "start = Press stops the platens, so that there is no strain rate"
    elif loading.force_field is not None:
        problem = "loading.force_field drives the scene too"
    elif loading.initial_stress is not None:
        problem = "loading.initial_stress loads the rock before the platens do"
    elif len(scene.bodies) != 1 or scene.bodies[0].velocity is not None or scene.bodies[0].spin != 0.0:
        problem = "it knows one body that the platens alone set in motion"
    else:
        region = scene.bodies[0].region
        whole = region.whole if isinstance(region, Difference) else region
        fits = isinstance(whole, Box) or (isinstance(whole, Disc) and scene.dim == 2)
        if not fits or len(slits_of(region)) != len(cuts_of(region)):
            problem = "it knows a box (in 2D a disc too) in which there may be slits"
        else:
            axis = loading.platens[0].axis
            ends, planes = (b[axis] for b in whole.bounds()), (platen.position for platen in loading.platens)
            if any(abs(a - b) > scene.domain.dx for a, b in zip(ends, planes, strict=True)):
                problem = "the body must reach from platen to platen"
    if problem:
        number = f"give a number in [1, {MAX_TIME_SCALE:g}], 1 where waves matter"
        raise SceneError(f"loading.time_scale = 'auto' is refused: {problem}; {number}")
    assert isinstance(whole, Box | Disc)
    return whole


def _failure_stress(scene, whole: Box | Disc, axis: int, along: float, across: float) -> float:
    """Nominal stress at first failure, without sign [Pa]; infinite for rock that does not break.

    along, across: stress on the load's axis and across it per nominal stress, tension positive. A confining pressure
    holds tension back everywhere, slits included; Weibull strength is that of the weakest link of the whole specimen.
    """
    rock, pressure = scene.rock, scene.loading.confinement
    if not rock.criterion.breaks:
        return math.inf
    weakest = 1.0
    if rock.heterogeneity.varies:
        area = math.prod(np.subtract(*whole.bounds()[::-1]))
        weakest = min(1.0, (rock.heterogeneity.reference_volume / area) ** (1.0 / rock.heterogeneity.shape))
    distance = max(scene.domain.dx, rock.nonlocal_mean.length if rock.nonlocal_mean.acts else 0.0)
    slits = slits_of(scene.bodies[0].region)
    pulls = [along, across, *(tip_tension(slit, axis, along, across, distance) for slit in slits)]
    pull, press = max(pulls), -min(along, across)
    stresses = [(weakest * rock.criterion.tensile_strength + pressure) / pull] if pull > 0.0 else []
    if press > 0.0:
        friction = rock.criterion.strength(pressure) - rock.criterion.ucs  # no part of what varies
        stresses.append((weakest * rock.criterion.ucs + friction - pressure) / press)
    return min(stresses)


def tip_tension(slit: Slit, axis: int, along: float, across: float, distance: float) -> float:
    """Largest tension at a flaw, as a mean over `distance` [m] from its tip, in a uniform field [its unit].

    along, across: principal stresses of the field on the load's axis and across it.
    """
    tangent = slit.direction[axis] ** 2 if axis < 2 else 0.0
    normal = 1.0 - tangent if axis < 2 else 0.0  # squares of the cosines to the load's axis
    across_flaw = along * normal + across * (1.0 - normal)
    along_flaw = along * tangent + across * (1.0 - tangent)
    shear = abs(along - across) * math.sqrt(normal * tangent)
    angle = np.linspace(-np.pi, np.pi, 721)
    hoop = np.cos(angle / 2.0) * (across_flaw * np.cos(angle / 2.0) ** 2 - 1.5 * shear * np.sin(angle))
    tip = math.sqrt(slit.length / distance) * float(hoop.max()) + max(0.0, -along_flaw)
    return max(tip, -across_flaw)  # on the middle of the flaw's face: the crown of a hole pressed from above
