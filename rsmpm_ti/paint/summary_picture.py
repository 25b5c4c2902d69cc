"""The one picture of a finished run: load curve, failures, and the crack patterns at the largest load and the end."""

import math
import os
import textwrap
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.patheffects import withStroke

from rsmpm_ti.paint.figure import FramePainter, load_curve
from rsmpm_ti.paint.frame_axes import DPI, MEGA, MILLI, Wording
from rsmpm_ti.paint.palette import crack_palette
from rsmpm_ti.paint.png import write_png
from rsmpm_ti.paint.words import drawable
from rsmpm_ti.records.history_table import PEAK_DROP
from rsmpm_ti.records.snapshot import Pattern, Snapshot

LABELLED, MIN_FRACTION = 8, 0.06
"""At most so many cracks get their lengths written, and only those longer than this fraction of the panel's height: a
label on each splinter would hide the pattern."""

NONE = np.zeros(0)

WIDTHS = (1600, 2100)
"""Of the picture with one pattern and with two [px]."""

TITLE_LINE = 100
"""Characters of a title in one line."""


def summary_picture(
    path: str | os.PathLike,
    snapshot: Snapshot,
    history: np.ndarray,
    painter: FramePainter,
    title: str = "",
    lines: Sequence[np.ndarray] = (),
    acoustic: np.ndarray = NONE,
    peak: Pattern | None = None,
    peak_lines: Sequence[np.ndarray] = (),
) -> Path:
    """Writes a picture, 900 pixels high, from the whole history and the last snapshot; returns its path.

    `painter` is the run's painter of crack frames. Where no strain was recorded, all is drawn over time. lines: of
    cracks, each [k, 2] [m], drawn over the pattern, the longest with their lengths; acoustic: times of acoustic events,
    ascending [s], drawn as their number so far; peak: the pattern at the largest load, drawn beside the last one where
    it is another, with its own lines.
    """
    patterns = [(snapshot, lines, "Cracks at the end")]
    if peak is not None and peak.time < snapshot.time:
        patterns.insert(0, (peak, peak_lines, "Cracks at the largest load"))
    elif peak is not None:
        patterns = [(snapshot, lines, "Cracks at the end (largest load)")]
    figure = Figure(figsize=(WIDTHS[len(patterns) - 1] / DPI, 900 / DPI), dpi=DPI, facecolor="white")
    figure.set_layout_engine("constrained", w_pad=0.15, h_pad=0.15)
    FigureCanvasAgg(figure)
    curve, *panels = figure.subplots(1, 1 + len(patterns), width_ratios=(1.5, *(1.0 for _ in patterns)))
    if title:
        figure.suptitle(textwrap.fill(drawable(title), TITLE_LINE), fontsize=17, fontweight="bold")
    draw_load(curve, history, painter.wording, acoustic)
    for axes, (pattern, of_it, name) in zip(panels, patterns, strict=True):
        _cracks(axes, painter, pattern, f"{name}, {pattern.time * 1e3:.3f} ms")
        _lines(axes, of_it)
    legend = painter.wording.legend
    patches = [Patch(facecolor=np.array(c) / 255.0, edgecolor="#333333", label=name) for name, c in legend]
    figure.legend(handles=patches, fontsize=12, loc="outside lower right", ncols=len(legend), frameon=False)
    figure.canvas.draw()
    return write_png(path, np.asarray(figure.canvas.buffer_rgba())[..., :3].copy(), painter=painter.backend)


