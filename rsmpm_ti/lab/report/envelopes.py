"""Strength over pressure, of tests with several: peaks, what is left after them, and the line through the peaks."""

import math

import numpy as np

from rsmpm_ti.lab.compression import residual_of, strength_of
from rsmpm_ti.lab.report.curves import COLOURS, MEGA, Drawing, drawing
from rsmpm_ti.lab.standard import Measured
from rsmpm_ti.records.files import known

FACTS = {"triaxial": "pressure", "shear": "normal"}
"""Test -> the fact of its specimens that is the pressure [Pa]."""


def envelope_drawings(report: dict, measured: list[list[Measured]]) -> list[Drawing]:
    """None of a test at one pressure."""
    test, runs = report["test"], [one for seed in measured for one in seed]
    if test not in FACTS:
        return []
    pressure = np.array([one.specimen.facts[FACTS[test]] for one in runs])
    peak, residual = (np.array([read(one) for one in runs]) for read in (strength_of, residual_of))
    lines = [(name, line) for name in ("value", "given") if (line := line_of(report, name)) is not None]

    def draw(axes) -> None:
        axes.plot(pressure * MEGA, peak * MEGA, "o", color=COLOURS[0], label="peak")
        axes.plot(pressure * MEGA, residual * MEGA, "s", color=COLOURS[1], markerfacecolor="none", label="residual")
        reach = np.array([0.0, 1.05 * pressure.max()])
        for name, (at_zero, slope) in lines:
            look = {"value": ("-", "line through the peaks"), "given": ("--", "by the rock's sheet")}[name]
            axes.plot(
                reach * MEGA,
                (at_zero + slope * reach) * MEGA,
                look[0],
                color="#333333",
                label=look[1],
                linewidth=1.2,
            )
        axes.set_xlabel(ACROSS[test])
        axes.set_ylabel(UP[test])
        axes.set_xlim(left=0.0)
        axes.set_ylim(bottom=0.0)
        axes.legend(fontsize=9)

    return [drawing("Strength and pressure", CAPTIONS[test], draw)]


ACROSS = {
    "triaxial": "\N{GREEK SMALL LETTER SIGMA}\N{SUBSCRIPT THREE} [MPa]",
    "shear": "normal stress \N{GREEK SMALL LETTER SIGMA} [MPa]",
}
UP = {
    "triaxial": "\N{GREEK SMALL LETTER SIGMA}\N{SUBSCRIPT ONE} [MPa]",
    "shear": "shear stress \N{GREEK SMALL LETTER TAU} [MPa]",
}
CAPTIONS = {
    "triaxial": "Axial stress over confining pressure. The line is that of Mohr-Coulomb.",
    "shear": "Shear stress over normal stress. The line is that of Coulomb.",
}


def line_of(report: dict, name: str) -> tuple[float, float] | None:
    """Stress without pressure [Pa] and slope, of the cohesion and friction angle under this name of their entries."""
    found = {one["name"]: known(one[name]) for one in report["quantities"]}
    cohesion, angle = found.get("cohesion"), found.get("friction angle")
    if cohesion is None or angle is None:
        return None
    phi = math.radians(angle)
    if report["test"] == "shear":
        return cohesion, math.tan(phi)
    return 2.0 * cohesion * math.cos(phi) / (1.0 - math.sin(phi)), (1.0 + math.sin(phi)) / (1.0 - math.sin(phi))
