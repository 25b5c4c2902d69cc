"""The curves of a test, each as SVG text: the same data gives the same bytes, and words stay words."""

import csv
import io
import math
import re
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from rsmpm_ti.lab.standard import Measured
from rsmpm_ti.paint.words import drawable
from rsmpm_ti.records.history_table import nominal_stress

SIZE = (5.4, 3.7)
"""Of a figure [inches]: on a phone its letters of 10 points are about as many pixels."""

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#333333")
"""Okabe & Ito (2008): told apart also by who is blind to some colours."""

NAMED = 7
"""At most so many kinds of specimens are named in a legend."""

MEGA, MILLI, PERCENT = 1e-6, 1e3, 100.0

WAY_TESTS = ("bend", "scb")
"""Read by load and displacement; the others by stress and strain."""


@dataclass(frozen=True, kw_only=True)
class Drawing:
    """One figure of the page: what stands above it, what below, and its SVG."""

    title: str
    caption: str
    svg: str


def drawing(title: str, caption: str, draw: Callable) -> Drawing:
    """draw(axes) fills it."""
    with matplotlib.rc_context({"svg.fonttype": "none", "svg.hashsalt": title, "font.size": 10, "path.simplify": True}):
        figure = Figure(figsize=SIZE, facecolor="white", layout="constrained")
        FigureCanvasSVG(figure)
        axes = figure.subplots()
        draw(axes)
        axes.grid(color="#E8E8E8", linewidth=0.8)
        axes.set_axisbelow(True)
        axes.locator_params(axis="x", nbins=7)
        file = io.StringIO()
        figure.savefig(file, format="svg", metadata=dict.fromkeys(("Creator", "Date", "Format", "Type")))
    return Drawing(title=title, caption=caption, svg=within_page(file.getvalue(), title))


def within_page(text: str, name: str) -> str:
    """An SVG file -> the element as HTML holds it: no header, nothing that reaches beyond it, no size of its own."""
    text = text[text.index("<svg") :]
    text = re.sub(r"<metadata>.*?</metadata>|<style.*?</style>|<!--.*?-->", "", text, flags=re.DOTALL)
    text = re.sub(r'<g id="[^"]*"', "<g", text)  # numbers that every figure counts from 1
    box = re.search(r'viewBox="[^"]*"', text)[0]
    return re.sub(r"<svg[^>]*>", f'<svg {box} role="img" aria-label="{name}">', text, count=1).strip()


def drawings_of(test: str, measured: list[list[Measured]]) -> list[Drawing]:
    """Of every test; what only some have is in `envelopes.py`."""
    runs = [one for seed in measured for one in seed]
    found = [_load(test, runs)]
    if any("gauge_mouth_m" in (one.history.dtype.names or ()) for one in runs):
        found.append(_mouth(runs))
    if test in ("ucs", "triaxial"):
        found.append(_strains(runs[0]))
    return [*found, _energies(test, runs[0]), *_acoustic(test, runs)]


def _load(test: str, runs: list[Measured]) -> Drawing:
    def draw(axes) -> None:
        for one, look in zip(runs, looks(runs), strict=True):
            axes.plot(*_curve(test, one), linewidth=1.4, **look)
        axes.set_xlabel(across_name(test))
        axes.set_ylabel(UP[test])
        _legend(axes, runs)

    return drawing(TITLES.get(test, "Stress and strain"), "Every row of every run, not filtered.", draw)


TITLES = {"bend": "Load and displacement", "scb": "Load and displacement", "shear": "Shear stress and displacement",
          "brazilian": "Nominal stress and closure"}  # fmt: skip

UP = {
    "ucs": "axial stress [MPa]", "triaxial": "axial stress, pressure included [MPa]", "tension": "tension [MPa]",
    "brazilian": "2 P/(\N{GREEK SMALL LETTER PI} D t) [MPa]", "shear": "shear stress [MPa]",
    "bend": "load per thickness [kN/m]", "scb": "load per thickness [kN/m]",
}  # fmt: skip


def across_name(test: str) -> str:
    if test in WAY_TESTS:
        return "displacement of the upper roller [mm]"
    names = {"shear": "shear displacement over length [%]", "brazilian": "closure over diameter [%]"}
    return names.get(test, "axial strain [%]")


def across(test: str, one: Measured) -> np.ndarray:
    """Horizontal axis of curves over the course of a test, [rows], as `across_name` has it."""
    strain = one.history["axial_strain"]
    if test in WAY_TESTS:
        return strain * one.specimen.facts["height"] * MILLI
    return PERCENT * (-strain if test == "tension" else strain)


