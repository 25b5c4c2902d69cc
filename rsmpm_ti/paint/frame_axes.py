"""The parts of a frame that stay: axes, title, colour bar, legend and the inset's axes, drawn once by matplotlib."""

from dataclasses import dataclass

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import ListedColormap, Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from matplotlib.ticker import MaxNLocator

from rsmpm_ti.paint.layout import LEGEND_LINE, Box, Layout
from rsmpm_ti.paint.palette import Palette

DPI = 100
MILLI, MEGA = 1e3, 1e-6


@dataclass(frozen=True, kw_only=True)
class Wording:
    """What is written on a frame. `bar` labels the colour bar; None leaves it out.

    `ticks`: marks of the bar, (place in limits from -1 to 1, label), for one on which nothing lies beyond the ends; by
    default round numbers of MPa.
    """

    title: str
    bar: str | None
    legend: tuple[tuple[str, tuple[int, int, int]], ...]
    ticks: tuple[tuple[float, str], ...] = ()
    inset_x: str = "axial strain [%]"
    inset_y: str = "total axial stress [MPa]"


def draw_chrome(
    layout: Layout, palette: Palette, wording: Wording, inset_limits: tuple[float, float] | None
) -> np.ndarray:
    """The frame without particles, numbers and curve, uint8 [height, width, 3].

    `inset_limits`: largest strain [1] and load [Pa] of the inset, None for a frame without one.
    """
    width, height = layout.size
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor="white")
    canvas = FigureCanvasAgg(figure)
    axes = figure.add_axes(layout.panel.fraction(layout.size))
    axes.set_xlim(layout.view.lower[0] * MILLI, layout.view.upper[0] * MILLI)
    axes.set_ylim(layout.view.lower[1] * MILLI, layout.view.upper[1] * MILLI)
    axes.set_xlabel("x  [mm]", fontsize=15)
    axes.set_ylabel("y  [mm]", fontsize=15)
    axes.tick_params(labelsize=13)
    for axis, pixels in ((axes.xaxis, layout.panel.width), (axes.yaxis, layout.panel.height)):
        axis.set_major_locator(MaxNLocator(max(2, pixels // 100), steps=[1, 2, 5, 10]))
    position = layout.panel.left / width, 1.0 - (layout.panel.top - 24) / height
    figure.text(*position, wording.title, fontsize=19, fontweight="bold", ha="left", va="bottom")

    if wording.bar is not None:
        _colour_bar(figure, layout, palette, wording)
    for line, (name, colour) in enumerate(wording.legend):
        top = layout.legend.top + line * LEGEND_LINE
        _swatch(figure, layout.size, Box(left=layout.legend.left, top=top + 6, width=18, height=18), colour)
        position = (layout.legend.left + 28) / width, 1.0 - (top + 15) / height
        figure.text(*position, name, fontsize=14, ha="left", va="center_baseline")
    if inset_limits is not None:
        _inset_axes(figure, layout, wording, *inset_limits)
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _colour_bar(figure: Figure, layout: Layout, palette: Palette, wording: Wording) -> None:
    limit = palette.limit * MEGA
    mappable = ScalarMappable(Normalize(-limit, limit), ListedColormap(palette.ramp / 255.0))
    axes = figure.add_axes(layout.bar.fraction(layout.size))
    bar = figure.colorbar(mappable, cax=axes, extend="neither" if wording.ticks else "both")
    if wording.ticks:
        bar.set_ticks([limit * position for position, _ in wording.ticks], labels=[label for _, label in wording.ticks])
    else:
        bar.locator = MaxNLocator(max(4, layout.bar.height // 50), steps=[1, 2, 2.5, 5, 10], symmetric=True)
        bar.update_ticks()
    bar.ax.tick_params(labelsize=13)
    bar.set_label(wording.bar, fontsize=15 if layout.bar.height > 300 else 13)


def _swatch(figure: Figure, size: tuple[int, int], box: Box, colour: tuple[int, int, int]) -> None:
    left, bottom, width, height = box.fraction(size)
    face = tuple(c / 255.0 for c in colour)
    figure.add_artist(Rectangle((left, bottom), width, height, facecolor=face, edgecolor="#333333", linewidth=0.8))


def _inset_axes(figure: Figure, layout: Layout, wording: Wording, strain_limit: float, load_limit: float) -> None:
    inset = figure.add_axes(layout.inset.fraction(layout.size))
    inset.set_xlim(0.0, strain_limit * 100.0)
    inset.set_ylim(0.0, load_limit * MEGA)
    inset.xaxis.set_major_locator(MaxNLocator(5))
    inset.yaxis.set_major_locator(MaxNLocator(4))
    inset.grid(axis="y", color="#E0E0E0", linewidth=0.8)
    inset.set_axisbelow(True)
    inset.spines[["top", "right"]].set_visible(False)
    inset.tick_params(labelsize=10, length=3)
    inset.set_xlabel(wording.inset_x, fontsize=11)
    inset.set_title(wording.inset_y, fontsize=11, loc="left", x=-45.0 / layout.inset.width, pad=10)