def draw_load(axes, history: np.ndarray, wording: Wording, acoustic: np.ndarray, first: float = math.nan) -> None:
    """The load over the strain, or over time where no strain was recorded, with its peak and the failures so far.

    acoustic: times of acoustic events, ascending [s]; first: time of the first failure [s], which is marked.
    """
    strain, load = load_curve(history)
    tension, shear = (tuple(c / 255.0 for c in colour) for colour in (crack_palette().tension, crack_palette().shear))
    handles = []
    counts = axes
    across, unit, name = history["time_s"] * 1e3, "ms", "time [ms]"
    if np.isfinite(strain * load).any():
        across, unit, name = strain * 100.0, "%", wording.inset_x
    axes.set_xlabel(name, fontsize=14)
    if np.isfinite(load).any():
        peak = int(np.nanargmax(np.abs(load)))  # a test in tension has one too
        handles += axes.plot(across, load * MEGA, color="#333333", linewidth=2.0, label=wording.inset_y)
        axes.plot(across[peak], load[peak] * MEGA, "o", color="#333333")
        fallen = np.nanmin(load[peak:]) < (1.0 - PEAK_DROP) * load[peak]
        note = f"{'peak' if fallen else 'largest so far'} {load[peak] * MEGA:.2f} MPa at {across[peak]:.3f} {unit}"
        axes.set_title(note, fontsize=14, loc="left")
        axes.set_ylabel(f"{wording.inset_y}   (compression positive)", fontsize=14)
        axes.set_xlim(left=min(0.0, float(np.nanmin(across))))
        axes.set_ylim(bottom=min(0.0, 1.05 * float(np.nanmin(load)) * MEGA))
        counts = axes.twinx()
        counts.tick_params(labelsize=12)
    if math.isfinite(first) and len(history):
        at = np.interp(first, history["time_s"], across)
        handles.append(axes.axvline(at, color="#882255", linestyle=":", label="first failure"))
    counts.set_ylabel("failed particles, acoustic events" if len(acoustic) else "failed particles", fontsize=14)
    handles += counts.plot(across, history["failed_tension"], color=tension, label="failed in tension")
    handles += counts.plot(across, history["failed_shear"], color=shear, label="failed in shear")
    if len(acoustic):
        so_far = np.searchsorted(acoustic, history["time_s"], side="right")
        handles += counts.plot(across, so_far, color="#117733", linewidth=1.0, label="acoustic events")
    failed = np.maximum(history["failed_tension"], history["failed_shear"])
    counts.set_ylim(0.0, 1.05 * max(1.0, np.nanmax(failed, initial=0.0)))
    axes.grid(color="#E8E8E8")
    axes.tick_params(labelsize=12)
    axes.legend(handles=handles, fontsize=13, loc="upper left", frameon=True)


def _cracks(axes, painter: FramePainter, pattern: Snapshot | Pattern, title: str) -> None:
    axes.imshow(painter.panel(pattern), extent=painter.extent_mm, interpolation="antialiased")
    axes.set_title(title, fontsize=14, loc="left")
    axes.set_xlabel("x  [mm]", fontsize=14)
    axes.set_ylabel("y  [mm]", fontsize=14)
    axes.tick_params(labelsize=12)


def _lines(axes, paths: Sequence[np.ndarray]) -> None:
    """Lines of cracks on the pattern, and the lengths of the longest [mm] beside their middles."""
    left, right, bottom, top = axes.get_images()[0].get_extent()
    lengths = [float(np.linalg.norm(np.diff(path, axis=0), axis=1).sum()) * MILLI for path in paths]
    longest = sorted(range(len(paths)), key=lambda k: -lengths[k])
    labelled = [k for k in longest[:LABELLED] if lengths[k] >= MIN_FRACTION * (top - bottom)]
    for path in paths:
        axes.plot(*(path.T * MILLI), color="#1A1A1A", linewidth=0.9, solid_capstyle="round")
    for k in labelled:
        x, y = paths[k][len(paths[k]) // 2] * MILLI
        outwards = 1.0 if x >= 0.5 * (left + right) else -1.0
        axes.annotate(
            f"{lengths[k]:.1f} mm", (x, y), xytext=(9.0 * outwards, 0.0), textcoords="offset points", fontsize=10,
            ha="left" if outwards > 0.0 else "right", va="center", color="#1A1A1A",
            path_effects=[withStroke(linewidth=2.5, foreground="white")],
        )  # fmt: skip
    axes.set_xlim(left, right)
    axes.set_ylim(bottom, top)
