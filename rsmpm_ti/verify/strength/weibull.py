"""Strength falls with size: many strips pulled side by side until each breaks at its weakest particle."""

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import kstest, weibull_min

from rsmpm_ti import load_scene
from rsmpm_ti.cases.case import Case, Outcome, at_most, difference, relative
from rsmpm_ti.cases.static_state import set_up
from rsmpm_ti.method.shape import Linear
from rsmpm_ti.rock.heterogeneity import Weibull
from rsmpm_ti.rock.viscosity import NoViscosity
from rsmpm_ti.solver.readout import read_events, take_snapshot
from rsmpm_ti.spec.boundaries import Platen
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Affine
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.spec.seeding import Lattice

E, NU, TENSILE = 17e9, 0.14, 2e6
STIFFNESS = E / (1.0 - NU**2)
"""Axial modulus of a free-sided strip in plane strain [Pa]."""

MODULUS = 5.0
"""Weibull modulus m."""

DX, HEIGHT, WIDTHS, GAP = 1e-3, 4, (2, 4, 8, 16, 32), 3
"""Cell [m]; cells along and across a strip, two at least, since one particle alone cannot carry the start's Poisson
part; cells between strips, so that no node feels two of them."""

AREAS = DX**2 * HEIGHT * np.array(WIDTHS)
REFERENCE = float(AREAS[2])
"""V_ref [m^2]: a strip in the middle of the sizes."""

STEPS, TOP = 500, 2.2
"""Steps of a run and the stress over sigma_t at its end: above the strongest strip of a few hundred, 1.5 x 4^(1/5)."""

MEAN = math.gamma(1.0 + 1.0 / MODULUS)
SCATTER = math.sqrt(math.gamma(1.0 + 2.0 / MODULUS) / MEAN**2 - 1.0)
"""Mean and standard deviation over mean of Weibull strengths of scale 1."""


@dataclass(frozen=True)
class Strips:
    """What befell the strips, [n]: strength in units of sigma_t (NaN: unbroken), and what was known of it before."""

    size: np.ndarray  # index into WIDTHS
    per_axis: np.ndarray  # particles along an axis of a cell
    strength: np.ndarray
    weakest: np.ndarray  # smallest factor among the strip's particles

    @property
    def scaled(self) -> np.ndarray:
        """Strength over its scale for this area: Weibull of scale 1 for all sizes alike."""
        return self.strength * (AREAS[self.size] / REFERENCE) ** (1.0 / MODULUS)


def _sizes(each: int) -> tuple[np.ndarray, np.ndarray]:
    """Index into WIDTHS and particles along an axis of a cell, of each strip: see `strips`."""
    return np.tile(np.arange(len(WIDTHS)), each), 1 + np.repeat(np.arange(each) % 2, len(WIDTHS))


def strips(each: int) -> Scene:
    """`each` strips of every size, every other one with four particles in a cell, the rest with one, between common
    platens; the affine start stretches them uniformly, their own Poisson part included.
    """
    size, per_axis = _sizes(each)
    width = np.array(WIDTHS)[size]
    left = GAP + np.concatenate([[0], np.cumsum(width + GAP)[:-1]])
    height = HEIGHT * DX
    rock = load_scene("intact").rock
    law = Weibull(shape=MODULUS, reference_volume=REFERENCE)
    rock = replace(rock, viscosity=NoViscosity(), heterogeneity=law)
    strain = TOP * TENSILE / STIFFNESS
    speed = 0.5 * strain * height / (STEPS * 0.5 * DX / rock.wave_speed())
    return Scene(
        title="Strips of many sizes in direct tension",
        domain=Domain(lower=(0.0, 0.0), upper=(float(left[-1] + width[-1] + GAP) * DX, height), dx=DX),
        bodies=tuple(
            Body(region=Box(lower=(a * DX, 0.0), upper=(b * DX, height)), seeding=Lattice(particles_per_axis=int(n)))
            for a, b, n in zip(left, left + width, per_axis, strict=True)
        ),
        rock=rock,
        loading=Loading(
            boundaries=(
                Platen(axis=1, side="lower", position=0.0, speed=-speed, pulls=True),
                Platen(axis=1, side="upper", position=height, speed=speed, pulls=True),
            ),
            start=Affine(),
            width=float(width.sum()) * DX,
        ),
        schedule=Schedule(strain_end=-strain),
        shape=Linear(),
    )