def _curve(test: str, one: Measured) -> tuple[np.ndarray, np.ndarray]:
    if test in WAY_TESTS:
        return across(test, one), one.history["force_top_N"] / 1e3
    stress = nominal_stress(one.history) * MEGA
    return across(test, one), -stress if test == "tension" else stress


def _mouth(runs: list[Measured]) -> Drawing:
    def draw(axes) -> None:
        for one, look in zip(runs, looks(runs), strict=True):
            axes.plot(one.history["gauge_mouth_m"] * MILLI, one.history["force_top_N"] / 1e3, linewidth=1.4, **look)
        axes.set_xlabel("crack mouth opening [mm]")
        axes.set_ylabel("load per thickness [kN/m]")
        _legend(axes, runs)

    return drawing("Load and crack mouth opening", "The opening is between the edges of the notch.", draw)


def _strains(one: Measured) -> Drawing:
    history = one.history
    stress = nominal_stress(history) * MEGA
    rows = slice(0, int(np.nanargmax(stress)) + 1)

    def draw(axes) -> None:
        names = (("axial_strain", "axial"), ("lateral_strain", "lateral"), ("volumetric_strain", "volumetric"))
        for (column, name), colour in zip(names, COLOURS, strict=False):
            axes.plot(PERCENT * history[column][rows], stress[rows], color=colour, linewidth=1.4, label=name)
        axes.set_xlabel("strain, shortening positive [%]")
        axes.set_ylabel("axial stress [MPa]")
        axes.legend(fontsize=9)

    return drawing("Axial, lateral and volumetric strain", f"Up to the largest load: {one.specimen.about}.", draw)


def _energies(test: str, one: Measured) -> Drawing:
    history = one.history
    names = (("work_J", "work of the load"), ("energy_elastic_J", "stored"), ("energy_dissipated_J", "dissipated"),
             ("energy_kinetic_J", "kinetic"))  # fmt: skip

    def draw(axes) -> None:
        for (column, name), colour in zip(names, ("#333333", *COLOURS), strict=False):
            axes.plot(across(test, one), history[column], color=colour, linewidth=1.4, label=name)
        axes.set_xlabel(across_name(test))
        axes.set_ylabel("energy per thickness [J/m]")
        axes.legend(fontsize=9)

    return drawing("Energies", f"Of one run: {one.specimen.about}.", draw)


def _acoustic(test: str, runs: list[Measured]) -> list[Drawing]:
    """Events so far; none of a test in which no run has any."""
    times = [acoustic_times(one.folder) for one in runs]
    if not any(len(heard) for heard in times):
        return []

    def draw(axes) -> None:
        for one, heard, look in zip(runs, times, looks(runs), strict=True):
            so_far = np.searchsorted(heard, one.history["time_s"], side="right")
            axes.plot(across(test, one), so_far, linewidth=1.4, **look)
        axes.set_xlabel(across_name(test))
        axes.set_ylabel("acoustic events so far")
        _legend(axes, runs)

    return [drawing("Acoustic events", "Failures near each other in space and time are one event.", draw)]


def acoustic_times(folder: Path) -> np.ndarray:
    """Of a run, ascending [s]; none where its file is not there or cannot be read."""
    try:
        with open(folder / "acoustic.csv", newline="", encoding="utf-8") as file:
            found = [float(row["time_s"]) for row in csv.DictReader(file)]
    except (OSError, ValueError, KeyError, TypeError, csv.Error):
        return np.zeros(0)
    return np.sort(np.array([time for time in found if math.isfinite(time)]))


def kind_of(one: Measured) -> str:
    """What its specimen is, whatever the seed."""
    return one.specimen.about.partition(", seed")[0]


def looks(runs: list[Measured]) -> list[dict]:
    """Colour of each run, by its kind, and the name of the first of each kind."""
    kinds = list(dict.fromkeys(map(kind_of, runs)))
    first = {kind: next(one for one in runs if kind_of(one) == kind) for kind in kinds}
    return [
        {"color": COLOURS[kinds.index(kind_of(one)) % len(COLOURS)],
         "label": drawable(kind_of(one)) if first[kind_of(one)] is one else "_"}
        for one in runs
    ]  # fmt: skip


def _legend(axes, runs: list[Measured]) -> None:
    if 1 < len(set(map(kind_of, runs))) <= NAMED:
        axes.legend(fontsize=9)
