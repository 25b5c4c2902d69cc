"""Several scabs: a pulse that rises at once and falls slowly comes to a free face and tears off slice after slice.

Hopkinson's experiment by acoustic theory (Kolsky 1963, Stress Waves in Solids, ch. VIII; Meyers 1994, Dynamic Behavior
of Materials, ch. 17). Of a pulse of peak P that falls to zero over the length l the reflected front pulls at the depth
x by P - P (1 - 2 x/l): sigma_t is reached at x = l sigma_t/(2 P). The slice flies off with the momentum that is caught
in it, at (2 P - sigma_t)/(rho c). What is left of the pulse has the peak P - sigma_t and meets a new free face, so that
there are P/sigma_t scabs, rounded down, of equal thickness, each slower by 2 sigma_t/(rho c). Cracks cost no energy
in this theory, as by the paper's law. Predicted from sigma_t, E, nu and rho of the rock of the scenes.
"""

import math
from dataclasses import dataclass

import numpy as np

from rsmpm_ti import simulate
from rsmpm_ti.cases.case import Outcome
from rsmpm_ti.results.result import Result
from rsmpm_ti.spec.boundaries import Platen, Wall
from rsmpm_ti.spec.domain import Domain
from rsmpm_ti.spec.loading_start import Program
from rsmpm_ti.spec.regions import Box
from rsmpm_ti.spec.scene import Body, Loading, Scene, Schedule
from rsmpm_ti.units import MPa, mm
from rsmpm_ti.validate.comparison import compare
from rsmpm_ti.validate.dynamics.spall import IMPEDANCE, LAB, PAPER, SPEED_OF_SOUND, STRENGTH
from rsmpm_ti.validate.experiment import Experiment, Input

PLATE, PULSE = 120.0 * mm, 70.0 * mm
"""Length of the strip and of the pulse l."""

PEAK = 3.5 * STRENGTH
"""Three scabs, and half a sigma_t that is left."""

RISE = 1e-6
"""Of the pulse [s], ten cells at the full tier: one that rises at once rings by a quarter of the peak."""

DX, QUICK_DX = 0.25 * mm, 0.5 * mm
APART = 2.0 * mm
"""Failures farther apart belong to two scabs: a fifth of what a scab is to be."""

SCAB = 0.5 * PULSE * STRENGTH / PEAK
SCABS = math.floor(PEAK / STRENGTH)
VELOCITIES = [(2.0 * PEAK - (2 * k + 1) * STRENGTH) / IMPEDANCE for k in range(SCABS)]
"""Of the scabs, the first first [m/s]."""

SOURCE = "acoustic theory: Kolsky 1963, Stress Waves in Solids, ch. VIII; Meyers 1994, ch. 17"


def pulse(dx: float) -> Scene:
    """A strip two cells wide between walls; a platen presses at its lower end by the pulse and is then at rest."""
    width, room, fall = 2.0 * dx, 5.0 * mm, PULSE / SPEED_OF_SOUND
    walls = (Wall(axis=0, side="lower", position=0.0), Wall(axis=0, side="upper", position=width))
    return Scene(
        title="A pulse comes to a free face",
        domain=Domain(lower=(0.0, -room), upper=(width, PLATE + room), dx=dx),
        bodies=(Body(region=Box(lower=(0.0, 0.0), upper=(width, PLATE))),),
        rock=PAPER,
        loading=Loading(
            boundaries=(*walls, Platen(axis=1, side="lower", position=0.0, stress=PEAK)),
            start=Program(times=(RISE, RISE + fall), factors=(1.0, 0.0)),
            width=width,
        ),
        schedule=Schedule(t_end=(PLATE + 1.2 * PULSE) / SPEED_OF_SOUND, cfl=0.25),
    )


@dataclass(frozen=True)
class Sliced:
    """A run: where it parted and how fast each slice goes, the nearest to the face first."""

    result: Result

    @property
    def depth(self) -> np.ndarray:
        """Of particles below the free face, as they were at the start [m]."""
        snapshot = self.result.snapshot
        return PLATE - (snapshot.x[:, 1] - snapshot.displacement[:, 1])

    @property
    def planes(self) -> list[np.ndarray]:
        """Depths of failures [m], an array for each plane at which it parted."""
        ordered = np.sort(PLATE - self.result.events.x[:, 1])
        return np.split(ordered, np.flatnonzero(np.diff(ordered) > APART) + 1) if len(ordered) else []

    def slices(self) -> list[tuple[float, float]]:
        """Thickness [m] and mean velocity [m/s] of each: rock between two planes."""
        faces, velocity, depth = self.planes, self.result.snapshot.velocity[:, 1], self.depth
        tops, found = [0.0, *(float(plane[-1]) for plane in faces)], []
        for top, above, plane in zip(tops, [0.0, *(float(p.mean()) for p in faces)], faces, strict=False):
            within = (depth > top) & (depth < plane[0])
            found.append((float(plane.mean()) - above, float(velocity[within].mean()) if within.any() else math.nan))
        return found


def scabs(full: bool) -> Outcome:
    result = simulate(pulse(DX if full else QUICK_DX), threads=1)
    sliced = Sliced(result)
    slices = sliced.slices()
    rows = [compare("scabs", "1", SCABS, len(slices), 0.0, SOURCE)]
    for k in range(SCABS):
        thickness, velocity = slices[k] if k < len(slices) else (math.nan, math.nan)
        rows += [
            compare(f"thickness of scab {k + 1}", "mm", SCAB / mm, thickness / mm, 0.1, SOURCE),
            compare(f"velocity of scab {k + 1}", "m/s", VELOCITIES[k], velocity, 0.1, SOURCE),
        ]

    def draw(figure):
        axes, order = figure.subplots(), np.argsort(sliced.depth)
        axes.plot(sliced.depth[order] / mm, result.snapshot.velocity[order, 1], lw=0.8, label="run, at its end")
        below = np.repeat(np.arange(SCABS + 1) * SCAB / mm, 2)[1:-1]
        axes.plot(below, np.repeat(VELOCITIES, 2), "k--", lw=0.9, label="acoustic theory")
        for plane in sliced.planes:
            axes.axvspan(plane[0] / mm, plane[-1] / mm, color="tab:red", alpha=0.3, lw=0)
        title = f"A pulse of {PEAK / MPa:g} MPa on rock of {STRENGTH / MPa:g} MPa; red: failed"
        axes.set(xlabel="depth below the free face [mm]", ylabel="velocity [m/s]", title=title)
        axes.set_xlim(0.0, 6.0 * SCAB / mm)
        axes.legend()

    return Outcome(tuple(rows), draw)


CASES = (
    Experiment(
        "scabs", "a triangular pulse at a free face: how many scabs, how thick and how fast, by acoustic theory", scabs,
        inputs=(
            Input("sigma_t", STRENGTH, "Pa", "the rock of the scenes"),
            Input("E", LAB.elasticity.E, "Pa", "the rock of the scenes"),
            Input("nu", LAB.elasticity.nu, "1", "the rock of the scenes"),
            Input("density", LAB.density, "kg/m^3", "the rock of the scenes"),
        ),
    ),
)  # fmt: skip