def _pull(each: int) -> Strips:
    """What becomes of `strips` while they are pulled apart."""
    (size, per_axis), scene = _sizes(each), strips(each)
    drive = set_up(scene)
    drive.advance(drive.clock.total)
    starts = np.concatenate([[0], np.cumsum(np.array([len(seeds.x) for seeds in scene.particles()]))[:-1]])
    events = read_events(drive.sim)
    strip, first = np.unique(np.searchsorted(starts, events.id, side="right") - 1, return_index=True)
    strength = np.full(len(size), np.nan)
    # events come in order of time; velocities stay as they start until a strip breaks, so its strain is known
    strength[strip] = STIFFNESS * np.log1p(-scene.loading.strain_rate * events.time[first]) / TENSILE
    factors = take_snapshot(drive.sim, drive.clock.time).strength
    return Strips(size, per_axis, strength, np.minimum.reduceat(factors, starts))


def weibull_size(full: bool) -> Outcome:
    """(A/V_ref)^(-1/m) Gamma(1 + 1/m) sigma_t, and Weibull's scatter about it.  Weibull (1951), J. Appl. Mech. 18:293.

    A strip is uniformly stressed until its weakest particle fails, and its own strength is the first failure.
    """
    each = 400 if full else 32
    pulled = _pull(each)
    means = np.array([pulled.strength[pulled.size == k].mean() for k in range(len(WIDTHS))])
    expected = MEAN * (AREAS / REFERENCE) ** (-1.0 / MODULUS)
    step, error = TOP / STEPS, SCATTER / math.sqrt(each)
    why = f"3 standard errors of a mean of {each} strengths, {error:.3g} each"
    rows = [
        relative(f"mean strength, {1e6 * area:g} mm2 [Pa]", TENSILE * reference, TENSILE * got, 3.0 * error, why)
        for area, reference, got in zip(AREAS, expected, means, strict=True)
    ]
    slope = np.polyfit(np.log(AREAS), np.log(means), 1)[0]
    spread = math.sqrt(np.sum((np.log(AREAS) - np.log(AREAS).mean()) ** 2))
    why = "3 standard errors of the slope through means with that error"
    rows.append(difference("slope of log strength over log area", -1.0 / MODULUS, slope, 3.0 * error / spread, why))
    scaled = pulled.scaled
    fine, coarse = (scaled[pulled.per_axis == n].mean() for n in (2, 1))
    why = "3 standard errors of the ratio of two means: particles of a quarter of the size change nothing"
    tolerance = 3.0 * SCATTER * math.sqrt(4.0 / len(scaled))
    rows.append(relative("4 particles in a cell over 1, mean strength", coarse, fine, tolerance, why))
    why = "critical value of the Kolmogorov-Smirnov statistic at 1 %, 1.63/sqrt(n)"
    distance = kstest(scaled, weibull_min(MODULUS).cdf).statistic
    rows.append(at_most("distance of scaled strengths from Weibull", distance, 1.63 / math.sqrt(len(scaled)), why))
    late = np.abs(pulled.strength - pulled.weakest).max()
    why = "failure is found at the end of a step, and the field is uniform to the second order of a strain of 2.5e-4"
    rows.append(at_most("strip against its weakest particle / sigma_t", late, 1.05 * step, why))

    def draw(figure):
        axes, mpa = figure.subplots(), 1e-6 * TENSILE
        shift = 1.0 + 0.03 * (pulled.per_axis - 1.5)  # the two particle sizes side by side
        for n in (1, 2):
            own = pulled.per_axis == n
            label = f"strips, {n * n} particle{'s' if n > 1 else ''} in a cell"
            position, strength = 1e6 * (AREAS[pulled.size] * shift)[own], mpa * pulled.strength[own]
            axes.plot(position, strength, ".", markersize=3, alpha=0.5, color=f"C{n - 1}", label=label)
        axes.errorbar(1e6 * AREAS, mpa * means, 3.0 * error * mpa * means, fmt="ko", capsize=4, label="mean, 3 errors")
        axes.plot(1e6 * AREAS, mpa * expected, "k--", label="Weibull, mean")
        for fraction in (0.05, 0.95):
            axes.plot(1e6 * AREAS, mpa * expected / MEAN * weibull_min(MODULUS).ppf(fraction), "k:", linewidth=0.8)
        axes.set(xscale="log", yscale="log", xlabel="area [mm2]", ylabel="tensile strength [MPa]")
        axes.minorticks_off()
        for axis, ticks in ((axes.xaxis, 1e6 * AREAS), (axes.yaxis, (0.5, 1.0, 1.5, 2.0, 3.0, 4.0))):
            axis.set_ticks(ticks, [f"{tick:g}" for tick in ticks])
        axes.set_title(f"Size effect, m = {MODULUS:g}: slope {slope:.3f} ({-1.0 / MODULUS:g}); dotted: 5 and 95 %")
        axes.legend(fontsize="small")

    return Outcome(tuple(rows), draw)


CASES = (Case("weibull_size", "strength of strips of many sizes against the weakest link", weibull_size),)
